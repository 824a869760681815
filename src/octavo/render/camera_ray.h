// SPDX-License-Identifier: MIT
//
// A camera's rays, and the bundle of those of a block of pixels. Shared text: include after
// trace/beam.h. No product here can be fused with a sum: every backend shoots the same rays.
#pragma once

OCTAVO_SHARED_BEGIN

// A camera in grid space. All rays have the same length along the view direction, so that time is
// depth in voxels. Near the grid, t_before is 0 and all rays start in the eye, cell + frac. A
// camera that is too far for whole numbers starts each ray in its own point of a plane before the
// grid, at depth t_before, which cell + frac is the middle of.
struct CameraView {
    ivec3 cell;
    vec3 frac;
    vec3 forward;  // unit length
    vec3 right;    // from a pixel to the next, at depth 1
    vec3 down;
    vec2 centre;  // of the picture, pixels
    float t_before;
};

// The ray through the point pixel + inside of the picture; pixels, y downwards.
OCTAVO_FN GridRay camera_ray(CameraView view, ivec2 pixel, vec2 inside) {
    vec2 at = vec2(pixel) - view.centre + inside;
    vec3 across = exact_madd(at.x, view.right, exact_madd(at.y, view.down, vec3(0.0f)));
    vec3 origin = exact_madd(view.t_before, across, view.frac);
    GridRay ray;
    ray.cell = view.cell + ivec3(floor(origin));
    ray.frac = origin - floor(origin);
    ray.dir = view.forward + across;
    ray.t_min = 0.0f;
    ray.t_max = 1e30f;
    return ray;
}

// The bundle of all rays through the pixels [low, end); for t_before = 0 only.
OCTAVO_FN Bundle camera_bundle(CameraView view, ivec2 low, ivec2 end) {
    GridRay corner = camera_ray(view, low, vec2(0.0f));
    vec3 across = camera_ray(view, ivec2(end.x, low.y), vec2(0.0f)).dir;
    vec3 below = camera_ray(view, ivec2(low.x, end.y), vec2(0.0f)).dir;
    vec3 opposite = camera_ray(view, end, vec2(0.0f)).dir;
    ivec2 size = end - low;
    Bundle beam;
    beam.cell = corner.cell;
    beam.frac = corner.frac;
    // Rounding may carry a ray between the corners past them by a little.
    beam.dir_low = min(min(corner.dir, across), min(below, opposite)) - 1e-6f;
    beam.dir_high = max(max(corner.dir, across), max(below, opposite)) + 1e-6f;
    beam.t_min = 0.0f;
    beam.t_max = 1e30f;
    beam.spread = length(view.right) * float(max(size.x, size.y));
    return beam;
}

OCTAVO_SHARED_END
