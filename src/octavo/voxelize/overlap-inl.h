// SPDX-License-Identifier: MIT
// Schwarz and Seidel, "Fast Parallel Surface and Solid Voxelization on GPUs", 2010: a triangle meets a
// box exactly when their bounds meet, the triangle's plane meets the box, and the triangle meets the box
// in each of the three axis-aligned projections. See docs/voxel-rules.md.
//
// Included once for every SIMD target (Highway's foreach_target), so the guard toggles.
#if defined(OCTAVO_VOXELIZE_OVERLAP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTAVO_VOXELIZE_OVERLAP_INL_H
#undef OCTAVO_VOXELIZE_OVERLAP_INL_H
#else
#define OCTAVO_VOXELIZE_OVERLAP_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

#include "octavo/voxelize/cell_masks.h"
#include "octavo/voxelize/fixed_point.h"
#include "octavo/voxelize/rule.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

__extension__ typedef __int128 Int128;

/// Bit i is set where lane i is not negative.
template <class D>
HWY_INLINE std::uint32_t non_negative(D d, hn::Vec<D> v) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::Lt(v, hn::Zero(d)), bytes);
    constexpr std::uint32_t kLanes = (1u << hn::MaxLanes(D())) - 1u;
    return ~(bytes[0] | std::uint32_t{bytes[1]} << 8) & kLanes;
}

/// Tests one triangle against 4x4x4 cells at a time.
///
/// A cell is a closed cube of 2^shift units. Every test is a linear function of the cell's corner that
/// must not be negative. On the cells of one 4x4x4 window it is  value + 2^shift * step(cell)  with
/// small integer steps, and  value + 2^shift * step >= 0  exactly when  (value >> shift) + step >= 0:
/// so the wide part is done once for a window and the lanes need 32 bits, without rounding anywhere.
class TriangleCells {
public:
    /// @param voxel_shift  log2 of a voxel in units: cells of this size follow `rule`, larger ones hold
    ///                     every voxel of theirs that either rule could mark
    TriangleCells(const std::array<FixedPoint, 3>& corners, int voxel_shift, VoxelRule rule);

    struct Overlap {
        std::uint64_t cells;   // Morton order; those that the triangle meets
        std::uint64_t inside;  // of these, the ones whose shadow along the normal's main axis lies
                               // inside the triangle's shadow: only the plane is left to test
    };

    /// The 4x4x4 cells of 2^shift units from this corner. kInside: fill `inside` as well.
    template <bool kInside>
    HWY_INLINE Overlap cells(const ivec3& corner, int shift) const {
        Overlap result;
        result.cells = in_bounds(corner, shift) & on_plane(corner, shift, cell_plane_);
        result.cells &= in_projections<kInside>(corner, shift, edge_offset_, &result.inside);
        if (kInside) result.inside &= result.cells;
        return result;
    }

    /// The 4x4x4 voxels from this corner, by the rule.
    HWY_INLINE std::uint64_t voxels(const ivec3& corner) const {
        return in_bounds(corner, voxel_shift_) & on_plane(corner, voxel_shift_, voxel_plane_) &
               in_projections<false>(corner, voxel_shift_, voxel_edge_offset_, nullptr);
    }

    /// The same for a window inside a cell that `cells` reported as inside.
    HWY_INLINE std::uint64_t voxels_of_plane(const ivec3& corner) const {
        return on_plane(corner, voxel_shift_, voxel_plane_);
    }

private:
    static constexpr int kEdges = 9;  // 3 projections x 3 edges
    static constexpr hn::CappedTag<std::int32_t, 16> kInt32{};
    static constexpr hn::CappedTag<std::int64_t, 8> kInt64{};

    // The plane passes a cell when 0 <= value + n . corner <= range, both scaled by the cell's size.
    struct PlaneTest {
        std::int64_t low;    // units of 2^(shift - 1), so that half a voxel is whole
        std::int64_t range;  // units of 2^shift
    };

    HWY_INLINE std::uint64_t in_bounds(const ivec3& corner, int shift) const {
        std::uint64_t mask = ~std::uint64_t{0};
        for (int axis = 0; axis < 3; ++axis) {
            // A closed cell meets closed bounds when it begins at or before their end, and ends at or
            // after their beginning: bounds_low_ is one unit less, so that >> finds the first such cell.
            const int first = std::clamp((bounds_low_[axis] - corner[axis]) >> shift, 0, 4);
            const int last = std::clamp((bounds_high_[axis] - corner[axis]) >> shift, -1, 3);
            mask &= cells_from_to(axis, first, last);
        }
        return mask;
    }

    HWY_INLINE std::uint64_t on_plane(const ivec3& corner, int shift, const PlaneTest& test) const {
        const Int128 value = Int128{normal_[0]} * (corner.x - vertex_.x) +
                               Int128{normal_[1]} * (corner.y - vertex_.y) +
                               Int128{normal_[2]} * (corner.z - vertex_.z) +
                               ((Int128{test.low} << shift) >> 1);
        const Int128 quotient = value >> shift;
        const bool exact = quotient << shift == value;
        // value + s <= range, all scaled by 2^shift, is quotient + s <= range or, where a remainder
        // was cut off, one less.
        const std::int64_t range = test.range - (exact ? 0 : 1);
        return narrow_plane_ ? plane_lanes_32(quotient, range) : plane_lanes_64(quotient, range);
    }

    HWY_INLINE std::uint64_t plane_lanes_32(Int128 quotient, std::int64_t range) const {
        constexpr Int128 kFar = 1 << 30;
        const auto q = static_cast<std::int32_t>(std::clamp(quotient, -kFar, kFar));
        const auto last = hn::Set(kInt32, static_cast<std::int32_t>(range));
        std::uint64_t mask = 0;
        constexpr int kLanes = static_cast<int>(hn::MaxLanes(kInt32));
        for (int quarter = 0; quarter < 4; ++quarter) {  // (y1, z1) of the Morton code
            const auto start = hn::Set(
                kInt32, q + static_cast<std::int32_t>(2 * ((quarter & 1) * normal_[1] +
                                                           (quarter >> 1) * normal_[2])));
            for (int i = 0; i < 16; i += kLanes) {
                const auto w = hn::Add(hn::Load(kInt32, plane_steps_32_ + i), start);
                const std::uint64_t bits = non_negative(kInt32, hn::Or(w, hn::Sub(last, w)));
                mask |= bits << (16 * quarter + i);
            }
        }
        return mask;
    }

    HWY_INLINE std::uint64_t plane_lanes_64(Int128 quotient, std::int64_t range) const {
        constexpr Int128 kFar = std::int64_t{1} << 57;
        const auto q = static_cast<std::int64_t>(std::clamp(quotient, -kFar, kFar));
        const auto last = hn::Set(kInt64, range);
        std::uint64_t mask = 0;
        constexpr int kLanes = static_cast<int>(hn::MaxLanes(kInt64));
        for (int eighth = 0; eighth < 8; ++eighth) {  // (x1, y1, z1) of the Morton code
            const auto start = hn::Set(kInt64, q + 2 * ((eighth & 1) * normal_[0] +
                                                        (eighth >> 1 & 1) * normal_[1] +
                                                        (eighth >> 2) * normal_[2]));
            for (int i = 0; i < 8; i += kLanes) {
                const auto w = hn::Add(hn::Load(kInt64, plane_steps_64_ + i), start);
                const std::uint64_t bits = non_negative(kInt64, hn::Or(w, hn::Sub(last, w)));
                mask |= bits << (8 * eighth + i);
            }
        }
        return mask;
    }

    template <bool kInside>
    HWY_INLINE std::uint64_t in_projections(const ivec3& corner, int shift,
                                            const std::int64_t* edge_offset,
                                            std::uint64_t* inside) const {
        // A step is below 2^28: beyond this bound its sign is the value's.
        constexpr std::int64_t kFar = 1 << 29;
        constexpr int kLanes = static_cast<int>(hn::MaxLanes(kInt32));
        std::uint64_t mask = ~std::uint64_t{0};
        for (int p = 0; p < 3; ++p) {
            const std::int64_t u = corner[p];
            const std::int64_t v = corner[p == 2 ? 0 : p + 1];
            std::int32_t value[3];
            for (int k = 0; k < 3; ++k) {
                const int e = 3 * p + k;
                const std::int64_t wide = edge_u_[e] * u + edge_v_[e] * v + edge_offset[e];
                value[k] = static_cast<std::int32_t>(std::clamp(wide >> shift, -kFar, kFar));
            }
            const bool want_inside = kInside && p == main_projection_;
            std::uint32_t squares = 0;
            std::uint32_t inside_squares = 0;
            for (int i = 0; i < 16; i += kLanes) {
                const auto w0 = hn::Add(hn::Load(kInt32, edge_steps_[3 * p] + i),
                                        hn::Set(kInt32, value[0]));
                const auto w1 = hn::Add(hn::Load(kInt32, edge_steps_[3 * p + 1] + i),
                                        hn::Set(kInt32, value[1]));
                const auto w2 = hn::Add(hn::Load(kInt32, edge_steps_[3 * p + 2] + i),
                                        hn::Set(kInt32, value[2]));
                squares |= non_negative(kInt32, hn::Or(w0, hn::Or(w1, w2))) << i;
                if (want_inside) {
                    const auto i0 = hn::Sub(w0, hn::Set(kInt32, edge_reach_[3 * p]));
                    const auto i1 = hn::Sub(w1, hn::Set(kInt32, edge_reach_[3 * p + 1]));
                    const auto i2 = hn::Sub(w2, hn::Set(kInt32, edge_reach_[3 * p + 2]));
                    inside_squares |= non_negative(kInt32, hn::Or(i0, hn::Or(i1, i2))) << i;
                }
            }
            mask &= cells_over_squares(p, squares);
            if (want_inside) *inside = cells_over_squares(p, inside_squares);
        }
        return mask;
    }

    // 16 steps of each edge test over the squares of a projection, u + 4v, for conservative cells.
    HWY_ALIGN std::int32_t edge_steps_[kEdges][16];
    HWY_ALIGN std::int32_t plane_steps_32_[16];
    HWY_ALIGN std::int64_t plane_steps_64_[8];
    std::int64_t edge_u_[kEdges], edge_v_[kEdges];  // inward normals of the projected edges
    std::int64_t edge_offset_[kEdges];
    std::int64_t voxel_edge_offset_[kEdges];
    std::int32_t edge_reach_[kEdges];  // |u| + |v|: across a cell
    std::int64_t normal_[3];
    PlaneTest cell_plane_, voxel_plane_;
    ivec3 vertex_, bounds_low_, bounds_high_;
    int main_projection_;
    int voxel_shift_;
    bool narrow_plane_;
};

inline TriangleCells::TriangleCells(const std::array<FixedPoint, 3>& corners, int voxel_shift,
                                    VoxelRule rule)
    : voxel_shift_(voxel_shift) {
    const ivec3 c[3] = {{corners[0].x, corners[0].y, corners[0].z},
                        {corners[1].x, corners[1].y, corners[1].z},
                        {corners[2].x, corners[2].y, corners[2].z}};
    vertex_ = c[0];
    bounds_low_ = glm::min(c[0], glm::min(c[1], c[2])) - 1;
    bounds_high_ = glm::max(c[0], glm::max(c[1], c[2]));

    const ivec3 e1 = c[1] - c[0], e2 = c[2] - c[0];
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        normal_[axis] = std::int64_t{e1[u]} * e2[v] - std::int64_t{e1[v]} * e2[u];
    }
    const bool degenerate = (normal_[0] | normal_[1] | normal_[2]) == 0;
    const bool thin = rule == VoxelRule::thin && !degenerate;

    // Orientation of each projection, before the normal is shortened below. Where a projection has no
    // area either sign serves: its edges run both ways along one line and bound it from both sides.
    const int sign[3] = {normal_[2] < 0 ? -1 : 1, normal_[0] < 0 ? -1 : 1, normal_[1] < 0 ? -1 : 1};

    std::int64_t size[3] = {std::abs(normal_[0]), std::abs(normal_[1]), std::abs(normal_[2])};
    const std::int64_t total = size[0] + size[1] + size[2];
    std::int64_t largest = std::max({size[0], size[1], size[2]});
    main_projection_ = largest == size[2] ? 0 : largest == size[0] ? 1 : 2;
    if (total == largest && total > 1) {  // parallel to a face of the grid: any length will do
        for (int axis = 0; axis < 3; ++axis) {
            normal_[axis] = normal_[axis] > 0 ? 1 : normal_[axis] < 0 ? -1 : 0;
            size[axis] = std::abs(normal_[axis]);
        }
        largest = 1;
    }
    std::int64_t positive = 0, sum = 0, reach = 0;
    for (int axis = 0; axis < 3; ++axis) {
        positive += std::max<std::int64_t>(normal_[axis], 0);
        sum += normal_[axis];
        reach += size[axis];
    }
    cell_plane_ = {2 * positive, reach};
    voxel_plane_ = thin ? PlaneTest{sum + largest, largest} : cell_plane_;

    narrow_plane_ = largest <= 1 << 26;
    for (int i = 0; i < 16; ++i) {
        const std::int64_t step = (i & 1) * normal_[0] + (i >> 1 & 1) * normal_[1] +
                                  (i >> 2 & 1) * normal_[2];
        plane_steps_32_[i] =
            narrow_plane_ ? static_cast<std::int32_t>(step + (i >> 3) * 2 * normal_[0]) : 0;
        if (i < 8) plane_steps_64_[i] = step;
    }

    for (int p = 0; p < 3; ++p) {
        const int u = p, v = p == 2 ? 0 : p + 1;
        for (int k = 0; k < 3; ++k) {
            const int e = 3 * p + k;
            const ivec3& from = c[k];
            const ivec3& to = c[k == 2 ? 0 : k + 1];
            const std::int32_t nu = sign[p] * (from[v] - to[v]);
            const std::int32_t nv = sign[p] * (to[u] - from[u]);
            edge_u_[e] = nu;
            edge_v_[e] = nv;
            edge_reach_[e] = std::abs(nu) + std::abs(nv);
            edge_offset_[e] = -(edge_u_[e] * from[u] + edge_v_[e] * from[v]);
            const std::int32_t best_corner = std::max(nu, 0) + std::max(nv, 0);
            for (int i = 0; i < 16; ++i)
                edge_steps_[e][i] = (i & 3) * nu + (i >> 2) * nv + best_corner;

            voxel_edge_offset_[e] = edge_offset_[e];
            if (thin) {
                // The edge passes within half a voxel, along u or v, of the voxel's centre. Written
                // as a correction of the corner that the steps above already contain.
                const std::int64_t twice = std::int64_t{nu} + nv +
                                           std::max(std::abs(nu), std::abs(nv)) - 2 * best_corner;
                voxel_edge_offset_[e] += twice << (voxel_shift - 1);
            }
        }
    }
}

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
