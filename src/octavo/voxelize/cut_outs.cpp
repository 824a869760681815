// SPDX-License-Identifier: MIT
#include "octavo/voxelize/cut_outs.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "octavo/core/morton.h"
#include "octavo/mesh/alpha.h"

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
                coarse.nodes[static_cast<std::size_t>(y / 2 * coarse.width + x / 2)] |=
                    fine.nodes[static_cast<std::size_t>(y * fine.width + x)];
        levels_.push_back(std::move(coarse));
    }
}

/// @param range  first x and y, last x and y; meets this node
std::uint8_t OpacityMap::find_in(int level, int x, int y, const std::array<int, 4>& range,
                                 std::uint8_t found) const {
    const Level& nodes = levels_[static_cast<unsigned>(level)];
    const std::uint8_t node = nodes.nodes[static_cast<std::size_t>(y * nodes.width + x)];
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

CutOuts::CutOuts(const Scene& scene, const Grid& grid) : scene_(scene), grid_(grid) {
    if (std::none_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return m.alpha_cutoff.has_value(); }))
        return;

    constexpr std::uint32_t kUnknown = 0xfffffffdu;
    std::map<std::pair<int, int>, std::uint32_t> known;
    std::vector<std::uint32_t> maps_of(scene.triangles.size(), kNoHoles);
    bool any = false;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        const int least = least_alpha(scene, t);
        if (least == 0) continue;
        const Texture* texture = decoded_texture(scene, material_of(scene, t).base_color_texture);
        if (scene.texture_coordinates.empty()) texture = nullptr;
        if (least > 255 || !texture) {
            // Without a texture alpha is 255 everywhere.
            maps_of[t] = least > 255 ? kAllHole : kNoHoles;
        } else {
            auto& map =
                known.emplace(std::pair(material_of(scene, t).base_color_texture, least), kUnknown)
                    .first->second;
            if (map == kUnknown) {
                OpacityMap made(*texture, least);
                map = made.all_solid() ? kNoHoles : static_cast<std::uint32_t>(maps_.size());
                if (map != kNoHoles) maps_.push_back(std::move(made));
                // Whatever decides where the holes are, for the journal's key.
                const auto& pixels = texture->picture->pixels;
                hash_ = XXH3_64bits_withSeed(pixels.data(), pixels.size() * sizeof(pixels[0]),
                                             hash_ + static_cast<unsigned>(least));
            }
            maps_of[t] = map;
        }
        any = any || maps_of[t] != kNoHoles;
    }
    if (!any) return;
    maps_of_ = std::move(maps_of);
    hash_ = XXH3_64bits_withSeed(maps_of_.data(), maps_of_.size() * sizeof(maps_of_[0]), hash_);
    hash_ = XXH3_64bits_withSeed(scene.texture_coordinates.data(),
                                 scene.texture_coordinates.size() * sizeof(vec2), hash_);
}

bool CutOuts::find(std::size_t scene_triangle, Triangle& out) const {
    if (maps_of_.empty() || maps_of_[scene_triangle] == kNoHoles) return false;
    out = {};
    if (maps_of_[scene_triangle] == kAllHole) return true;
    const OpacityMap& map = maps_[maps_of_[scene_triangle]];
    const uvec3& vertices = scene_.triangles[scene_triangle];
    const glm::dvec2 size(map.width(), map.height());
    std::array<glm::dvec2, 3> pixel;
    std::array<dvec3, 3> corner;
    for (int i = 0; i < 3; ++i) {
        pixel[static_cast<unsigned>(i)] =
            glm::dvec2(scene_.texture_coordinates[vertices[i]]) * size;
        corner[static_cast<unsigned>(i)] = grid_.to_grid(scene_.positions[vertices[i]]);
    }
    out.low_ = glm::min(pixel[0], glm::min(pixel[1], pixel[2]));
    out.high_ = glm::max(pixel[0], glm::max(pixel[1], pixel[2]));
    // Coordinates that are not finite, or further out than pixels can be counted, say nothing.
    constexpr double kFarthest = 1e15;
    if (!(std::min(out.low_.x, out.low_.y) > -kFarthest) ||
        !(std::max(out.high_.x, out.high_.y) < kFarthest))
        return false;
    out.map_ = &map;

    const dvec3 a = corner[1] - corner[0], b = corner[2] - corner[0];
    const dvec3 normal = glm::cross(a, b), reach = glm::abs(normal);
    const int w = reach.x >= std::max(reach.y, reach.z) ? 0 : reach.y >= reach.z ? 1 : 2;
    out.u_ = (w + 1) % 3;
    out.v_ = (w + 2) % 3;
    if (!(reach[w] > 0.0)) return true;  // a segment: all of its pixels count everywhere
    const double along = normal[w];      // a.u b.v - a.v b.u
    const glm::dvec2 to_b = pixel[1] - pixel[0], to_c = pixel[2] - pixel[0];
    out.along_u_ = (to_b * b[out.v_] - to_c * a[out.v_]) / along;
    out.along_v_ = (to_c * a[out.u_] - to_b * b[out.u_]) / along;
    out.first_ = pixel[0] - out.along_u_ * corner[0][out.u_] - out.along_v_ * corner[0][out.v_];
    return true;
}

/// What the pixels hold that fall on a square of the main plane: the rectangle around them, cut to
/// that around the triangle.
OpacityMap::Found CutOuts::Triangle::find(const ivec3& low, int width, int margin) const {
    if (!map_) return {false, true};
    glm::dvec2 first = low_, last = high_;
    if (along_u_ != glm::dvec2(0.0) || along_v_ != glm::dvec2(0.0)) {
        const glm::dvec2 middle =
            first_ + along_u_ * (low[u_] + 0.5 * width) + along_v_ * (low[v_] + 0.5 * width);
        const glm::dvec2 reach = 0.5 * width * (glm::abs(along_u_) + glm::abs(along_v_));
        first = glm::clamp(middle - reach, low_, high_);
        last = glm::clamp(middle + reach, low_, high_);
    }
    const auto pixel = [&](const glm::dvec2& p, int more) {
        return OpacityMap::Pixel{static_cast<std::int64_t>(std::floor(p.x)) + more,
                                 static_cast<std::int64_t>(std::floor(p.y)) + more};
    };
    return map_->find(pixel(first, -margin), pixel(last, margin));
}

std::uint64_t CutOuts::Triangle::keep(const ivec3& block, std::uint64_t voxels) const {
    // A pixel more on each side, so that rounding cannot make a block say what a voxel would not.
    const OpacityMap::Found all = find(block << 2, 4, 1);
    if (!all.hole) return voxels;
    if (!all.solid) return 0;
    std::uint64_t kept = 0;
    for (std::uint64_t left = voxels; left != 0; left &= left - 1) {
        const auto code = static_cast<unsigned>(std::countr_zero(left));
        if (find((block << 2) + ivec3(morton_decode(code)), 1, 0).solid)
            kept |= std::uint64_t{1} << code;
    }
    return kept;
}

}  // namespace octavo
