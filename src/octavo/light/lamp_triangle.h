// SPDX-License-Identifier: MIT
//
// One triangle of a lamp. Shared text: include before lamp_light.h.
#pragma once

OCTAVO_SHARED_BEGIN

struct LampTriangle {
    ivec3 cell;  // a corner, cell + frac
    vec3 frac;
    vec3 u;  // to the others
    vec3 v;
    vec3 normal;        // unit length
    vec3 middle;        // seen from the lamp's place
    float squared;      // of a length: about the triangle's size
    float area_so_far;  // of this and all triangles before it, square voxels
};

OCTAVO_SHARED_END
