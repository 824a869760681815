// SPDX-License-Identifier: MIT
#include "octavo/voxelize/tile_rasterizer.h"

#include <string_view>

#include "octavo/core/error.h"
#include "octavo/core/morton.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octavo/voxelize/tile_rasterizer.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#include "octavo/voxelize/overlap-inl.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

HWY_INLINE ivec3 ivec_of(Axes axes) {
    HWY_ALIGN std::int32_t numbers[4];
    hn::Store(axes, kAxes, numbers);
    return {numbers[0], numbers[1], numbers[2]};
}
/// Once for many triangles: slow to read back.
HWY_INLINE Axes axes_from(const ivec3& numbers) {
    HWY_ALIGN const std::int32_t all[4] = {numbers.x, numbers.y, numbers.z, 0};
    return hn::Load(kAxes, all);
}

/// An inclusive range of cells of one size, counted from the grid's corner.
struct CellRange {
    ivec3 first, last;

    [[nodiscard]] CellRange coarser(int bits) const { return {first >> bits, last >> bits}; }
    [[nodiscard]] int longest_side() const {
        const ivec3 size = last - first;
        return std::max({size.x, size.y, size.z}) + 1;
    }
    /// For small ranges.
    [[nodiscard]] int count() const {
        const ivec3 size = last - first + 1;
        return size.x * size.y * size.z;
    }
    /// The cells of this range in the window of 4x4x4 cells that starts where it starts.
    [[nodiscard]] std::uint64_t in_window() const {
        const ivec3 size = glm::min(last - first, 3);
        return cells_from_to(0, 0, size.x) & cells_from_to(1, 0, size.y) &
               cells_from_to(2, 0, size.z);
    }
};

/// Where voxels, and cells of 2^bits voxels, lie among the mesh's fixed-point units.
struct Space {
    ivec3 base;
    Axes base_axes;
    int voxel_shift;

    explicit Space(const FixedMesh& mesh)
        : base(mesh.base()), base_axes(axes_from(base)), voxel_shift(mesh.fraction_bits()) {}

    [[nodiscard]] ivec3 corner(const ivec3& cell, int bits) const {
        return ((cell << bits) - base) << voxel_shift;
    }

    /// The first and the last voxels whose closed cubes meet the triangle's bounds.
    [[nodiscard]] HWY_INLINE Axes first_voxel(const std::array<FixedPoint, 3>& corners) const {
        return hn::Add(hn::ShiftRightSame(low_of(corners), voxel_shift), base_axes);
    }
    [[nodiscard]] HWY_INLINE Axes last_voxel(const std::array<FixedPoint, 3>& corners) const {
        return hn::Add(hn::ShiftRightSame(high_of(corners), voxel_shift), base_axes);
    }
};

/// Calls visit(Morton code in the window) for each cell of a mask, in order.
template <class Visit>
HWY_INLINE void for_each_cell(std::uint64_t mask, const Visit& visit) {
    for (; mask != 0; mask &= mask - 1) visit(static_cast<unsigned>(std::countr_zero(mask)));
}

/// Calls visit(cell) for the cells of 2^target_bits voxels that the triangle meets, out of the
/// wanted ones of a window of 4x4x4 cells of 2^bits voxels. bits - target_bits is even and not
/// negative. The recursion is as deep as half that.
template <class Visit>
void descend(const Space& space, const TriangleCells& triangle, const ivec3& first, int bits,
             int target_bits, std::uint64_t wanted, const Visit& visit) {
    const std::uint64_t met =
        triangle.cells(space.corner(first, bits), space.voxel_shift + bits) & wanted;
    for_each_cell(met, [&](unsigned code) {
        const ivec3 cell = first + kCellOfCode[code];
        if (bits == target_bits) {
            visit(cell);
        } else {
            descend(space, triangle, cell << 2, bits - 2, target_bits, ~std::uint64_t{0}, visit);
        }
    });
}

/// Makes the range 4-fold coarser until one window holds it; returns log2 of its cells in voxels.
HWY_INLINE int fit_window(CellRange& range, int bits) {
    while (range.longest_side() > 4) {
        range = range.coarser(2);
        bits += 2;
    }
    return bits;
}

/// Bit i of a number at bit 3i: a load is faster than to shift the bits apart. For what is inside a
/// tile, or the tiles of a grid.
constexpr auto kSpread = [] {
    std::array<std::uint32_t, std::size_t{1} << kMaxTileDepth> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i)
        table[i] = static_cast<std::uint32_t>(morton_encode({i, 0, 0}));
    return table;
}();

/// Morton code of a position inside a tile, in voxels or blocks, or of a tile.
HWY_INLINE std::uint32_t code_of(const ivec3& position) {
    const uvec3 p(position);
    return kSpread[p.x] | kSpread[p.y] << 1 | kSpread[p.z] << 2;
}

/// Marks triangles in one tile.
class Rasterizer {
public:
    Rasterizer(const FixedMesh& mesh, const uvec3& tile, VoxelRule rule, TileBitmap& bitmap)
        : space_(mesh),
          tile_corner_(ivec3(tile) << bitmap.tile_depth()),
          tile_first_(axes_from(tile_corner_)),
          tile_last_(axes_from(tile_corner_ + ((1 << bitmap.tile_depth()) - 1))),
          rule_(rule),
          bitmap_(bitmap) {}

    /// @param holes  of this triangle, or none
    void add(const std::array<FixedPoint, 3>& corners, const CutOuts::Triangle* holes) {
        holes_ = holes;
        const Axes first_of_all = space_.first_voxel(corners);
        const Axes last_of_all = space_.last_voxel(corners);
        const Axes first = hn::Max(first_of_all, tile_first_),
                   last = hn::Min(last_of_all, tile_last_);
        if (axes_of(hn::Gt(first, last)) != 0) return;
        // Bounds that meet one voxel lie inside it. (The thin rule may still leave that voxel out.)
        if (axes_of(hn::Ne(first_of_all, last_of_all)) == 0 && rule_ == VoxelRule::conservative)
            return set_voxel(ivec_of(first));

        const TriangleCells triangle(corners, space_.voxel_shift, rule_);
        const Axes first_block = hn::ShiftRight<2>(first), last_block = hn::ShiftRight<2>(last);
        if (axes_of(hn::Ne(first_block, last_block)) == 0)
            return add_block(triangle, ivec_of(first_block));
        if (fits_window(first, last)) return add_small(triangle, {ivec_of(first), ivec_of(last)});

        CellRange range{ivec_of(first_block), ivec_of(last_block)};
        if (fits_window(first_block, last_block)) return add_blocks(triangle, range);
        const int bits = fit_window(range, 2);
        descend(space_, triangle, range.first, bits, 4, range.in_window(),
                [&](const ivec3& cell) { add_aligned_blocks(triangle, cell << 2); });
    }

private:
    /// Whether a window of 4x4x4 cells that starts at the first one holds them.
    static HWY_INLINE bool fits_window(Axes first, Axes last) {
        return axes_of(hn::Gt(hn::Sub(last, first), hn::Set(kAxes, 3))) == 0;
    }

    void set_voxel(const ivec3& voxel) {
        const std::uint32_t code = code_of(voxel - tile_corner_);
        set_block(code >> 6, std::uint64_t{1} << (code & 63));
    }

    [[nodiscard]] std::uint32_t block_code(const ivec3& block) const {
        return code_of(block - (tile_corner_ >> 2));
    }

    void set_block(std::uint32_t code, std::uint64_t voxels) {
        if (holes_ && voxels != 0)
            voxels = holes_->keep(ivec3(morton_decode(code)) + (tile_corner_ >> 2), voxels);
        bitmap_.set(code, voxels);
    }

    void add_block(const TriangleCells& triangle, const ivec3& block) {
        set_block(block_code(block), triangle.voxels(space_.corner(block, 2)));
    }

    // Up to 4x4x4 voxels that straddle blocks: one test, then bit by bit.
    void add_small(const TriangleCells& triangle, const CellRange& voxels) {
        const std::uint64_t met = triangle.voxels(space_.corner(voxels.first, 0));
        for_each_cell(met & voxels.in_window(),
                      [&](unsigned code) { set_voxel(voxels.first + kCellOfCode[code]); });
    }

    // Up to 4x4x4 blocks, anywhere.
    void add_blocks(const TriangleCells& triangle, const CellRange& blocks) {
        const ivec3 corner = space_.corner(blocks.first, 2);
        constexpr int kFew = 27;  // to ask which of them are met costs more than to fill them
        if (blocks.count() <= kFew) {
            triangle.for_each_block(
                corner, blocks.last - blocks.first + 1, [&](unsigned code, std::uint64_t voxels) {
                    set_block(block_code(blocks.first + kCellOfCode[code]), voxels);
                });
            return;
        }
        fill_window(triangle, corner, blocks.in_window(), [&](unsigned code, std::uint64_t voxels) {
            set_block(block_code(blocks.first + kCellOfCode[code]), voxels);
        });
    }

    // 4x4x4 blocks whose first one is a multiple of 4: their codes follow each other.
    void add_aligned_blocks(const TriangleCells& triangle, const ivec3& first) {
        const std::uint32_t base = block_code(first);
        const ivec3 corner = space_.corner(first, 2);
        if (holes_) {
            return fill_window(
                triangle, corner, ~std::uint64_t{0},
                [&](unsigned code, std::uint64_t voxels) { set_block(base + code, voxels); });
        }
        TileBitmap::Window window(bitmap_, base);
        fill_window(
            triangle, corner, ~std::uint64_t{0},
            [&](unsigned code, std::uint64_t voxels) { window.add(code, voxels); },
            [&](std::uint64_t blocks) { window.prefetch(blocks); });
    }

    struct NoPrefetch {
        void operator()(std::uint64_t) const {}
    };

    template <class Set, class Prefetch = NoPrefetch>
    HWY_INLINE void fill_window(const TriangleCells& triangle, const ivec3& corner,
                                std::uint64_t wanted, const Set& set,
                                const Prefetch& prefetch = {}) {
        const TriangleCells::Blocks blocks = triangle.blocks(corner);
        const std::uint64_t met = blocks.met & wanted;
        if (met == 0) return;
        prefetch(met);
        const TriangleCells::BlockVoxels voxels(triangle, corner);
        for_each_cell(met & blocks.inside,
                      [&](unsigned code) { set(code, voxels.voxels_of_plane(code)); });
        for_each_cell(met & ~blocks.inside, [&](unsigned code) { set(code, voxels.voxels(code)); });
    }

    Space space_;
    ivec3 tile_corner_;
    Axes tile_first_, tile_last_;
    VoxelRule rule_;
    TileBitmap& bitmap_;
    const CutOuts::Triangle* holes_ = nullptr;
};

void RasterizeTile(const FixedMesh& mesh, const HoleLookup* lookup,
                   std::span<const TileTriangle> triangles, const uvec3& tile, VoxelRule rule,
                   TileBitmap& bitmap) {
    Rasterizer rasterizer(mesh, tile, rule, bitmap);
    std::array<FixedPoint, 3> corners;
    CutOuts::Triangle holes;
    constexpr std::size_t kCornersAhead = 8, kTriangleAhead = 24;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (i + kTriangleAhead < triangles.size())
            mesh.prefetch_triangle(triangles[i + kTriangleAhead].triangle);
        if (i + kCornersAhead < triangles.size())
            mesh.prefetch_corners(triangles[i + kCornersAhead].triangle);
        const TileTriangle& t = triangles[i];
        if (!mesh.corners(t.triangle, corners)) continue;
        const bool has_holes = lookup != nullptr && lookup->find(t.triangle, holes);
        rasterizer.add(corners, has_holes ? &holes : nullptr);
    }
}

void FindTiles(const FixedMesh& mesh, std::uint32_t begin, std::uint32_t end, int grid_depth,
               int tile_depth, std::vector<TileTriangle>& out) {
    const Space space(mesh);
    const Axes grid_last = hn::Set(kAxes, (1 << grid_depth) - 1);
    std::array<FixedPoint, 3> corners;
    for (std::uint32_t t = begin; t < end; ++t) {
        if (!mesh.corners(t, corners)) continue;
        const Axes first = hn::Max(space.first_voxel(corners), hn::Zero(kAxes));
        const Axes last = hn::Min(space.last_voxel(corners), grid_last);
        if (axes_of(hn::Gt(first, last)) != 0) continue;

        const auto emit = [&](const ivec3& tile) { out.push_back({code_of(tile), t}); };
        const Axes first_tile = hn::ShiftRightSame(first, tile_depth);
        const Axes last_tile = hn::ShiftRightSame(last, tile_depth);
        if (axes_of(hn::Ne(first_tile, last_tile)) == 0) {
            emit(ivec_of(first_tile));
            continue;
        }
        const TriangleCells triangle(corners, space.voxel_shift, VoxelRule::conservative);
        CellRange range{ivec_of(first_tile), ivec_of(last_tile)};
        const int bits = fit_window(range, tile_depth);
        descend(space, triangle, range.first, bits, tile_depth, range.in_window(), emit);
    }
}

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octavo {

HWY_EXPORT(RasterizeTile);
HWY_EXPORT(FindTiles);

void find_tiles(const FixedMesh& mesh, std::uint32_t begin, std::uint32_t end, int grid_depth,
                int tile_depth, std::vector<TileTriangle>& out) {
    HWY_DYNAMIC_DISPATCH(FindTiles)(mesh, begin, end, grid_depth, tile_depth, out);
}

void rasterize_tile(const FixedMesh& mesh, const HoleLookup* holes,
                    std::span<const TileTriangle> triangles, const uvec3& tile, VoxelRule rule,
                    TileBitmap& bitmap) {
    HWY_DYNAMIC_DISPATCH(RasterizeTile)(mesh, holes, triangles, tile, rule, bitmap);
}

std::vector<const char*> simd_targets() {
    std::vector<const char*> names;
    for (const auto target : hwy::SupportedAndGeneratedTargets())
        names.push_back(hwy::TargetName(target));
    return names;
}

void force_simd_target(const char* name) {
    hwy::SetSupportedTargetsForTest(0);  // back to what the machine has
    if (name == nullptr) return;
    for (const auto target : hwy::SupportedAndGeneratedTargets()) {
        if (std::string_view(hwy::TargetName(target)) != name) continue;
        hwy::SetSupportedTargetsForTest(target);
        return;
    }
    throw Error(Errc::bad_argument, std::string("this machine has no SIMD target ") + name);
}

}  // namespace octavo
#endif
