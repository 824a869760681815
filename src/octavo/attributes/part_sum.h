// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "octavo/attributes/encodings.h"
#include "octavo/attributes/surface_sampler.h"
#include "octavo/core/vec.h"

namespace octavo {

/// A triangle as the cells of a tile have it.
struct SurfaceFacet {
    static constexpr double kUnits = 16384.0;  // of unit length

    std::array<std::int16_t, 3> normal;
    std::int16_t facing;  // the main axis of the normal: 2 * axis, + 1 where it points upwards
};

/// The part of a facet in a cell. The parts of a cell are a list.
struct SurfacePart {
    static constexpr std::uint32_t kNone = 0xffffffffu;

    std::uint32_t next = kNone;  // of the same cell
    std::uint32_t facet = 0;
    std::uint64_t area = 0;  // a cell's face is 2^32; 0: there is none
    Tint tint;
};

/// The emission of a part, as in SurfaceSample.
using Glow = std::array<std::uint32_t, 3>;

/// What the parts on one side of a cell come to. Whole numbers, so their order makes no difference.
/// A cell's face is 2^32 and colours have 16 bits: the sums hold for 65 536 faces in a cell.
class PartSum {
public:
    /// @param color_alone  emission and normal are not asked for
    explicit PartSum(bool color_alone) : color_alone_(color_alone) {}

    void add(const SurfacePart& part, const SurfaceFacet& facet, const Glow& glow) {
        // Emission and normal count the whole area, colour only what is no hole.
        area_ += part.area;
        const std::uint64_t solid =
            part.tint.opacity == 65535 ? part.area : part.area * part.tint.opacity / 65535;
        solid_ += solid;
        for (unsigned i = 0; i < 3; ++i) color_[i] += solid * part.tint.color[i];
        if (color_alone_) return;
        for (unsigned i = 0; i < 3; ++i) {
            emission_[i] += (part.area >> 8) * glow[i];
            normal_[i] += static_cast<std::int64_t>(part.area >> 8) * facet.normal[i];
        }
    }
    [[nodiscard]] std::uint64_t area() const { return area_; }
    [[nodiscard]] std::uint32_t color(std::span<const std::uint8_t> srgb8) const {
        if (solid_ == 0) return 0;
        Rgb8 c{};
        for (unsigned i = 0; i < 3; ++i) c[i] = srgb8[(color_[i] + solid_ / 2) / solid_];
        return pack_rgb8(c);
    }
    [[nodiscard]] std::uint32_t emission(float greatest) const {
        if (area_ == 0 || (emission_[0] | emission_[1] | emission_[2]) == 0) return 0;
        const double scale = greatest / (static_cast<double>(area_) * (1048576.0 / 256.0));
        vec3 mean;
        for (int i = 0; i < 3; ++i)
            mean[i] = static_cast<float>(static_cast<double>(emission_[static_cast<unsigned>(i)]) *
                                         scale);
        return pack_rgb9e5(mean);
    }
    [[nodiscard]] vec3 normal() const {
        return {static_cast<float>(normal_[0]), static_cast<float>(normal_[1]),
                static_cast<float>(normal_[2])};
    }

private:
    bool color_alone_;
    std::uint64_t area_ = 0, solid_ = 0;
    std::array<std::uint64_t, 3> color_{}, emission_{};
    std::array<std::int64_t, 3> normal_{};
};

}  // namespace octavo
