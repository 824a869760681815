// SPDX-License-Identifier: MIT
//
// How much of the sky a point sees. Shared text: include after sampling.h.
//
// After Laine and Karras, "Two Methods for Fast Ray-Cast Ambient Occlusion", 2010, as [K13] section
// 4 uses it: an occluder at distance d counts 1 - d / radius. A shadow ray of random length l is
// stopped by it if d < l, and with l even in [0, radius] that has just this probability: so rays
// need to answer yes or no only, and most are short.
#pragma once

OCTAVO_SHARED_BEGIN

// Ray i of a pixel that asks whether the point sees the sky.
//
//   start   the point: a ray from the surface (leave_hit), of any direction
//   face    of the cell that it must not go into, or kFaceNone
//   normal  unit length
//   radius  voxels: beyond it nothing occludes
OCTAVO_FN GridRay sky_ray(GridRay start, int face, vec3 normal, float radius, int i, uint seed) {
    GridRay ray = start;
    ray.dir = bend_outwards(cosine_direction(normal, sample_2d(uint(i), seed)), face);
    ray.t_max = radius * sample_1d(uint(i), seed ^ 0x5bd1e995u);
    return ray;
}

// The number of samples [first, end) of the pixel that see the sky.
//
//   stop    lets rays end at larger cells, which makes it darker and faster ([K13] figure 8b)
OCTAVO_FN int sky_samples_seen(DagView dag, GridRay start, int face, vec3 normal, float radius,
                               Stop stop, int first, int end, uint seed) {
    // The finest grid of which whole ones fill the range; with m = 0 samples come by number.
    int m = 3;
    while (((first | end) & ((1 << (2 * m)) - 1)) != 0) m -= 1;
    SquareOrder order = square_order(m, seed);
    uint squares = 1u << (2 * m);
    int seen = 0;
    for (int i = first; i < end; i += 1) {
        uint square = uint(i) & (squares - 1u);
        int sample_number = int(sample_in_square(order, uint(i) - square, square));
        GridRay ray = sky_ray(start, face, normal, radius, sample_number, seed);
        seen += trace_any(dag, ray, stop) ? 0 : 1;
    }
    return seen;
}

OCTAVO_SHARED_END
