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

// The number of samples [first, end) of the pixel that see the lamp. start, face: see
// sky_samples_seen().
OCTAVO_FN int lamp_samples_seen(DagView dag, GridRay start, int face, LampDisc lamp, Stop stop,
                                int first, int end, uint seed) {
    int seen = 0;
    vec3 axis = normalize(lamp.to_centre);
    for (int i = first; i < end; i += 1) {
        GridRay ray = start;
        vec2 disc = lamp.radius * disc_point(sample_2d(uint(i), seed));
        ray.dir = bend_outwards(lamp.to_centre + from_frame(axis, vec3(disc, 0.0f)), face);
        ray.t_max = lamp.t_end;
        seen += trace_any(dag, ray, stop) ? 0 : 1;
    }
    return seen;
}

OCTAVO_SHARED_END
