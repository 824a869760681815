// SPDX-License-Identifier: MIT
#include "octavo/render/normal.h"

#include <array>
#include <bit>
#include <cstdint>

namespace octavo {
namespace {

/// Cells on each side of the one that was hit. 7^3 is what fits 64-bit slices with a margin.
constexpr int kRadius = 3;
constexpr int kSide = 2 * kRadius + 1;

/// A block of 7^3 cells: bit x + 8y of slice z. Column and row 7 stay empty, so that a shift by one
/// cell never comes round the edge.
using Block = std::array<std::uint64_t, kSide>;

constexpr std::uint64_t kAllCells = 0x007f7f7f7f7f7f7full;

/// Sets the cells of the block that exist below a node, which is `height` above the block's cells.
void gather(const shared::DagView& dag, std::uint32_t word, const shared::uvec2& leaf, int height,
            int cell_height, const ivec3& corner, Block& block) {
    const int above = height - cell_height;
    if (glm::any(glm::greaterThanEqual(corner, ivec3(kSide))) ||
        glm::any(glm::lessThanEqual(corner + (1 << above), ivec3(0))))
        return;
    if (above == 0) {
        block[static_cast<std::size_t>(corner.z)] |= 1ull << (corner.x + 8 * corner.y);
        return;
    }
    shared::uvec2 voxels = leaf;
    std::uint32_t mask = 0;
    if (height == 1) {
        mask = leaf.x;
    } else if (height == 2) {
        voxels = {dag_load(dag, word), dag_load(dag, word + 1)};
        mask = shared::leaf_children(voxels);
    } else {
        mask = dag_load(dag, word) & 255u;
    }
    for (std::uint32_t left = mask; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        const ivec3 child = corner + (ivec3(i & 1, i >> 1 & 1, i >> 2) << (above - 1));
        const std::uint32_t next = height > 2 ? shared::load_child(dag, word, 1u << i) : 0;
        const shared::uvec2 inside(height == 2 ? shared::leaf_voxels(voxels, i) : 0u, 0u);
        gather(dag, next, inside, height - 1, cell_height, child, block);
    }
}

/// The empty cells that are connected to the cell (x, y, z) through faces, inside the block.
Block connected_space(const Block& occupied, const ivec3& from) {
    Block space{};
    space[static_cast<std::size_t>(from.z)] = 1ull << (from.x + 8 * from.y);
    for (bool grew = true; grew;) {
        grew = false;
        const auto spread = [&](std::size_t z, std::uint64_t neighbours) {
            const std::uint64_t s = space[z];
            const std::uint64_t more =
                (s | s << 1 | s >> 1 | s << 8 | s >> 8 | neighbours) & kAllCells & ~occupied[z];
            grew |= more != s;
            space[z] = more;
        };
        for (std::size_t z = 0; z < kSide; ++z) spread(z, z > 0 ? space[z - 1] : 0);
        for (std::size_t z = kSide; z-- > 0;) spread(z, z + 1 < kSide ? space[z + 1] : 0);
    }
    return space;
}

/// The sum of the faces between the space and the occupied cells, within `radius` of the middle.
ivec3 sum_of_faces(const Block& occupied, const Block& space, int radius) {
    std::uint64_t window = 0;
    for (int y = kRadius - radius; y <= kRadius + radius; ++y)
        for (int x = kRadius - radius; x <= kRadius + radius; ++x) window |= 1ull << (x + 8 * y);
    ivec3 sum(0);
    for (int z = kRadius - radius; z <= kRadius + radius; ++z) {
        const auto k = static_cast<std::size_t>(z);
        const std::uint64_t o = occupied[k] & window;
        const std::uint64_t s = space[k];
        sum.x += std::popcount(o << 1 & s) - std::popcount(o >> 1 & s);
        sum.y += std::popcount(o << 8 & s) - std::popcount(o >> 8 & s);
        if (z + 1 < kSide) sum.z += std::popcount(o & space[k + 1]);
        if (z > 0) sum.z -= std::popcount(o & space[k - 1]);
    }
    return sum;
}

}  // namespace

vec3 face_normal(const shared::GridRay& ray, const shared::GridHit& hit) noexcept {
    if (hit.face >= shared::kFaceInside) return -glm::normalize(ray.dir);
    vec3 normal(0.0f);
    normal[hit.face / 2] = hit.face % 2 == 1 ? 1.0f : -1.0f;
    return normal;
}

vec3 smooth_normal(const shared::DagView& dag, const shared::GridRay& ray,
                   const shared::GridHit& hit) noexcept {
    const vec3 face = face_normal(ray, hit);
    if (hit.face >= shared::kFaceInside) return face;

    Block occupied{};
    const ivec3 corner = -(ivec3(hit.path) - kRadius);
    gather(dag, 0, shared::uvec2(0), dag.depth, hit.height, corner, occupied);
    const Block space = connected_space(occupied, ivec3(kRadius) + ivec3(face));
    ivec3 sum(0);
    for (int radius = 1; radius <= kRadius; ++radius) sum += sum_of_faces(occupied, space, radius);
    const vec3 normal(sum);
    return sum == ivec3(0) ? face : glm::normalize(normal);
}

}  // namespace octavo
