// SPDX-License-Identifier: MIT
#include "octavo/render/tone_map.h"

#include <algorithm>
#include <cmath>

namespace octavo {
namespace {

constexpr float kShoulder = 0.6f;

float bend(float x) {
    if (!(x > kShoulder)) return std::max(x, 0.0f);
    return 1.0f - (1.0f - kShoulder) * std::exp((kShoulder - x) / (1.0f - kShoulder));
}

/// The transfer curve of IEC 61966-2-1.
float to_srgb(float x) {
    return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

}  // namespace

std::array<std::uint8_t, 3> tone_map(const vec3& linear, float scale) {
    std::array<std::uint8_t, 3> rgb{};
    for (int i = 0; i < 3; ++i) {
        const float x = linear[i] * scale;
        const float shown = std::isnan(x) ? 0.0f : to_srgb(bend(x));
        rgb[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(shown * 255.0f + 0.5f);
    }
    return rgb;
}

}  // namespace octavo
