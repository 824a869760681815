// SPDX-License-Identifier: MIT
// Schwarz and Seidel, "Fast Parallel Surface and Solid Voxelization on GPUs", 2010: a triangle
// meets a box exactly when their bounds meet, the triangle's plane meets the box, and the triangle
// meets the box in each of the three axis-aligned projections. See docs/voxel-rules.md.
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

/// Bit i is set where lane i is negative.
template <class D>
HWY_INLINE std::uint64_t negative(D d, hn::Vec<D> v) {
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, hn::Lt(v, hn::Zero(d)), reinterpret_cast<std::uint8_t*>(&bits));
    return bits;
}

/// Tests one triangle against 4x4x4 cells at a time.
///
/// A cell is a closed cube of 2^shift units. Every test is a linear function of the cell's corner
/// that must not be negative. On the cells of one 4x4x4 window it is  value + 2^shift * step(cell)
/// with small integer steps, and  value + 2^shift * step >= 0  exactly when  (value >> shift) +
/// step >= 0: so the wide part is done once for a window and the lanes need few bits, without
/// rounding anywhere.
class TriangleCells {
    static constexpr int kEdges = 9;       // 3 projections x 3 edges
    static constexpr int kEdgeLanes = 16;  // a whole number of vectors

    // A window of cells against the plane: a cell passes when 0 <= value + step(cell) <= last.
    struct PlaneValue {
        std::int64_t value, last;
    };

    // A window of cells against the edges: a cell passes when value + step(cell) >= 0 for each
    // edge.
    struct EdgeValues {
        HWY_ALIGN std::int32_t value[kEdgeLanes];
    };

public:
    /// @param voxel_shift  log2 of a voxel in units: cells of this size follow `rule`, larger ones
    /// hold
    ///                     every voxel of theirs that either rule could mark
    TriangleCells(const std::array<FixedPoint, 3>& corners, int voxel_shift, VoxelRule rule);

    /// The 4x4x4 cells of 2^shift units from this corner that the triangle meets, in Morton order.
    HWY_INLINE std::uint64_t cells(const ivec3& corner, int shift) const {
        const PlaneValue plane = plane_value(corner, shift, cell_plane_);
        EdgeValues edges;
        edge_values(corner, shift, edge_offset_, edges);
        return in_bounds(corner, shift) & on_plane(plane) & in_projections(edges);
    }

    /// The 4x4x4 voxels from this corner that the triangle marks by the rule.
    HWY_INLINE std::uint64_t voxels(const ivec3& corner) const {
        const PlaneValue plane = plane_value(corner, voxel_shift_, voxel_plane_);
        EdgeValues edges;
        edge_values(corner, voxel_shift_, voxel_edge_offset_, edges);
        return in_bounds(corner, voxel_shift_) & on_plane(plane) & in_projections(edges);
    }

    /// The blocks of 4x4x4 voxels in a window of 4x4x4 blocks.
    struct Blocks {
        std::uint64_t met;     // Morton order; those that the triangle meets
        std::uint64_t inside;  // of these, the ones whose shadow along the normal's main axis lies
                               // inside the triangle's shadow: only the plane is left to test
    };
    HWY_INLINE Blocks blocks(const ivec3& corner) const {
        const int shift = voxel_shift_ + 2;
        const PlaneValue plane = plane_value(corner, shift, cell_plane_);
        EdgeValues edges;
        edge_values(corner, shift, edge_offset_, edges);
        Blocks blocks;
        blocks.met = in_bounds(corner, shift) & on_plane(plane) & in_projections(edges);
        // A triangle without area has a shadow without edges, and nothing is inside that.
        blocks.inside = has_area_ ? blocks.met & inside_main_projection(edges) : 0;
        return blocks;
    }

    /// What the tests of a window's blocks have in common: from one block to the next each value
    /// changes by four voxels' steps, so the wide products are taken once for 64 blocks.
    class BlockVoxels {
    public:
        HWY_INLINE BlockVoxels(const TriangleCells& triangle, const ivec3& corner)
            : triangle_(triangle),
              corner_(corner),
              plane_(triangle.plane_value(corner, triangle.voxel_shift_, triangle.voxel_plane_)) {
            triangle.edge_values(corner, triangle.voxel_shift_, triangle.voxel_edge_offset_,
                                 edges_);
        }

        /// The voxels of the block with this Morton code in the window.
        HWY_INLINE std::uint64_t voxels(unsigned code) const {
            const TriangleCells& t = triangle_;
            const ivec3& block = kCellOfCode[code];
            const auto x = hn::Set(kInt32, 4 * block.x);
            const auto y = hn::Set(kInt32, 4 * block.y);
            const auto z = hn::Set(kInt32, 4 * block.z);
            EdgeValues edges;
            for (int e = 0; e < kEdgeLanes; e += kLanes32) {
                const auto along_x = hn::Mul(hn::Load(kInt32, t.edge_axes_[0] + e), x);
                const auto along_y = hn::Mul(hn::Load(kInt32, t.edge_axes_[1] + e), y);
                const auto along_z = hn::Mul(hn::Load(kInt32, t.edge_axes_[2] + e), z);
                const auto here = hn::Load(kInt32, edges_.value + e);
                hn::Store(hn::Add(hn::Add(here, along_x), hn::Add(along_y, along_z)), kInt32,
                          edges.value + e);
            }
            return t.in_bounds(corner_ + (block << (t.voxel_shift_ + 2)), t.voxel_shift_) &
                   voxels_of_plane(code) & t.in_projections(edges);
        }

        /// The same for a block that is inside.
        HWY_INLINE std::uint64_t voxels_of_plane(unsigned code) const {
            const std::int64_t* steps = triangle_.exact_plane_steps_;
            return triangle_.on_plane(
                {plane_.value + 4 * (steps[code & 7u] + 2 * steps[code >> 3]), plane_.last});
        }

    private:
        const TriangleCells& triangle_;
        ivec3 corner_;
        PlaneValue plane_;
        EdgeValues edges_;
    };

private:
    static constexpr hn::CappedTag<std::int32_t, 16> kInt32{};
    static constexpr hn::CappedTag<std::int64_t, 8> kInt64{};
    static constexpr int kLanes32 = static_cast<int>(hn::MaxLanes(kInt32));
    static constexpr int kLanes64 = static_cast<int>(hn::MaxLanes(kInt64));

    static HWY_INLINE hn::Vec<decltype(kInt32)> load(const std::int32_t* lanes) {
        return hn::Load(kInt32, lanes);
    }

    /// Lanes i.. of  a x + b y + c.
    static HWY_INLINE hn::Vec<decltype(kInt32)> linear(int i, std::int32_t a, const std::int32_t* x,
                                                       std::int32_t b, const std::int32_t* y,
                                                       hn::Vec<decltype(kInt32)> c) {
        return hn::Add(hn::Add(hn::Mul(hn::Set(kInt32, a), load(x + i)),
                               hn::Mul(hn::Set(kInt32, b), load(y + i))),
                       c);
    }

    // The plane passes a cell when 0 <= low + n . (corner - vertex) <= range.
    struct PlaneTest {
        std::int64_t low;    // in 2^(shift - 1), so that half a voxel is whole
        std::int64_t range;  // in 2^shift
    };

    HWY_INLINE std::uint64_t in_bounds(const ivec3& corner, int shift) const {
        std::uint64_t mask = ~std::uint64_t{0};
        for (int axis = 0; axis < 3; ++axis) {
            // A closed cell meets closed bounds when it begins at or before their end, and ends at
            // or after their beginning: bounds_low_ is one unit less, so that >> finds the first
            // such cell.
            const int first = std::clamp((bounds_low_[axis] - corner[axis]) >> shift, 0, 4);
            const int last = std::clamp((bounds_high_[axis] - corner[axis]) >> shift, -1, 3);
            mask &= cells_from_to(axis, first, last);
        }
        return mask;
    }

    HWY_INLINE PlaneValue plane_value(const ivec3& corner, int shift, const PlaneTest& test) const {
        return short_plane_ ? plane_value_in<std::int64_t>(corner, shift, test)
                            : plane_value_in<Int128>(corner, shift, test);
    }

    template <class Int>
    HWY_INLINE PlaneValue plane_value_in(const ivec3& corner, int shift,
                                         const PlaneTest& test) const {
        const Int value =
            Int{normal_[0]} * (corner.x - vertex_.x) + Int{normal_[1]} * (corner.y - vertex_.y) +
            Int{normal_[2]} * (corner.z - vertex_.z) + ((Int{test.low} << shift) >> 1);
        const Int quotient = value >> shift;
        // value + s <= range, in whole 2^shift, is quotient + s <= range; where a remainder was cut
        // off, one less.
        const bool exact = quotient << shift == value;
        // Steps within a window of windows stay below 2^57: beyond twice that the sign is decided.
        constexpr Int kFar = std::int64_t{1} << 58;
        return {static_cast<std::int64_t>(std::clamp(quotient, -kFar, kFar)),
                test.range - (exact ? 0 : 1)};
    }

    /// The cells of a window whose value and step are on the plane. Normals have up to 51 bits; the
    /// 26 highest decide nearly always, and where they do not all bits are asked.
    HWY_INLINE std::uint64_t on_plane(const PlaneValue& plane) const {
        constexpr std::int64_t kFar = 1 << 30;
        const auto high =
            static_cast<std::int32_t>(std::clamp(plane.value >> plane_low_bits_, -kFar, kFar));
        const auto high_last = static_cast<std::int32_t>(plane.last >> plane_low_bits_);
        const auto v = hn::Set(kInt32, high);
        const auto r = hn::Set(kInt32, high_last);
        if (plane_low_bits_ == 0) {
            std::uint64_t off = 0;
            for (int i = 0; i < 64; i += kLanes32) {
                const auto w = hn::Add(hn::Load(kInt32, plane_steps_ + i), v);
                off |= negative(kInt32, hn::Or(w, hn::Sub(r, w))) << i;
            }
            return ~off;
        }
        // What was cut off the value and its up to 9 steps adds less than 10.
        const auto slack = hn::Set(kInt32, 9);
        const auto sure_last = hn::Set(kInt32, high_last - 10);
        std::uint64_t off = 0, maybe_off = 0;
        for (int i = 0; i < 64; i += kLanes32) {
            const auto w = hn::Add(hn::Load(kInt32, plane_steps_ + i), v);
            off |= negative(kInt32, hn::Or(hn::Add(w, slack), hn::Sub(r, w))) << i;
            maybe_off |= negative(kInt32, hn::Or(w, hn::Sub(sure_last, w))) << i;
        }
        return HWY_LIKELY(off == maybe_off) ? ~off : on_plane_exactly(plane);
    }

    HWY_NOINLINE std::uint64_t on_plane_exactly(const PlaneValue& plane) const {
        const auto r = hn::Set(kInt64, plane.last);
        std::uint64_t off = 0;
        for (int eighth = 0; eighth < 8; ++eighth) {  // (x1, y1, z1) of the Morton code
            const std::int64_t step =
                2 * ((eighth & 1) * normal_[0] + (eighth >> 1 & 1) * normal_[1] +
                     (eighth >> 2) * normal_[2]);
            const auto v = hn::Set(kInt64, plane.value + step);
            for (int i = 0; i < 8; i += kLanes64) {
                const auto w = hn::Add(hn::Load(kInt64, exact_plane_steps_ + i), v);
                off |= negative(kInt64, hn::Or(w, hn::Sub(r, w))) << (8 * eighth + i);
            }
        }
        return ~off;
    }

    HWY_INLINE void edge_values(const ivec3& corner, int shift, const std::int64_t* offset,
                                EdgeValues& out) const {
        for (int p = 0; p < 3; ++p) {
            const std::int64_t u = corner[p], v = corner[p == 2 ? 0 : p + 1];
            for (int e = 3 * p; e < 3 * p + 3; ++e) {
                const std::int64_t wide = (edge_u_[e] * u + edge_v_[e] * v + offset[e]) >> shift;
                // Over 16 cells a value changes by less than this: beyond it the sign is decided.
                // As an edge is shorter than 2^25 units, twice the bound fits.
                const std::int64_t far = 16 * std::int64_t{edge_reach_[e]} + 1;
                out.value[e] = static_cast<std::int32_t>(std::max(std::min(wide, far), -far));
            }
        }
        for (int e = kEdges; e < kEdgeLanes; ++e) out.value[e] = 0;
    }

    /// The squares u + 4v of a projection for which all three edge tests, less `reach`, hold.
    HWY_INLINE std::uint32_t squares(int p, const EdgeValues& values,
                                     const std::int32_t* reach) const {
        const int e = 3 * p;
        const auto v0 = hn::Set(kInt32, values.value[e] - reach[0]);
        const auto v1 = hn::Set(kInt32, values.value[e + 1] - reach[1]);
        const auto v2 = hn::Set(kInt32, values.value[e + 2] - reach[2]);
        std::uint64_t outside = 0;
        for (int i = 0; i < 16; i += kLanes32) {
            const auto w0 = hn::Add(hn::Load(kInt32, edge_steps_[e] + i), v0);
            const auto w1 = hn::Add(hn::Load(kInt32, edge_steps_[e + 1] + i), v1);
            const auto w2 = hn::Add(hn::Load(kInt32, edge_steps_[e + 2] + i), v2);
            outside |= negative(kInt32, hn::Or(w0, hn::Or(w1, w2))) << i;
        }
        return static_cast<std::uint32_t>(~outside) & 0xffffu;
    }

    HWY_INLINE std::uint64_t in_projections(const EdgeValues& values) const {
        static constexpr std::int32_t kNoReach[3] = {};
        return cells_over_squares(0, squares(0, values, kNoReach)) &
               cells_over_squares(1, squares(1, values, kNoReach)) &
               cells_over_squares(2, squares(2, values, kNoReach));
    }

    HWY_INLINE std::uint64_t inside_main_projection(const EdgeValues& values) const {
        const int p = main_projection_;
        return cells_over_squares(p, squares(p, values, edge_reach_ + 3 * p));
    }

    // Steps of each edge test over the squares u + 4v of its projection, from the square's best
    // corner.
    HWY_ALIGN std::int32_t edge_steps_[kEdges][16];
    HWY_ALIGN std::int32_t plane_steps_[64];           // in Morton order, without plane_low_bits_
    HWY_ALIGN std::int64_t exact_plane_steps_[8];      // of the first 2x2x2 cells, all bits
    HWY_ALIGN std::int32_t edge_axes_[3][kEdgeLanes];  // the edges' inward normals along x, y and z
    std::int64_t edge_u_[kEdges], edge_v_[kEdges];     // the same along their projection's u and v
    std::int64_t edge_offset_[kEdges];
    std::int64_t voxel_edge_offset_[kEdges];
    std::int32_t edge_reach_[kEdges];  // |u| + |v|: across a cell
    std::int64_t normal_[3];
    PlaneTest cell_plane_, voxel_plane_;
    ivec3 vertex_, bounds_low_, bounds_high_;
    bool short_plane_;  // 64 bits hold the plane's value wherever a window can lie
    int plane_low_bits_;
    int main_projection_;
    bool has_area_;
    int voxel_shift_;
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
    has_area_ = (normal_[0] | normal_[1] | normal_[2]) != 0;
    const bool thin = rule == VoxelRule::thin && has_area_;

    // Orientation of each projection, before the normal is shortened below. Where a projection has
    // no area either sign serves: its edges run both ways along one line and bound it from both
    // sides.
    const int sign[3] = {normal_[2] < 0 ? -1 : 1, normal_[0] < 0 ? -1 : 1, normal_[1] < 0 ? -1 : 1};

    std::int64_t size[3] = {std::abs(normal_[0]), std::abs(normal_[1]), std::abs(normal_[2])};
    std::int64_t largest = std::max({size[0], size[1], size[2]});
    main_projection_ = largest == size[2] ? 0 : largest == size[0] ? 1 : 2;
    if (size[0] + size[1] + size[2] == largest && largest > 1) {
        // Parallel to a face of the grid: any length will do.
        for (int axis = 0; axis < 3; ++axis) {
            normal_[axis] = normal_[axis] > 0 ? 1 : normal_[axis] < 0 ? -1 : 0;
            size[axis] = std::abs(normal_[axis]);
        }
        largest = 1;
    }
    std::int64_t positive = 0;
    for (const std::int64_t n : normal_) positive += std::max<std::int64_t>(n, 0);
    cell_plane_ = {2 * positive, size[0] + size[1] + size[2]};
    voxel_plane_ =
        thin ? PlaneTest{normal_[0] + normal_[1] + normal_[2] + largest, largest} : cell_plane_;

    // A window's corner is at most 2^27 units from a vertex, or a window wide.
    short_plane_ = largest < std::int64_t{1} << 32;
    // 26 bits, so that 9 steps and a value of 30 bits fit 32.
    plane_low_bits_ = 0;
    while (largest >> plane_low_bits_ > 1 << 26) ++plane_low_bits_;
    std::int32_t high[3];
    for (int axis = 0; axis < 3; ++axis)
        high[axis] = static_cast<std::int32_t>(normal_[axis] >> plane_low_bits_);
    for (int i = 0; i < 64; i += kLanes32)
        hn::Store(linear(i, high[0], kCellCoordinates[0], high[1], kCellCoordinates[1],
                         hn::Mul(hn::Set(kInt32, high[2]), load(kCellCoordinates[2] + i))),
                  kInt32, plane_steps_ + i);
    for (int i = 0; i < 8; ++i)
        exact_plane_steps_[i] =
            (i & 1) * normal_[0] + (i >> 1 & 1) * normal_[1] + (i >> 2) * normal_[2];

    for (auto& along_axis : edge_axes_)
        for (std::int32_t& step : along_axis) step = 0;
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
            for (int i = 0; i < 16; i += kLanes32)
                hn::Store(linear(i, nu, kSquareCoordinates[0], nv, kSquareCoordinates[1],
                                 hn::Set(kInt32, best_corner)),
                          kInt32, edge_steps_[e] + i);
            edge_axes_[u][e] = nu;
            edge_axes_[v][e] = nv;

            voxel_edge_offset_[e] = edge_offset_[e];
            if (thin) {
                // The edge passes within half a voxel, along u or v, of the voxel's centre. Written
                // as a correction of the best corner that the steps above already contain.
                const std::int64_t twice =
                    std::int64_t{nu} + nv + std::max(std::abs(nu), std::abs(nv)) - 2 * best_corner;
                voxel_edge_offset_[e] += twice << (voxel_shift - 1);
            }
        }
    }
}

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
