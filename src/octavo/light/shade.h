// SPDX-License-Identifier: MIT
//
// The light of the sky, and what clay makes of light. Shared text: include after
// trace/shared_text.h.
#pragma once

OCTAVO_SHARED_BEGIN

OCTAVO_FN vec3 clay() {
    return vec3(0.78f, 0.76f, 0.72f);
}

// What a ray sees that meets nothing. up: unit length.
OCTAVO_FN vec3 sky_color(vec3 direction, vec3 up) {
    vec3 horizon = vec3(0.80f, 0.86f, 0.93f);
    float height = dot(normalize(direction), up);
    if (height < 0.0f) return mix(horizon, vec3(0.42f, 0.39f, 0.35f), min(1.0f, sqrt(-height)));
    return mix(horizon, vec3(0.30f, 0.47f, 0.78f), min(1.0f, pow(height, 0.6f)));
}

// The sky's light on a surface that sees all of it, for an albedo of one.
OCTAVO_FN vec3 sky_light(vec3 normal, vec3 up) {
    float facing_up = 0.5f + 0.5f * dot(normal, up);
    return mix(vec3(0.22f, 0.19f, 0.16f), vec3(0.40f, 0.47f, 0.60f), facing_up);
}

OCTAVO_SHARED_END
