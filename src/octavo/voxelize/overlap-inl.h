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
#include <bit>
#include <cstdint>

#include "octavo/voxelize/cell_masks.h"
#include "octavo/voxelize/triangle_setup-inl.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

__extension__ typedef __int128 Int128;

/// Lane i of a mask is bit i.
template <class D>
HWY_INLINE std::uint64_t bits_of(D d, hn::Mask<D> mask) {
#if HWY_TARGET <= HWY_AVX3  // a mask is a number there
    (void)d;
    return static_cast<std::uint64_t>(mask.raw);
#else
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, mask, reinterpret_cast<std::uint8_t*>(&bits));
    return bits;
#endif
}

/// Bit i is set where lane i is negative.
template <class D>
HWY_INLINE std::uint64_t negative(D d, hn::Vec<D> v) {
#if HWY_TARGET <= HWY_AVX3  // takes the sign bits
    return bits_of(d, hn::MaskFromVec(v));
#else
    return bits_of(d, hn::Lt(v, hn::Zero(d)));
#endif
}

/// cells_over_squares(), where a multiplication is faster than a table that crowds the cache.
template <int kProjection>
HWY_INLINE std::uint64_t columns_over(std::uint32_t squares) {
#if HWY_ARCH_X86_64 && HWY_TARGET <= HWY_AVX2  // has BMI2
    // The squares as cells of the first layer along the third axis, and that four times: a step
    // along axis w adds 2^w or 2^(w + 3) to a cell's number.
    constexpr int w = (kProjection + 2) % 3;
    constexpr std::uint64_t kFirstLayer = cells_of_layer(w, 0);
    constexpr std::uint64_t kLayers =
        ((std::uint64_t{1} << (1 << w)) + 1) * ((std::uint64_t{1} << (8 << w)) + 1);
    return _pdep_u64(squares, kFirstLayer) * kLayers;
#else
    return cells_over_squares(kProjection, squares);
#endif
}

/// Bit 0, 1 and 2: where lanes x, y and z are set.
HWY_INLINE unsigned axes_of(hn::Mask<decltype(kAxes)> mask) {
    return static_cast<unsigned>(bits_of(kAxes, mask)) & 7u;
}

/// Tests one triangle against 4x4x4 cells at a time.
///
/// A cell is a closed cube of 2^shift units. Every test is a linear function of the cell's corner
/// that must not be negative. On the cells of one 4x4x4 window it is  value + 2^shift * step(cell)
/// with small integer steps, and  value + 2^shift * step >= 0  exactly when  (value >> shift) +
/// step >= 0: so the wide part is done once for a window and the lanes need few bits, without
/// rounding anywhere.
class TriangleCells : TriangleSetup {
    // A window of cells against the plane: a cell passes when 0 <= value + step(cell) <= last.
    struct PlaneValue {
        std::int64_t value, last;
    };

    // Of a number with a plane's high bits: below `surely` it is on, from `maybe` on it is off.
    struct PlaneLimits {
        std::uint16_t surely, maybe;
    };

    // A window of cells against the edges: a cell passes when lane + step(cell) >= 0 for each edge.
    struct EdgeValues {
        HWY_ALIGN std::int32_t lane[kEdgeLanes];
    };

public:
    using TriangleSetup::TriangleSetup;

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
        edge_values(corner, voxel_shift_, voxel_edge_offset(), edges);
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
        blocks.inside = may_hold_block_ ? blocks.met & inside_main_projection(edges) : 0;
        return blocks;
    }

    /// The plane in the blocks of a window: from one to the next its value changes by four voxels'
    /// steps, so it is taken for all 64 at once, high bits only.
    class PlaneOfBlocks {
    public:
        HWY_INLINE PlaneOfBlocks(const TriangleCells& triangle, const ivec3& corner)
            : triangle_(triangle),
              plane_(triangle.plane_value(corner, triangle.voxel_shift_, triangle.voxel_plane_)),
              limits_(triangle.plane_limits(plane_.last)) {
            const auto least = hn::Set(kInt64, triangle.plane_least_);
            const auto most = hn::Set(kInt64, triangle.plane_most_);
            for (int i = 0; i < 8; i += kLanes64) {
                const auto steps =
                    hn::ShiftLeft<2>(hn::Load(kInt64, triangle.exact_plane_steps_ + i));
                for (int eighth = 0; eighth < 8; ++eighth) {
                    const auto first =
                        hn::Set(kInt64, plane_.value + 8 * triangle.exact_plane_steps_[eighth]);
                    const auto cut =
                        hn::ShiftRightSame(hn::Add(steps, first), triangle.plane_low_bits_);
                    hn::Store(hn::Min(hn::Max(cut, least), most), kInt64, high_ + 8 * eighth + i);
                }
            }
        }

        /// The voxels of the block with this Morton code in the window.
        HWY_INLINE std::uint64_t voxels(unsigned code) const {
            const HighBits high =
                triangle_.on_plane_by_high_bits(static_cast<std::uint16_t>(high_[code]), limits_);
            if (HWY_LIKELY(high.decide)) return high.on;
            const std::int64_t* steps = triangle_.exact_plane_steps_;
            return triangle_.on_plane_exactly(
                {plane_.value + 4 * (steps[code & 7u] + 2 * steps[code >> 3]), plane_.last});
        }

    private:
        const TriangleCells& triangle_;
        PlaneValue plane_;
        PlaneLimits limits_;
        HWY_ALIGN std::int64_t high_[64];
    };

    /// What the tests of a window's blocks have in common: the wide products are taken once.
    class BlockVoxels {
    public:
        HWY_INLINE BlockVoxels(const TriangleCells& triangle, const ivec3& corner)
            : triangle_(triangle), corner_(corner), plane_(triangle, corner) {
            triangle.edge_values(corner, triangle.voxel_shift_, triangle.voxel_edge_offset(),
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
                const auto here = hn::Load(kInt32, edges_.lane + e);
                hn::Store(hn::Add(hn::Add(here, along_x), hn::Add(along_y, along_z)), kInt32,
                          edges.lane + e);
            }
            return t.in_bounds(corner_ + (block << (t.voxel_shift_ + 2)), t.voxel_shift_) &
                   voxels_of_plane(code) & t.in_projections(edges);
        }

        /// The same for a block that is inside.
        HWY_INLINE std::uint64_t voxels_of_plane(unsigned code) const {
            return plane_.voxels(code);
        }

    private:
        const TriangleCells& triangle_;
        ivec3 corner_;
        PlaneOfBlocks plane_;
        EdgeValues edges_;
    };

    /// Calls set(code, voxels) for every block of a small range that may have voxels, by its Morton
    /// code in the range; `voxels` may be none. Each projection is looked at once for a whole
    /// column of blocks. What a small triangle meets is hard to foretell, so there are few
    /// branches.
    /// @param corner  of the first block, which the triangle's bounds meet
    /// @param count   of blocks along each axis, 1 to 4
    template <class Set>
    HWY_INLINE void for_each_block(const ivec3& corner, const ivec3& count, const Set& set) const {
        EdgeValues edges;
        edge_values(corner, voxel_shift_, voxel_edge_offset(), edges);
        std::uint64_t columns[3][16];
        columns_of<0>(edges, corner, count, columns[0]);
        columns_of<1>(edges, corner, count, columns[1]);
        columns_of<2>(edges, corner, count, columns[2]);

        std::uint64_t met[64];
        std::uint8_t codes[64];
        unsigned found = 0;
        for (std::uint64_t rest = cells_from_to(0, 0, count.x - 1) &
                                  cells_from_to(1, 0, count.y - 1) &
                                  cells_from_to(2, 0, count.z - 1);
             rest != 0; rest &= rest - 1) {
            const auto code = static_cast<unsigned>(std::countr_zero(rest));
            const ColumnsOfCell& of = kColumnsOfCell[code];
            met[found] =
                columns[0][of.column[0]] & columns[1][of.column[1]] & columns[2][of.column[2]];
            codes[found] = static_cast<std::uint8_t>(code);
            found += met[found] != 0;
        }

        const PlaneOfBlocks plane(*this, corner);
        for (unsigned i = 0; i < found; ++i) set(codes[i], met[i] & plane.voxels(codes[i]));
    }

private:
    [[nodiscard]] HWY_INLINE const WideEdges& voxel_edge_offset() const {
        return thin_ ? thin_edge_offset_ : edge_offset_;
    }

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
            Int{normal_[0]} * (corner.x - vertex_[0]) + Int{normal_[1]} * (corner.y - vertex_[1]) +
            Int{normal_[2]} * (corner.z - vertex_[2]) + ((Int{test.low} << shift) >> 1);
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
    /// 13 highest decide nearly always, and where they do not all bits are asked.
    HWY_INLINE std::uint64_t on_plane(const PlaneValue& plane) const {
        return on_plane(plane, plane_limits(plane.last));
    }
    HWY_INLINE std::uint64_t on_plane(const PlaneValue& plane, const PlaneLimits& limits) const {
        std::int64_t value = std::max(plane.value >> plane_low_bits_, plane_least_);
        value = std::min(value, plane_most_);
        const HighBits high = on_plane_by_high_bits(static_cast<std::uint16_t>(value), limits);
        return HWY_LIKELY(high.decide) ? high.on : on_plane_exactly(plane);
    }

    HWY_INLINE PlaneLimits plane_limits(std::int64_t last) const {
        const std::int64_t high = last >> plane_low_bits_;
        return {static_cast<std::uint16_t>(high - plane_slack_high_ + 1),
                static_cast<std::uint16_t>(high + plane_slack_low_ + 1)};
    }

    struct HighBits {
        std::uint64_t on;
        bool decide;
    };
    /// @param value  without plane_low_bits_, between plane_least_ and plane_most_
    HWY_INLINE HighBits on_plane_by_high_bits(std::uint16_t value,
                                              const PlaneLimits& limits) const {
        const auto v = hn::Set(kUint16, value);
        const auto slack = hn::Set(kUint16, plane_slack_low_);
        const auto surely = hn::Set(kUint16, limits.surely);
        const auto maybe = hn::Set(kUint16, limits.maybe);
        // A number below 0 is a large one here, so that one comparison asks for both ends.
        const auto first = hn::Add(hn::Load(kUint16, plane_steps_), v);
#if HWY_TARGET <= HWY_AVX3  // both halves to one register as one number
        const auto second = hn::Add(hn::Load(kUint16, plane_steps_ + 32), v);
        const std::uint64_t on =
            _mm512_kunpackd(hn::Lt(second, surely).raw, hn::Lt(first, surely).raw);
        const std::uint64_t maybe_on = _mm512_kunpackd(hn::Lt(hn::Add(second, slack), maybe).raw,
                                                       hn::Lt(hn::Add(first, slack), maybe).raw);
#else
        std::uint64_t on = bits_of(kUint16, hn::Lt(first, surely));
        std::uint64_t maybe_on = bits_of(kUint16, hn::Lt(hn::Add(first, slack), maybe));
        for (int i = kLanes16; i < 64; i += kLanes16) {
            const auto w = hn::Add(hn::Load(kUint16, plane_steps_ + i), v);
            on |= bits_of(kUint16, hn::Lt(w, surely)) << i;
            maybe_on |= bits_of(kUint16, hn::Lt(hn::Add(w, slack), maybe)) << i;
        }
#endif
        return {on, on == maybe_on};
    }

    HWY_NOINLINE std::uint64_t on_plane_exactly(const PlaneValue& plane) const {
        const auto r = hn::Set(kInt64, plane.last);
        std::uint64_t off = 0;
        for (int eighth = 0; eighth < 8; ++eighth) {  // (x1, y1, z1) of the Morton code
            const auto v = hn::Set(kInt64, plane.value + 2 * exact_plane_steps_[eighth]);
            for (int i = 0; i < 8; i += kLanes64) {
                const auto w = hn::Add(hn::Load(kInt64, exact_plane_steps_ + i), v);
                off |= negative(kInt64, hn::Or(w, hn::Sub(r, w))) << (8 * eighth + i);
            }
        }
        return ~off;
    }

    HWY_INLINE void edge_values(const ivec3& corner, int shift, const WideEdges& offset,
                                EdgeValues& out) const {
        // Over 16 cells a value changes by less than 2^30, as an edge is shorter than 2^25 units:
        // beyond that the sign is decided.
        const auto far = hn::Set(kInt64, std::int64_t{1} << 30);
        const auto near = hn::Set(kInt64, -(std::int64_t{1} << 30));
        const auto low_half = hn::Set(kInt64, std::int64_t{0xffffffff});
        const auto x = hn::Set(kInt32, corner.x);
        const auto y = hn::Set(kInt32, corner.y);
        const auto z = hn::Set(kInt32, corner.z);
        const auto odd = [](auto v) {
            return hn::BitCast(kInt32, hn::ShiftRight<32>(hn::BitCast(kInt64, v)));
        };
        for (int e = 0; e < kEdgeLanes; e += kLanes32) {
            const auto along_x = hn::Load(kInt32, edge_axes_[0] + e);
            const auto along_y = hn::Load(kInt32, edge_axes_[1] + e);
            const auto along_z = hn::Load(kInt32, edge_axes_[2] + e);
            const auto value = [&](auto ax, auto ay, auto az, const std::int64_t* constant) {
                const auto wide =
                    hn::Add(hn::Add(hn::MulEven(ax, x), hn::MulEven(ay, y)),
                            hn::Add(hn::MulEven(az, z), hn::Load(kInt64, constant + e / 2)));
                return hn::Max(hn::Min(hn::ShiftRightSame(wide, shift), far), near);
            };
            const auto even_values = value(along_x, along_y, along_z, offset.even);
            const auto odd_values = value(odd(along_x), odd(along_y), odd(along_z), offset.odd);
            const auto both = hn::Or(hn::And(even_values, low_half), hn::ShiftLeft<32>(odd_values));
            hn::Store(hn::BitCast(kInt32, both), kInt32, out.lane + e);
        }
    }

    /// The squares of a projection for which all three edge tests hold.
    template <int kProjection>
    HWY_INLINE std::uint32_t squares(std::int32_t value0, std::int32_t value1,
                                     std::int32_t value2) const {
        constexpr int e = 4 * kProjection;
        const auto v0 = hn::Set(kInt32, value0);
        const auto v1 = hn::Set(kInt32, value1);
        const auto v2 = hn::Set(kInt32, value2);
        std::uint64_t outside = 0;
        for (int i = 0; i < 16; i += kLanes32) {
            const auto w0 = hn::Add(hn::Load(kInt32, edge_steps_[e] + i), v0);
            const auto w1 = hn::Add(hn::Load(kInt32, edge_steps_[e + 1] + i), v1);
            const auto w2 = hn::Add(hn::Load(kInt32, edge_steps_[e + 2] + i), v2);
            outside |= negative(kInt32, hn::Or3(w0, w1, w2)) << i;
        }
        return static_cast<std::uint32_t>(~outside) & 0xffffu;
    }

    template <int kProjection>
    HWY_INLINE std::uint64_t in_projection(const EdgeValues& edges) const {
        const std::int32_t* lane = edges.lane + 4 * kProjection;
        return columns_over<kProjection>(squares<kProjection>(lane[0], lane[1], lane[2]));
    }

    HWY_INLINE std::uint64_t in_projections(const EdgeValues& edges) const {
        return in_projection<0>(edges) & in_projection<1>(edges) & in_projection<2>(edges);
    }

    template <int kProjection>
    HWY_INLINE std::uint64_t inside_projection(const EdgeValues& edges) const {
        const std::int32_t* lane = edges.lane + 4 * kProjection;
        const std::int32_t* reach = edge_reach_ + 4 * kProjection;
        return columns_over<kProjection>(
            squares<kProjection>(lane[0] - reach[0], lane[1] - reach[1], lane[2] - reach[2]));
    }

    HWY_INLINE std::uint64_t inside_main_projection(const EdgeValues& edges) const {
        return main_projection_ == 0   ? inside_projection<0>(edges)
               : main_projection_ == 1 ? inside_projection<1>(edges)
                                       : inside_projection<2>(edges);
    }

    /// For the columns of blocks (i, j) along a projection: their voxels that the projection
    /// passes and that are within the bounds along u, at [i + 4j].
    template <int kProjection>
    HWY_INLINE void columns_of(const EdgeValues& edges, const ivec3& corner, const ivec3& count,
                               std::uint64_t* columns) const {
        constexpr int u = kProjection, v = (kProjection + 1) % 3, e = 4 * kProjection;
        const int first = std::max((bounds_low_[u] - corner[u]) >> voxel_shift_, 0);
        const int last = ((bounds_high_[u] - corner[u]) >> voxel_shift_) - 4 * (count[u] - 1);
        std::uint64_t slabs[4] = {~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0},
                                  ~std::uint64_t{0}};
        slabs[0] = cells_from_to(u, first, 3);
        slabs[count[u] - 1] &= cells_from_to(u, 0, std::min(last, 3));

        HWY_ALIGN std::int32_t values[3][16];
        for (int k = 0; k < 3; ++k)
            store_plane<Order::rows>(edges.lane[e + k], 4 * edge_axes_[u][e + k],
                                     4 * edge_axes_[v][e + k], values[k]);
        // Rows of count[u] columns.
        const unsigned row = (1u << count[u]) - 1;
        const auto all = static_cast<unsigned>(0x1111u & ((1u << 4 * count[v]) - 1)) * row;
        for (unsigned rest = all; rest != 0; rest &= rest - 1) {
            const auto at = static_cast<unsigned>(std::countr_zero(rest));
            columns[at] = slabs[at & 3u] & columns_over<kProjection>(squares<kProjection>(
                                               values[0][at], values[1][at], values[2][at]));
        }
    }
};

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
