// SPDX-License-Identifier: MIT
//
// The curve of sRGB (IEC 61966-2-1), both ways, for one channel of 0 to 1. Shared text: include
// after trace/shared_text.h. encodings.cpp has it in double, for tables that files depend on.
#pragma once

OCTAVO_SHARED_BEGIN

OCTAVO_FN float linear_from_srgb(float shown) {
    return shown <= 0.04045f ? shown / 12.92f : pow((shown + 0.055f) / 1.055f, 2.4f);
}

OCTAVO_FN float srgb_from_linear(float light) {
    return light <= 0.0031308f ? 12.92f * light : 1.055f * pow(light, 1.0f / 2.4f) - 0.055f;
}

OCTAVO_SHARED_END
