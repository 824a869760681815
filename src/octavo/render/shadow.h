// SPDX-License-Identifier: MIT
//
// How much of a lamp a point sees. Shared text: include after sampling.h.
#pragma once

OCTAVO_SHARED_BEGIN

// A lamp seen from a point: the directions to_centre + radius * (a point of the unit disc that
// faces the point). The disc of the sun has to_centre of length 1, its angular radius, and t_end
// infinite; that of a lamp the way to it, and t_end 1.
struct LampDisc {
    vec3 to_centre;
    float radius;  // 0: hard shadows
    float t_end;
};

// Ray i of a pixel that asks whether the point sees the lamp. start, face: see sky_ray().
OCTAVO_FN GridRay lamp_ray(GridRay start, int face, LampDisc lamp, int i, uint seed) {
    GridRay ray = start;
    vec2 disc = lamp.radius * disc_point(sample_2d(uint(i), seed));
    vec3 across = from_frame(normalize(lamp.to_centre), vec3(disc, 0.0f));
    ray.dir = bend_outwards(lamp.to_centre + across, face);
    ray.t_max = lamp.t_end;
    return ray;
}

// The bundle of all those rays.
OCTAVO_FN Bundle lamp_bundle(GridRay start, int face, LampDisc lamp) {
    vec3 axis = normalize(lamp.to_centre);
    // How far the disc reaches along each axis; some bits more, for the rounding of the rays.
    vec3 reach = lamp.radius * sqrt(max(vec3(0.0f), 1.0f - axis * axis)) * 1.0001f;
    reach += 1e-6f * (abs(lamp.to_centre) + lamp.radius);
    Bundle bundle;
    bundle.cell = start.cell;
    bundle.frac = start.frac;
    bundle.dir_low = bend_outwards(lamp.to_centre - reach, face);
    bundle.dir_high = bend_outwards(lamp.to_centre + reach, face);
    bundle.t_min = start.t_min;
    bundle.t_max = lamp.t_end;
    bundle.spread = max3(bundle.dir_high - bundle.dir_low);
    return bundle;
}

// The number of samples [first, end) of the pixel that see the lamp.
OCTAVO_FN int lamp_samples_seen(DagView dag, GridRay start, int face, LampDisc lamp, Stop stop,
                                int first, int end, uint seed) {
    int seen = 0;
    for (int i = first; i < end; i += 1)
        seen += trace_any(dag, lamp_ray(start, face, lamp, i, seed), stop) ? 0 : 1;
    return seen;
}

OCTAVO_SHARED_END
