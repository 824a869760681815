// SPDX-License-Identifier: MIT
#include "octavo/mesh/opacity_map.h"

#include <algorithm>
#include <bit>

namespace octavo {
namespace {

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
    return a / b - (a % b < 0 ? 1 : 0);
}

/// Runs of pixels inside the picture that a range along one axis falls on: at most two.
struct Runs {
    std::array<std::array<int, 2>, 2> run{};
    int count = 0;
};
Runs runs_of(std::int64_t first, std::int64_t last, int size, Texture::Wrap wrap) {
    Runs runs;
    const auto add = [&](std::int64_t a, std::int64_t b) {
        runs.run[static_cast<unsigned>(runs.count++)] = {static_cast<int>(a), static_cast<int>(b)};
    };
    if (wrap == Texture::Wrap::clamp) {
        add(std::clamp<std::int64_t>(first, 0, size - 1),
            std::clamp<std::int64_t>(last, 0, size - 1));
        return runs;
    }
    if (last - first >= size - 1) {
        add(0, size - 1);
        return runs;
    }
    for (std::int64_t copy = floor_div(first, size); copy <= floor_div(last, size); ++copy) {
        const std::int64_t a = std::max(first - copy * size, std::int64_t{0});
        const std::int64_t b = std::min(last - copy * size, std::int64_t{size} - 1);
        if (wrap == Texture::Wrap::mirror && copy % 2 != 0)
            add(size - 1 - b, size - 1 - a);
        else
            add(a, b);
    }
    return runs;
}

}  // namespace

OpacityMap::OpacityMap(const Texture& texture, int least_alpha)
    : width_(texture.picture->width),
      height_(texture.picture->height),
      wrap_u_(texture.wrap_u),
      wrap_v_(texture.wrap_v) {
    Level pixels{width_, height_, {}};
    for (const auto& p : texture.picture->pixels)
        pixels.nodes.push_back(p[3] >= least_alpha ? kSolid : kHole);
    levels_.push_back(std::move(pixels));
    while (levels_.back().nodes.size() > 1) {
        const Level& fine = levels_.back();
        Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
        coarse.nodes.resize(static_cast<std::size_t>(coarse.width) *
                            static_cast<std::size_t>(coarse.height));
        for (int y = 0; y < fine.height; ++y)
            for (int x = 0; x < fine.width; ++x)
                coarse.nodes[coarse.index(x / 2, y / 2)] |= fine.nodes[fine.index(x, y)];
        levels_.push_back(std::move(coarse));
    }
}

/// @param range  first x and y, last x and y; meets this node
std::uint8_t OpacityMap::find_in(int level, int x, int y, const std::array<int, 4>& range,
                                 std::uint8_t found) const {
    const Level& nodes = levels_[static_cast<unsigned>(level)];
    const std::uint8_t node = nodes.nodes[nodes.index(x, y)];
    if ((node | found) == found) return found;
    const int x0 = x << level, y0 = y << level;
    const int x1 = std::min(x0 + (1 << level), width_) - 1;
    const int y1 = std::min(y0 + (1 << level), height_) - 1;
    const bool inside = range[0] <= x0 && range[1] <= y0 && x1 <= range[2] && y1 <= range[3];
    if (inside || std::has_single_bit(node)) return found | node;
    const Level& below = levels_[static_cast<unsigned>(level) - 1];
    for (int j = 2 * y; j < std::min(2 * y + 2, below.height); ++j)
        for (int i = 2 * x; i < std::min(2 * x + 2, below.width); ++i) {
            const int left = i << (level - 1), top = j << (level - 1);
            const int side = (1 << (level - 1)) - 1;
            if (left <= range[2] && left + side >= range[0] && top <= range[3] &&
                top + side >= range[1])
                found = find_in(level - 1, i, j, range, found);
        }
    return found;
}

OpacityMap::Found OpacityMap::find(const Pixel& first, const Pixel& last) const {
    const Runs columns = runs_of(first[0], last[0], width_, wrap_u_);
    const Runs rows = runs_of(first[1], last[1], height_, wrap_v_);
    std::uint8_t found = 0;
    for (int c = 0; c < columns.count; ++c)
        for (int r = 0; r < rows.count; ++r) {
            const auto& x = columns.run[static_cast<unsigned>(c)];
            const auto& y = rows.run[static_cast<unsigned>(r)];
            found = find_in(static_cast<int>(levels_.size()) - 1, 0, 0, {x[0], y[0], x[1], y[1]},
                            found);
        }
    return {(found & kSolid) != 0, (found & kHole) != 0};
}

}  // namespace octavo
