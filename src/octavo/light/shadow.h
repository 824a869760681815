// SPDX-License-Identifier: MIT
//
// How much of a lamp a point sees. Shared text: include after sampling.h.
#pragma once

OCTAVO_SHARED_BEGIN

const int kDiscShape = 0;       // the unit disc
const int kRectangleShape = 1;  // the square [-1, 1] x [-1, 1]
const int kTriangleShape = 2;   // (0, 0), (1, 0), (0, 1)

// A lamp seen from a point, or one triangle of it: the directions centre + a * u + b * v, with (a,
// b) evenly spread over the shape. A sun has centre of length 1, u and v of its angular radius, and
// t_end infinite; a lamp has the way to it, and t_end 1. Zeros in u and v make hard shadows.
struct LampPatch {
    vec3 centre;
    vec3 u;
    vec3 v;
    int shape;
    float t_end;
};

// A disc that faces the point.
OCTAVO_FN LampPatch facing_disc(vec3 to_centre, float radius, float t_end) {
    vec3 axis = normalize(to_centre);
    LampPatch lamp;
    lamp.centre = to_centre;
    lamp.u = radius * from_frame(axis, vec3(1.0f, 0.0f, 0.0f));
    lamp.v = radius * from_frame(axis, vec3(0.0f, 1.0f, 0.0f));
    lamp.shape = kDiscShape;
    lamp.t_end = t_end;
    return lamp;
}

// The direction of a point of the patch, from a point of the unit square.
OCTAVO_FN vec3 patch_direction(LampPatch lamp, vec2 square) {
    vec2 at = 2.0f * square - 1.0f;
    if (lamp.shape == kDiscShape) at = disc_point(square);
    if (lamp.shape == kTriangleShape) {
        float root = sqrt(square.x);
        at = vec2(1.0f - root, root * square.y);
    }
    return exact_madd(at.y, lamp.v, exact_madd(at.x, lamp.u, lamp.centre));
}

// A ray of the point towards the lamp. start, face: see sky_ray().
OCTAVO_FN GridRay shadow_ray(GridRay start, int face, vec3 direction, float t_end) {
    GridRay ray = start;
    ray.dir = bend_outwards(direction, face);
    ray.t_max = t_end;
    return ray;
}

// Ray i of a pixel that asks whether the point sees the lamp.
OCTAVO_FN GridRay lamp_ray(GridRay start, int face, LampPatch lamp, int i, uint seed) {
    return shadow_ray(start, face, patch_direction(lamp, sample_2d(uint(i), seed)), lamp.t_end);
}

// The bundle of all rays whose directions lie in a box.
OCTAVO_FN Bundle shadow_bundle(GridRay start, int face, vec3 low, vec3 high, float t_end) {
    // Some bits more, for the rounding of the rays.
    vec3 slack = 1e-6f * max(abs(low), abs(high)) + 1e-4f * (high - low);
    Bundle bundle;
    bundle.cell = start.cell;
    bundle.frac = start.frac;
    bundle.dir_low = bend_outwards(low - slack, face);
    bundle.dir_high = bend_outwards(high + slack, face);
    bundle.t_min = start.t_min;
    bundle.t_max = t_end;
    bundle.spread = max3(bundle.dir_high - bundle.dir_low);
    return bundle;
}

// The bundle of all rays to a patch.
OCTAVO_FN Bundle lamp_bundle(GridRay start, int face, LampPatch lamp) {
    vec3 reach = lamp.shape == kDiscShape ? sqrt(lamp.u * lamp.u + lamp.v * lamp.v)
                                          : abs(lamp.u) + abs(lamp.v);
    vec3 low = lamp.centre - reach;
    vec3 high = lamp.centre + reach;
    if (lamp.shape == kTriangleShape) {
        low = lamp.centre + min(vec3(0.0f), min(lamp.u, lamp.v));
        high = lamp.centre + max(vec3(0.0f), max(lamp.u, lamp.v));
    }
    return shadow_bundle(start, face, low, high, lamp.t_end);
}

// The number of samples [first, end) of the pixel that see the lamp.
OCTAVO_FN int lamp_samples_seen(DagView dag, GridRay start, int face, LampPatch lamp, Stop stop,
                                int first, int end, uint seed) {
    int seen = 0;
    for (int i = first; i < end; i += 1)
        seen += trace_any(dag, lamp_ray(start, face, lamp, i, seed), stop) ? 0 : 1;
    return seen;
}

OCTAVO_SHARED_END
