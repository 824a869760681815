// SPDX-License-Identifier: MIT
#include "octavo/render/tone_map.h"

#include <cmath>

#include "octavo/trace/shared_text.h"

#include "octavo/attributes/srgb.h"

#include "octavo/render/tone_curve.h"

namespace octavo {

std::array<std::uint8_t, 3> tone_map(const vec3& linear, float scale) {
    std::array<std::uint8_t, 3> rgb{};
    for (int i = 0; i < 3; ++i) {
        const float x = linear[i] * scale;
        const float shown = std::isnan(x) ? 0.0f : shared::tone_curve(x);
        rgb[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(shown * 255.0f + 0.5f);
    }
    return rgb;
}

}  // namespace octavo
