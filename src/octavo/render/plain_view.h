// SPDX-License-Identifier: MIT
//
// What a pixel shows of its cell without light, as colours of the screen: for the viewer's modes.
// Shared text: include after camera_ray.h and, where it is there, surface.h.
#pragma once

OCTAVO_SHARED_BEGIN

// The first cell that an eye sees. Where levels are missing, or are not asked for, the eye is often
// inside a cell that is larger than a voxel, as all are that hold its surroundings: such a cell
// says nothing of what is seen, and neither do those that follow it without a gap. They are passed.
OCTAVO_FN GridHit first_seen(DagView dag, GridRay ray, Stop stop) {
    const int most = 64;  // cells passed
    GridHit hit = make_miss(ray.t_max, 0);
    for (int i = 0; i < most; i += 1) {
        hit = trace_closest(dag, ray, stop);
        bool within = i == 0 ? hit.face == kFaceInside : hit.t <= ray.t_min;
        if (!within || hit.height == 0) return hit;
        // Where the ray leaves it: the time of a plane, which the next cell begins at exactly.
        UpwardRay up = mirror_ray(ray.cell, ray.frac, ray.dir, dag.depth);
        ivec3 last = up.down * ((1 << (dag.depth - hit.height)) - 1);
        ivec3 corner = (ivec3(hit.path) ^ last) << hit.height;
        ray.t_min = min3(plane_time(up, corner + (1 << hit.height)));
    }
    return hit;
}

// Five colours, dark to light, for 0 to 1; the page's legend has the same.
OCTAVO_FN vec3 ramp(float t) {
    float at = 4.0f * clamp(t, 0.0f, 1.0f);
    vec3 color = mix(vec3(0.13f, 0.10f, 0.27f), vec3(0.16f, 0.34f, 0.55f), min(at, 1.0f));
    color = mix(color, vec3(0.14f, 0.60f, 0.56f), clamp(at - 1.0f, 0.0f, 1.0f));
    color = mix(color, vec3(0.62f, 0.78f, 0.35f), clamp(at - 2.0f, 0.0f, 1.0f));
    return mix(color, vec3(0.99f, 0.91f, 0.57f), clamp(at - 3.0f, 0.0f, 1.0f));
}

// Cells visited on the way, hit or not; 128 is the end of the ramp.
OCTAVO_FN vec3 steps_view(GridHit hit) {
    return ramp(float(hit.steps) / 128.0f);
}

// Where there is no cell. up: unit length.
OCTAVO_FN vec3 empty_view(GridRay ray, vec3 up) {
    return vec3(0.09f + 0.04f * dot(normalize(ray.dir), up));
}

// The cell's level, somewhat darker on sides that are seen aslant. levels: of the whole grid.
OCTAVO_FN vec3 level_view(DagView dag, GridRay ray, GridHit hit, float levels) {
    float facing = hit.face >= kFaceInside ? 1.0f : abs(normalize(ray.dir)[hit.face / 2]);
    return ramp(float(dag.depth - hit.height) / levels) * (0.7f + 0.3f * facing);
}

OCTAVO_FN vec3 normal_view(vec3 normal) {
    return 0.5f + 0.5f * normal;
}

// Light, 0 to 1, as a screen's values.
OCTAVO_FN vec3 color_view(vec3 light) {
    vec3 x = clamp(light, vec3(0.0f), vec3(1.0f));
    vec3 curve = 1.055f * pow(x, vec3(1.0f / 2.4f)) - 0.055f;
    return mix(curve, 12.92f * x, vec3(lessThanEqual(x, vec3(0.0031308f))));
}

OCTAVO_SHARED_END
