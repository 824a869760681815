// SPDX-License-Identifier: MIT
//
// What a screen shows of linear light: tone_map.h says how. Shared text: include after
// attributes/srgb.h.
#pragma once

OCTAVO_SHARED_BEGIN

const float kShoulder = 0.6f;  // from here on light bends towards white

// One channel; the light 1 is a white surface's. @return sRGB, below 1
OCTAVO_FN float tone_curve(float light) {
    float rest = 1.0f - kShoulder;
    float bent =
        light > kShoulder ? 1.0f - rest * exp((kShoulder - light) / rest) : max(light, 0.0f);
    return srgb_from_linear(bent);
}

OCTAVO_SHARED_END
