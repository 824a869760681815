// SPDX-License-Identifier: MIT
#include "octavo/voxelize/cut_outs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "octavo/core/morton.h"

namespace octavo {

bool CutOuts::find(std::size_t scene_triangle, Triangle& out) const {
    const HoleMaps::Holes holes = maps_.of(scene_triangle);
    if (!holes.any) return false;
    out = {};
    if (!holes.map) return true;
    const uvec3& vertices = scene_.triangles[scene_triangle];
    const glm::dvec2 size(holes.map->width(), holes.map->height());
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
    out.map_ = holes.map;

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
