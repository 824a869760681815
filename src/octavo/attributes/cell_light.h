// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "octavo/attributes/encodings.h"

namespace octavo {

/// The light of each occupied cell in six directions, in one array that has nothing for empty space
/// ([J]: 384 MB of dense textures become 12).
///
/// Direction 2 * axis + 1 is that of +axis, 2 * axis that of -axis, as faces are numbered. The
/// value is the light that the part of the surface which is seen from there would send out if it
/// were white: its irradiance over pi, of that side's own normal. Times the colour of that side,
/// plus its emission, it is the radiance that the cell sends that way. Colour stays apart, so that
/// light can be smoothed over cells and colour cannot.
///
/// A word is RGB9E5, see pack_rgb9e5(); kHidden where no surface of the cell can be seen from that
/// direction, because its neighbour is full, or its voxels all lie behind others. It reads as
/// black.
///
///     word 6 * cell + direction
class CellLight {
public:
    static constexpr std::uint32_t kHidden = 31u << 27;
    static constexpr std::uint64_t kMostCells = 0xffffffffull / 6;  // 16 GiB

    /// None.
    CellLight() = default;

    /// @param words  6 for each cell of `level`; trusted: any word has a meaning
    /// @param owner  keeps the words alive
    CellLight(int level, int bounces, std::span<const std::uint32_t> words,
              std::shared_ptr<const void> owner)
        : level_(level), bounces_(bounces), words_(words), owner_(std::move(owner)) {}
    CellLight(int level, int bounces, std::vector<std::uint32_t> words)
        : level_(level), bounces_(bounces) {
        const auto kept = std::make_shared<const std::vector<std::uint32_t>>(std::move(words));
        words_ = *kept;
        owner_ = kept;
    }

    [[nodiscard]] bool empty() const { return words_.empty(); }
    [[nodiscard]] int level() const { return level_; }
    [[nodiscard]] int bounces() const { return bounces_; }
    [[nodiscard]] std::span<const std::uint32_t> words() const { return words_; }
    [[nodiscard]] std::uint64_t count() const { return words_.size() / 6; }

    [[nodiscard]] bool hidden(std::uint64_t cell, int direction) const {
        return words_[6 * cell + static_cast<unsigned>(direction)] == kHidden;
    }
    [[nodiscard]] vec3 get(std::uint64_t cell, int direction) const {
        return unpack_rgb9e5(words_[6 * cell + static_cast<unsigned>(direction)]);
    }

private:
    int level_ = 0;
    int bounces_ = 0;
    std::span<const std::uint32_t> words_;
    std::shared_ptr<const void> owner_;
};

}  // namespace octavo
