// SPDX-License-Identifier: MIT
#include "octavo/light/cell_words.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <string>

#include "octavo/core/error.h"

namespace octavo {
namespace {

float linear_of_byte(std::uint32_t byte) {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> linear{};
        for (unsigned i = 0; i < 256; ++i) {
            const auto b = static_cast<std::uint8_t>(i);
            linear[i] = linear_from_srgb8({b, b, b}).x;
        }
        return linear;
    }();
    return table[byte & 255u];
}

}  // namespace

CellWords::CellWords(const LitScene& scene) {
    for (const LitObject& object : scene.objects) {
        first_words_.push_back(size_);
        if (!object.attributes.empty()) size_ += 6 * object.attributes.cells().count();
        if (size_ / 6 > CellLight::kMostCells)
            throw Error(Errc::limit, "light is for at most 715 million cells; this has " +
                                         std::to_string(size_ / 6));
    }
}

void CellWords::find_colors(const LitScene& scene) {
    colors_.assign(size_, kClay);
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
        const Attributes& attributes = scene.objects[i].attributes;
        if (attributes.empty()) continue;
        const auto color_of = [&](std::uint64_t cell, const vec3& towards) {
            if (!attributes.has_color()) return kClay;
            const Rgb8 color = attributes.color(cell, towards);
            return std::uint32_t{color[0]} | std::uint32_t{color[1]} << 8 |
                   std::uint32_t{color[2]} << 16;
        };
        tbb::parallel_for(std::uint64_t{0}, attributes.cells().count(), [&](std::uint64_t cell) {
            bool shines = false;
            for (int direction = 0; attributes.has_emission() && direction < 6; ++direction)
                shines =
                    shines || attributes.emission(cell, direction_vector(direction)) != vec3(0.0f);
            for (int direction = 0; direction < 6; ++direction)
                colors_[word({i, cell, direction})] =
                    color_of(cell, direction_vector(direction)) | (shines ? kShines : 0u);
        });
    }
}

std::uint32_t CellWords::word(const CellSide& side) const {
    if (side.cell == CellSide::kNoCell) return kNone;
    return static_cast<std::uint32_t>(first_words_[side.object] + 6 * side.cell +
                                      static_cast<std::size_t>(side.direction));
}

std::uint32_t CellWords::target(const CellSide& side, const vec3& towards) const {
    const std::uint32_t met = word(side);
    if (met == kNone || seen(met)) return met;
    std::uint32_t best = kNone;
    float most = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        const std::uint32_t other =
            word({side.object, side.cell, 2 * axis + (towards[axis] > 0.0f ? 1 : 0)});
        if (!seen(other) || !(std::abs(towards[axis]) > most)) continue;
        most = std::abs(towards[axis]);
        best = other;
    }
    return best;
}

vec3 CellWords::albedo(std::uint32_t word) const {
    const std::uint32_t color = colors_[word];
    if ((color & kClay) != 0) return shared::clay();
    return {linear_of_byte(color), linear_of_byte(color >> 8), linear_of_byte(color >> 16)};
}

}  // namespace octavo
