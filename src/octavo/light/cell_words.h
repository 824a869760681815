// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/light/lit_scene.h"
#include "octavo/light/lit_world.h"

namespace octavo {

/// The sides of all cells of a scene under one number each: their words in arrays that the objects
/// share. Knows the colour of each, and whether it can be seen.
class CellWords {
public:
    static constexpr std::uint32_t kNone = 0xffffffffu;
    /// What a ray met that met nothing; words are below both.
    static constexpr std::uint32_t kOpen = 0xfffffffeu;

    [[nodiscard]] static bool is_word(std::uint32_t word) { return word < kOpen; }

    /// @throws Error  limit where there are more than CellLight::kMostCells cells
    explicit CellWords(const LitScene& scene);

    /// Makes room for the colours, and finds them; until then no side can be seen. Runs on the
    /// threads of the caller's arena.
    void find_colors(const LitScene& scene);

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t first_word(std::uint32_t object) const {
        return first_words_[object];
    }
    [[nodiscard]] std::size_t end_word(std::uint32_t object) const {
        return object + 1 < first_words_.size() ? first_words_[object + 1] : size_;
    }

    /// kNone for a side of no cell.
    [[nodiscard]] std::uint32_t word(const CellSide& side) const;

    /// The word whose light comes along a ray that met a side, from where `towards` points. A ray
    /// that runs along an edge of a wall may meet a side that is hidden: then it takes the side
    /// that faces it most of those that it could see, if there is one; compare
    /// shared::side_light().
    [[nodiscard]] std::uint32_t target(const CellSide& side, const vec3& towards) const;

    [[nodiscard]] bool seen(std::uint32_t word) const { return (colors_[word] & kSeen) != 0; }
    void set_seen(std::uint32_t word) { colors_[word] |= kSeen; }

    /// Whether its cell does, from any side.
    [[nodiscard]] bool shines(std::uint32_t word) const { return (colors_[word] & kShines) != 0; }

    /// Linear.
    [[nodiscard]] vec3 albedo(std::uint32_t word) const;

private:
    // In sRGB bytes, which are exact, or kClay; and the others.
    static constexpr std::uint32_t kClay = 1u << 24;
    static constexpr std::uint32_t kSeen = 1u << 25;
    static constexpr std::uint32_t kShines = 1u << 26;

    std::size_t size_ = 0;
    std::vector<std::size_t> first_words_;  // of each object
    std::vector<std::uint32_t> colors_;     // of each word
};

}  // namespace octavo
