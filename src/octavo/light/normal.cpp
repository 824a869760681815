// SPDX-License-Identifier: MIT
#include "octavo/light/normal.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace octavo {
namespace {

/// Cells on each side of the one that was hit: with 5, the steps of a cylinder 40 cells across
/// still show, faintly; with 3 they are stripes.
constexpr int kRadius = 5;
constexpr int kSide = 2 * kRadius + 1;

/// One layer of a block of 11^3 cells: 12 rows of 16 bits, four rows to a word. The last row and
/// the last columns stay empty, so that a shift by one cell never comes round an edge.
struct Layer {
    std::array<std::uint64_t, 3> words{};

    void set(int x, int y) { words[y / 4u] |= 1ull << (x + 16 * (y % 4)); }
    friend bool operator==(const Layer&, const Layer&) = default;
};

template <typename Function>
Layer each_word(const Function& function) {
    Layer result;
    for (std::size_t i = 0; i < 3; ++i) result.words[i] = function(i);
    return result;
}

Layer row_up(const Layer& l) {
    return {{l.words[0] << 16, l.words[1] << 16 | l.words[0] >> 48,
             l.words[2] << 16 | l.words[1] >> 48}};
}
Layer row_down(const Layer& l) {
    return {{l.words[0] >> 16 | l.words[1] << 48, l.words[1] >> 16 | l.words[2] << 48,
             l.words[2] >> 16}};
}

/// The cells of the middle (2 radius + 1)^2.
Layer window(int radius) {
    Layer window;
    for (int y = kRadius - radius; y <= kRadius + radius; ++y)
        for (int x = kRadius - radius; x <= kRadius + radius; ++x) window.set(x, y);
    return window;
}

using Block = std::array<Layer, kSide>;

const Layer kAllCells = window(kRadius);

/// Weighted together, the faces near the hit count more, and cells fade in as the block moves on.
constexpr std::array kWindowRadii = {1, 2, 3, 4, 5};
const std::array<Layer, kWindowRadii.size()> kWindows = {window(1), window(2), window(3), window(4),
                                                         window(5)};

/// Adds a 2x2x2 block of cells, a child mask, whose low corner may lie outside by one.
void add_cells(std::uint32_t mask, const ivec3& corner, Block& block) {
    for (int z = std::max(0, -corner.z); z < 2 && corner.z + z < kSide; ++z) {
        Layer& layer = block[static_cast<unsigned>(corner.z + z)];
        for (int y = std::max(0, -corner.y); y < 2 && corner.y + y < kSide; ++y) {
            std::uint64_t row = mask >> (2 * y + 4 * z) & 3u;
            row = corner.x < 0 ? row >> 1 : row << corner.x & 0x7ffu;
            const auto at = static_cast<unsigned>(corner.y + y);
            layer.words[at / 4u] |= row << 16u * (at % 4u);
        }
    }
}

bool meets_block(const ivec3& corner, int width) {
    return corner.x < kSide && corner.y < kSide && corner.z < kSide && corner.x > -width &&
           corner.y > -width && corner.z > -width;
}

/// Sets the cells of the block that exist below a node, which is `height` above the voxels and
/// meets the block. Whole child masks are set, not cells: this was half the time of a picture.
///
/// @param inside  at height 1, where there are no words of its own: the child mask
void gather(const shared::DagView& dag, std::uint32_t word, std::uint32_t inside, int height,
            int cell_height, const ivec3& corner, Block& block) {
    const int above = height - cell_height;
    shared::uvec2 voxels(0u);
    std::uint32_t mask = inside;
    if (height == 2) {
        voxels = {dag_load(dag, word), dag_load(dag, word + 1)};
        mask = shared::leaf_children(voxels);
    } else if (height > 2) {
        mask = dag_load(dag, word) & 255u;
    }
    if (above == 1) return add_cells(mask, corner, block);
    std::uint32_t pointer = word;
    for (std::uint32_t left = mask; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        ++pointer;
        const ivec3 child = corner + (ivec3(i & 1, i >> 1 & 1, i >> 2) << (above - 1));
        if (!meets_block(child, 1 << (above - 1))) continue;
        if (height == 2)
            gather(dag, 0, shared::leaf_voxels(voxels, i), 1, cell_height, child, block);
        else
            gather(dag, dag_load(dag, pointer), 0, height - 1, cell_height, child, block);
    }
}

/// The empty cells that are connected to one cell through faces, inside the block; and that cell,
/// which is full where a large cell has no open face.
Block connected_space(const Block& occupied, const ivec3& from) {
    Block space{};
    space[static_cast<std::size_t>(from.z)].set(from.x, from.y);
    const Layer nothing;
    for (bool grew = true; grew;) {
        grew = false;
        const auto spread = [&](std::size_t z, const Layer& neighbour) {
            const Layer s = space[z];
            const Layer up = row_up(s);
            const Layer down = row_down(s);
            space[z] = each_word([&](std::size_t i) {
                const std::uint64_t w = s.words[i];
                const std::uint64_t wide =
                    w << 1 | w >> 1 | up.words[i] | down.words[i] | neighbour.words[i];
                return w | (wide & kAllCells.words[i] & ~occupied[z].words[i]);
            });
            grew |= space[z] != s;
        };
        for (std::size_t z = 0; z < kSide; ++z) spread(z, z > 0 ? space[z - 1] : nothing);
        for (std::size_t z = kSide; z-- > 0;) spread(z, z + 1 < kSide ? space[z + 1] : nothing);
    }
    return space;
}

void add(int axis, int upwards, int downwards, shared::FaceSum& faces) {
    faces.sum[axis] += upwards - downwards;
    faces.count += upwards + downwards;
}

/// Adds the faces of the occupied cells inside a window.
void add_faces(const Block& occupied, const Block& space, int radius, const Layer& within,
               shared::FaceSum& faces) {
    const Layer nothing;
    for (int z = kRadius - radius; z <= kRadius + radius; ++z) {
        const auto k = static_cast<std::size_t>(z);
        const Layer cells =
            each_word([&](std::size_t i) { return occupied[k].words[i] & within.words[i]; });
        const Layer up = row_up(cells);
        const Layer down = row_down(cells);
        const Layer& above = k + 1 < kSide ? space[k + 1] : nothing;
        const Layer& below = k > 0 ? space[k - 1] : nothing;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint64_t s = space[k].words[i];
            const std::uint64_t c = cells.words[i];
            add(0, std::popcount(c << 1 & s), std::popcount(c >> 1 & s), faces);
            add(1, std::popcount(up.words[i] & s), std::popcount(down.words[i] & s), faces);
            add(2, std::popcount(c & above.words[i]), std::popcount(c & below.words[i]), faces);
        }
    }
}

}  // namespace

vec3 smooth_normal(const shared::DagView& dag, const shared::GridRay& ray,
                   const shared::GridHit& hit) noexcept {
    const vec3 face = face_normal(ray, hit);
    if (hit.face >= shared::kFaceInside) return face;

    Block occupied{};
    const ivec3 corner = -(ivec3(hit.path) - kRadius);
    if (hit.height == dag.depth)
        occupied[kRadius].set(kRadius, kRadius);
    else
        gather(dag, 0, 0, dag.depth, hit.height, corner, occupied);
    const Block space = connected_space(occupied, ivec3(kRadius) + ivec3(face));
    shared::FaceSum faces{ivec3(0), 0};
    for (std::size_t i = 0; i < kWindows.size(); ++i)
        add_faces(occupied, space, kWindowRadii[i], kWindows[i], faces);
    return normal_of_faces(faces, face);
}

}  // namespace octavo
