// SPDX-License-Identifier: MIT
#include "octavo/attributes/attributes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace octavo {
namespace {

constexpr std::uint64_t kMostCells = 16;
constexpr double kBorder = 1e-3;  // in cells

Rgb8 mean_color(const vec3& sum, float count) {
    const vec3 mean = sum / count * 65535.0f + 0.5f;
    return {srgb8_from_linear16(static_cast<std::uint32_t>(mean.r)),
            srgb8_from_linear16(static_cast<std::uint32_t>(mean.g)),
            srgb8_from_linear16(static_cast<std::uint32_t>(mean.b))};
}

}  // namespace

bool Attributes::seen_from_behind(std::uint64_t cell, const vec3& towards) const {
    if (!has(Channel::back)) return false;
    const std::uint32_t back = channel(Channel::back).get(cell);
    return back != 0 &&
           glm::dot(unpack_coarse_direction(front_direction_of_back(back)), towards) < 0.0f;
}

Rgb8 Attributes::color(std::uint64_t cell, const vec3& towards) const {
    if (!has_color()) return {};
    return unpack_rgb8(seen_from_behind(cell, towards) ? channel(Channel::back).get(cell)
                                                       : channel(Channel::color).get(cell));
}

vec3 Attributes::emission(std::uint64_t cell, const vec3& towards) const {
    if (!has_emission()) return vec3(0.0f);
    const bool behind = has(Channel::back_emission) && seen_from_behind(cell, towards);
    return unpack_rgb9e5(channel(behind ? Channel::back_emission : Channel::emission).get(cell));
}

vec3 Attributes::normal(std::uint64_t cell, const vec3& towards) const {
    if (!has_normal()) return vec3(0.0f);
    const bool behind = has(Channel::back_normal) && seen_from_behind(cell, towards);
    return unpack_normal(channel(behind ? Channel::back_normal : Channel::normal).get(cell));
}

template <class Visit>
void Attributes::for_some_cells(const uvec3& path, int level, const Visit& visit) const {
    const int finer = std::max(0, level - cells_.level());
    const CellRange range = cells_.cells_in(path >> static_cast<unsigned>(finer), level - finer);
    const std::uint64_t some = std::min(range.size(), kMostCells);
    for (std::uint64_t i = 0; i < some; ++i)
        visit(range.begin + (2 * i + 1) * range.size() / (2 * some));
}

std::optional<Rgb8> Attributes::color(const uvec3& path, int level, const vec3& towards) const {
    if (!has_color()) return std::nullopt;
    vec3 sum(0.0f);
    Rgb8 last{};
    int count = 0;
    for_some_cells(path, level, [&](std::uint64_t cell) {
        last = color(cell, towards);
        sum += linear_from_srgb8(last);
        ++count;
    });
    if (count == 0) return std::nullopt;
    return count == 1 ? last : mean_color(sum, static_cast<float>(count));
}

std::optional<vec3> Attributes::albedo(const uvec3& path, int level, const vec3& towards) const {
    if (!has_color()) return std::nullopt;
    vec3 sum(0.0f);
    int count = 0;
    for_some_cells(path, level, [&](std::uint64_t cell) {
        sum += linear_from_srgb8(color(cell, towards));
        ++count;
    });
    if (count == 0) return std::nullopt;
    return sum / static_cast<float>(count);
}

std::optional<vec3> Attributes::emission(const uvec3& path, int level, const vec3& towards) const {
    if (!has_emission()) return std::nullopt;
    vec3 sum(0.0f);
    int count = 0;
    for_some_cells(path, level, [&](std::uint64_t cell) {
        sum += emission(cell, towards);
        ++count;
    });
    if (count == 0) return std::nullopt;
    return sum / static_cast<float>(count);
}

std::optional<vec3> Attributes::normal(const uvec3& path, int level, const vec3& towards) const {
    if (!has_normal()) return std::nullopt;
    vec3 sum(0.0f), last(0.0f);
    int count = 0;
    for_some_cells(path, level, [&](std::uint64_t cell) {
        last = normal(cell, towards);
        sum += last;
        ++count;
    });
    if (count == 0) return std::nullopt;
    return glm::length(sum) > 1e-3f ? glm::normalize(sum) : last;
}

std::optional<std::uint64_t> Attributes::cell_at(const dvec3& grid_point) const {
    const dvec3 point = grid_point / std::ldexp(1.0, cells_.dag().depth() - cells_.level());
    const double side = std::ldexp(1.0, cells_.level());
    const auto near_grid = [&](double x) { return x >= -kBorder && x <= side + kBorder; };
    if (!near_grid(point.x) || !near_grid(point.y) || !near_grid(point.z)) return std::nullopt;

    // The cell itself first, then those across a border that the point is on.
    const dvec3 own = glm::floor(point);
    for (int i = 0; i < 8; ++i) {
        dvec3 cell = own;
        bool touched = true;
        for (int axis = 0; axis < 3; ++axis) {
            if (!(i >> axis & 1)) continue;
            const double in_cell = point[axis] - own[axis];
            if (in_cell <= kBorder)
                cell[axis] -= 1.0;
            else if (in_cell >= 1.0 - kBorder)
                cell[axis] += 1.0;
            else
                touched = false;
        }
        const auto inside = [&](double x) { return x >= 0.0 && x < side; };
        if (!touched || !inside(cell.x) || !inside(cell.y) || !inside(cell.z)) continue;
        if (const auto found = cells_.find(uvec3(cell))) return found;
    }
    return std::nullopt;
}

std::optional<Rgb8> Attributes::color(const dvec3& grid_point, const vec3& towards) const {
    if (!has_color()) return std::nullopt;
    const auto cell = cell_at(grid_point);
    if (!cell) return std::nullopt;
    return color(*cell, towards);
}

void Attributes::colors(std::span<const Query> queries, std::span<Rgba8> out) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, queries.size(), 1024), [&](const auto& r) {
        for (std::size_t i = r.begin(); i != r.end(); ++i) {
            const Query& q = queries[i];
            const auto found = color(q.path, q.level, q.towards);
            out[i] = found ? Rgba8{(*found)[0], (*found)[1], (*found)[2], 255} : Rgba8{};
        }
    });
}

}  // namespace octavo
