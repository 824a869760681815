// SPDX-License-Identifier: MIT
#include "octavo/light/side_starts.h"

#include <algorithm>
#include <cmath>

#include "octavo/core/morton.h"
#include "octavo/light/normal.h"
#include "octavo/light/point_text.h"
#include "octavo/trace/instances.h"

namespace octavo {
namespace {

/// Along each edge of a cell: where places are looked for. Sobol's points have one in each of these
/// squares, and fill the face evenly from the first on.
constexpr int kColumns = 4;

/// Of how many starts the normals count, and how much finer than the cell they are looked for.
constexpr int kNormals = 2;
constexpr int kBlocksDepth = 2;

/// A leaf's voxels, in Morton order; none outside the grid. @param leaf  at level depth - 2
std::uint64_t leaf_mask(const shared::DagView& dag, const ivec3& leaf) {
    if (dag.depth < 2 || glm::any(glm::notEqual(leaf >> (dag.depth - 2), ivec3(0)))) return 0;
    std::uint32_t word = 0;
    for (int height = dag.depth; height > 2; --height) {
        const int child = shared::child_number((leaf >> (height - 3)) & 1);
        if (((shared::dag_load(dag, word) >> child) & 1u) == 0u) return 0;
        word = shared::load_child(dag, word, child);
    }
    return shared::dag_load(dag, word) | std::uint64_t{shared::dag_load(dag, word + 1u)} << 32;
}

bool has(std::uint64_t leaf, const ivec3& voxel) {
    return (leaf >> morton_encode(uvec3(voxel & 3)) & 1u) != 0;
}

/// One side of a cell and its axes.
struct Face {
    ivec3 corner;  // of the cell, in voxels
    int width;
    int axis, u, v;
    bool high;

    Face(const uvec3& cell, int cell_width, int direction)
        : corner(ivec3(cell) * cell_width),
          width(cell_width),
          axis(direction / 2),
          u((axis + 1) % 3),
          v((axis + 2) % 3),
          high((direction & 1) == 1) {}

    /// A start at this place of the face, on the voxel that lies `depth` voxels behind it.
    [[nodiscard]] shared::GridRay start(const vec2& square, int depth) const {
        shared::GridRay ray{};
        ray.cell = corner;
        ray.cell[axis] += high ? width - depth : depth;
        const float at_u = square.x * static_cast<float>(width);
        const float at_v = square.y * static_cast<float>(width);
        ray.cell[u] += static_cast<int>(at_u);
        ray.cell[v] += static_cast<int>(at_v);
        ray.frac[u] = at_u - std::floor(at_u);
        ray.frac[v] = at_v - std::floor(at_v);
        return ray;
    }
};

/// Of cells that lie in one leaf: by the bits of its mask, and of the mask before it.
class LeafColumns {
public:
    LeafColumns(const shared::DagView& dag, const Face& face)
        : face_(face), own_(leaf_mask(dag, face.corner >> 2)) {
        // The voxels before the face are in this leaf or in the next.
        ivec3 before = face.corner;
        before[face.axis] += face.high ? face.width : -1;
        before_ = (before >> 2) == (face.corner >> 2) ? own_ : leaf_mask(dag, before >> 2);
        layer_before_ = before[face.axis];
    }

    /// How deep the first voxel of a column lies; none where there is none, or where it is at the
    /// face and another lies before it.
    [[nodiscard]] std::optional<int> depth(const vec2& square) const {
        ivec3 voxel = face_.corner;
        voxel[face_.u] += static_cast<int>(square.x * static_cast<float>(face_.width));
        voxel[face_.v] += static_cast<int>(square.y * static_cast<float>(face_.width));
        for (int depth = 0; depth < face_.width; ++depth) {
            voxel[face_.axis] =
                face_.corner[face_.axis] + (face_.high ? face_.width - 1 - depth : depth);
            if (!has(own_, voxel)) continue;
            if (depth > 0) return depth;
            voxel[face_.axis] = layer_before_;
            return has(before_, voxel) ? std::nullopt : std::optional(0);
        }
        return std::nullopt;
    }

private:
    const Face& face_;
    std::uint64_t own_ = 0, before_ = 0;
    int layer_before_ = 0;
};

}  // namespace

std::uint32_t side_seed(const uvec3& cell, int direction, int pass) {
    return shared::pixel_seed(cell.x + (cell.y << 16),
                              cell.z * 6u + static_cast<unsigned>(direction),
                              static_cast<std::uint32_t>(pass));
}

SideStarts::SideStarts(const LitObject& object, const uvec3& cell, int direction) {
    const shared::DagView dag = shared::view(object.dag);
    const int width = 1 << (object.dag.depth() - object.attributes.level());
    const Face face(cell, width, direction);
    const std::uint32_t seed = side_seed(cell, direction, 0);
    const auto place = [&](int i) {
        return shared::sample_2d(static_cast<std::uint32_t>(i), seed);
    };
    if (width == 1) {
        if (shared::cell_exists(dag, face.corner + shared::step_across(direction), 0)) return;
        for (int i = 0; i < kMost; ++i)
            rays[static_cast<std::size_t>(count++)] = face.start(place(i), 0);
        return;
    }
    if (width <= 4) {
        const LeafColumns columns(dag, face);
        for (int i = 0; i < kColumns * kColumns && count < kMost; ++i) {
            const vec2 square = place(i);
            if (const auto depth = columns.depth(square))
                rays[static_cast<std::size_t>(count++)] = face.start(square, *depth);
        }
        return;
    }
    const ivec3 before = shared::step_across(direction);
    for (int i = 0; i < kColumns * kColumns && count < kMost; ++i) {
        shared::GridRay ray = face.start(place(i), 0);
        ray.dir = -vec3(before);
        ray.t_max = static_cast<float>(width);
        const shared::GridHit hit = shared::trace_closest(dag, ray, shared::stop_at_voxels());
        if (hit.face != direction || shared::cell_exists(dag, ivec3(hit.path) + before, 0))
            continue;
        rays[static_cast<std::size_t>(count++)] = shared::leave_hit(ray, hit, vec3(before));
    }
}

std::optional<vec3> side_normal(const LitObject& object, const uvec3& cell, int direction) {
    const SideStarts starts(object, cell, direction);
    if (starts.count == 0) return std::nullopt;
    // Of blocks a quarter as wide as the cell, where rays start: a normal of whole cells would be
    // that of all that is five cells around, and a ledge not that wide would face anywhere. Blocks
    // are seen through their face, where that is open; else the voxels themselves are.
    const shared::DagView dag = shared::view(object.dag);
    const int cell_height = object.dag.depth() - object.attributes.level();
    const int block_height = std::max(0, cell_height - kBlocksDepth);
    const ivec3 before = shared::step_across(direction);
    vec3 sum(0.0f);
    const int places = cell_height == 0 ? 1 : std::min(starts.count, kNormals);
    for (int i = 0; i < places; ++i) {
        const shared::GridRay& start = starts.rays[static_cast<std::size_t>(i)];
        const uvec3 voxel(origin_of(start) - 0.5 * dvec3(before));
        shared::GridHit hit{0.0f, voxel >> static_cast<unsigned>(block_height), block_height,
                            direction, 0};
        if (block_height > 0 && shared::cell_exists(dag, ivec3(hit.path) + before, block_height)) {
            hit.path = voxel;
            hit.height = 0;
        }
        sum += smooth_normal(dag, start, hit);
    }
    const float length = glm::length(sum);
    return length > 1e-3f ? sum / length : vec3(before);
}

}  // namespace octavo
