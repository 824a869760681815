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
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "octavo/voxelize/cell_masks.h"
#include "octavo/voxelize/fixed_point.h"
#include "octavo/voxelize/rule.h"

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

// A number on each axis; the fourth says nothing. What is written as a vector may be read as a
// vector or number by number, but not the other way: a load waits where it spans several stores.
constexpr hn::FixedTag<std::int32_t, 4> kAxes{};
using Axes = hn::Vec<decltype(kAxes)>;

/// Bit 0, 1 and 2: where lanes x, y and z are set.
HWY_INLINE unsigned axes_of(hn::Mask<decltype(kAxes)> mask) {
    return static_cast<unsigned>(bits_of(kAxes, mask)) & 7u;
}

/// The bounds of three corners, one unit more than they are at the low end: of closed cells those
/// that end there meet them too.
HWY_INLINE Axes low_of(const std::array<FixedPoint, 3>& corners) {
    const Axes least =
        hn::Min(hn::Load(kAxes, &corners[0].x),
                hn::Min(hn::Load(kAxes, &corners[1].x), hn::Load(kAxes, &corners[2].x)));
    return hn::Sub(least, hn::Set(kAxes, 1));
}
HWY_INLINE Axes high_of(const std::array<FixedPoint, 3>& corners) {
    return hn::Max(hn::Load(kAxes, &corners[0].x),
                   hn::Max(hn::Load(kAxes, &corners[1].x), hn::Load(kAxes, &corners[2].x)));
}

/// base + i u + j v for i and j from 0 to 3, i fastest, or with their bits in Morton order.
enum class Order { rows, morton };
template <Order kOrder>
HWY_INLINE void store_plane(std::int32_t base, std::int32_t u, std::int32_t v, std::int32_t* out) {
    constexpr unsigned kU = 0xaaaa, kTwiceV = 0xff00;  // lanes with this bit of i, or of j
    constexpr unsigned kTwiceU = kOrder == Order::rows ? 0xcccc : 0xf0f0;
    constexpr unsigned kV = kOrder == Order::rows ? 0xf0f0 : 0xcccc;
#if HWY_TARGET <= HWY_AVX3  // a multiplication takes as long as four of these
    __m512i sum = _mm512_set1_epi32(base);
    sum = _mm512_mask_add_epi32(sum, kU, sum, _mm512_set1_epi32(u));
    sum = _mm512_mask_add_epi32(sum, kV, sum, _mm512_set1_epi32(v));
    sum = _mm512_mask_add_epi32(sum, kTwiceU, sum, _mm512_set1_epi32(2 * u));
    sum = _mm512_mask_add_epi32(sum, kTwiceV, sum, _mm512_set1_epi32(2 * v));
    _mm512_store_si512(out, sum);
#else
    struct alignas(64) Steps {
        std::int32_t i[16], j[16];
    };
    static constexpr Steps kSteps = [] {
        Steps steps{};
        for (unsigned lane = 0; lane < 16; ++lane) {
            steps.i[lane] = static_cast<std::int32_t>((kU >> lane & 1) + 2 * (kTwiceU >> lane & 1));
            steps.j[lane] = static_cast<std::int32_t>((kV >> lane & 1) + 2 * (kTwiceV >> lane & 1));
        }
        return steps;
    }();
    constexpr hn::CappedTag<std::int32_t, 16> d;
    for (std::size_t lane = 0; lane < 16; lane += hn::MaxLanes(d)) {
        const auto i = hn::Mul(hn::Load(d, kSteps.i + lane), hn::Set(d, u));
        const auto j = hn::Mul(hn::Load(d, kSteps.j + lane), hn::Set(d, v));
        hn::Store(hn::Add(hn::Add(i, j), hn::Set(d, base)), d, out + lane);
    }
#endif
}

/// All bits of the lanes of 2x2x2 cells, in Morton order, that are the second along an axis.
struct alignas(64) CubeSteps {
    std::int64_t lanes[3][8];
};
constexpr CubeSteps kCubeSteps = [] {
    CubeSteps steps{};
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < 8; ++i) steps.lanes[axis][i] = (i >> axis & 1) != 0 ? -1 : 0;
    return steps;
}();

/// All bits of the lanes that have this bit in their number.
struct alignas(64) CellBits {
    std::int32_t lanes[4][16];
};
constexpr CellBits kCellBits = [] {
    CellBits bits{};
    for (int bit = 0; bit < 4; ++bit)
        for (int i = 0; i < 16; ++i) bits.lanes[bit][i] = (i >> bit & 1) != 0 ? -1 : 0;
    return bits;
}();

/// Tests one triangle against 4x4x4 cells at a time.
///
/// A cell is a closed cube of 2^shift units. Every test is a linear function of the cell's corner
/// that must not be negative. On the cells of one 4x4x4 window it is  value + 2^shift * step(cell)
/// with small integer steps, and  value + 2^shift * step >= 0  exactly when  (value >> shift) +
/// step >= 0: so the wide part is done once for a window and the lanes need few bits, without
/// rounding anywhere.
class TriangleCells {
    // 3 projections x 4 lanes, of which 3 are edges, and a whole number of vectors.
    static constexpr int kEdgeLanes = 16;

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

    // 64 bits for each edge, even lanes and odd ones apart, as products come.
    struct WideEdges {
        HWY_ALIGN std::int64_t even[kEdgeLanes / 2];
        HWY_ALIGN std::int64_t odd[kEdgeLanes / 2];
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
    static constexpr hn::CappedTag<std::int32_t, 16> kInt32{};
    static constexpr hn::CappedTag<std::int64_t, 8> kInt64{};
    static constexpr hn::CappedTag<std::uint16_t, 32> kUint16{};
    static constexpr int kLanes32 = static_cast<int>(hn::MaxLanes(kInt32));
    static constexpr int kLanes64 = static_cast<int>(hn::MaxLanes(kInt64));
    static constexpr int kLanes16 = static_cast<int>(hn::MaxLanes(kUint16));
    static constexpr hn::CappedTag<std::int64_t, 4> kRow{};
    static constexpr int kRowLanes = static_cast<int>(hn::MaxLanes(kRow));

    // The plane passes a cell when 0 <= low + n . (corner - vertex) <= range.
    struct PlaneTest {
        std::int64_t low;    // in 2^(shift - 1), so that half a voxel is whole
        std::int64_t range;  // in 2^shift
    };

    void set_plane();
    void set_edges(const std::array<FixedPoint, 3>& corners, const int sign[3]);
    void set_thin_offsets();

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

    // Steps of each edge test over the squares of its projection, from the square's best corner.
    HWY_ALIGN std::int32_t edge_steps_[12][16];
    HWY_ALIGN std::uint16_t plane_steps_[64];          // in Morton order, without plane_low_bits_
    HWY_ALIGN std::int64_t exact_plane_steps_[8];      // of the first 2x2x2 cells, all bits
    HWY_ALIGN std::int32_t edge_axes_[3][kEdgeLanes];  // the edges' inward normals along x, y and z
    HWY_ALIGN std::int32_t edge_reach_[12];            // across a cell
    HWY_ALIGN std::int32_t edge_best_[12];             // to a cell's best corner
    WideEdges edge_offset_, thin_edge_offset_;
    std::int64_t normal_[3];
    PlaneTest cell_plane_, voxel_plane_;
    HWY_ALIGN std::int32_t vertex_[4];
    HWY_ALIGN std::int32_t bounds_low_[4];
    HWY_ALIGN std::int32_t bounds_high_[4];
    bool short_plane_;  // 64 bits hold the plane's value wherever a window can lie
    bool has_area_, thin_;
    bool may_hold_block_;  // a block's shadow along the main axis may lie inside the triangle's
    std::uint16_t plane_slack_low_;  // as much may have been cut off values and steps
    int plane_slack_high_;
    std::int64_t plane_least_, plane_most_;  // beyond these no step leads onto the plane
    int plane_low_bits_;
    int main_projection_;
    int voxel_shift_;
};

inline TriangleCells::TriangleCells(const std::array<FixedPoint, 3>& corners, int voxel_shift,
                                    VoxelRule rule)
    : voxel_shift_(voxel_shift) {
    const ivec3 c[3] = {{corners[0].x, corners[0].y, corners[0].z},
                        {corners[1].x, corners[1].y, corners[1].z},
                        {corners[2].x, corners[2].y, corners[2].z}};
    hn::Store(hn::Load(kAxes, &corners[0].x), kAxes, vertex_);
    hn::Store(low_of(corners), kAxes, bounds_low_);
    hn::Store(high_of(corners), kAxes, bounds_high_);

    const ivec3 e1 = c[1] - c[0], e2 = c[2] - c[0];
    normal_[0] = std::int64_t{e1.y} * e2.z - std::int64_t{e1.z} * e2.y;
    normal_[1] = std::int64_t{e1.z} * e2.x - std::int64_t{e1.x} * e2.z;
    normal_[2] = std::int64_t{e1.x} * e2.y - std::int64_t{e1.y} * e2.x;
    has_area_ = (normal_[0] | normal_[1] | normal_[2]) != 0;
    thin_ = rule == VoxelRule::thin && has_area_;

    // Orientation of each projection, before the normal is shortened below. Where a projection has
    // no area either sign serves: its edges run both ways along one line and bound it from both
    // sides.
    const int sign[3] = {normal_[2] < 0 ? -1 : 0, normal_[0] < 0 ? -1 : 0, normal_[1] < 0 ? -1 : 0};
    set_edges(corners, sign);
    set_plane();
    if (thin_) set_thin_offsets();
}

HWY_INLINE void TriangleCells::set_plane() {
    std::int64_t size[3] = {std::abs(normal_[0]), std::abs(normal_[1]), std::abs(normal_[2])};
    std::int64_t largest = std::max({size[0], size[1], size[2]});
    main_projection_ = largest == size[2] ? 0 : largest == size[0] ? 1 : 2;
    // A square that is inside is not wider than twice the area over the longest side. Without area
    // there are no edges that could bound it.
    const int u = main_projection_, v = (main_projection_ + 1) % 3;
    const std::int64_t longest =
        std::max(bounds_high_[u] - bounds_low_[u], bounds_high_[v] - bounds_low_[v]) - 1;
    may_hold_block_ = has_area_ && largest >= longest << (voxel_shift_ + 2);
    if (size[0] + size[1] + size[2] == largest && largest > 1) {
        // Parallel to a face of the grid: any length will do.
        for (int axis = 0; axis < 3; ++axis) {
            normal_[axis] = normal_[axis] > 0 ? 1 : normal_[axis] < 0 ? -1 : 0;
            size[axis] = std::abs(normal_[axis]);
        }
        largest = 1;
    }
    const std::int64_t sum = size[0] + size[1] + size[2];
    // sum is |n|: of it this much belongs to steps up.
    const std::int64_t positive = (sum + normal_[0] + normal_[1] + normal_[2]) / 2;
    cell_plane_ = {2 * positive, sum};
    voxel_plane_ = {2 * positive - (thin_ ? sum - largest : 0), thin_ ? largest : sum};

    // A window's corner is at most 2^27 units from a vertex, or a window wide.
    short_plane_ = largest < std::int64_t{1} << 32;
    for (int i = 0; i < 8; i += kLanes64) {
        const auto step = [&](int axis) {
            return hn::And(hn::Load(kInt64, kCubeSteps.lanes[axis] + i),
                           hn::Set(kInt64, normal_[axis]));
        };
        hn::Store(hn::Add(hn::Add(step(0), step(1)), step(2)), kInt64, exact_plane_steps_ + i);
    }

    // 13 bits for |n|, so that 3 |n| of steps, and as much for values beyond which the answer is
    // no, fit 16.
    constexpr int kBits = 13;
    plane_low_bits_ =
        std::max(0, static_cast<int>(std::bit_width(static_cast<std::uint64_t>(sum))) - kBits);
    // Steps are added up with some bits more, or all that there are.
    const int guard_bits = std::min(plane_low_bits_, 12);
    const int cut = plane_low_bits_ - guard_bits;
    // Below 0 cut off: nothing, or less than 1 from a value and less than 1 + 9/4096 from a step.
    plane_slack_low_ = plane_low_bits_ == 0 ? 0 : 2;
    plane_slack_high_ = plane_low_bits_ == 0 ? 0 : 3;
    const std::int64_t up = (positive >> plane_low_bits_) + 1;
    const std::int64_t down = ((sum - positive) >> plane_low_bits_) + 1;
    plane_least_ = -3 * up - 4;
    plane_most_ = (sum >> plane_low_bits_) + 3 * down + 5;

    // In Morton order the steps of cell 8a + b are those of b, and twice those of a.
    HWY_ALIGN std::int32_t first[16];
    for (int i = 0; i < 16; i += kLanes32) {
        const auto step = [&](int bit, std::int64_t along) {
            return hn::And(hn::Load(kInt32, kCellBits.lanes[bit] + i),
                           hn::Set(kInt32, static_cast<std::int32_t>(along >> cut)));
        };
        const auto near =
            hn::Add(hn::Add(step(0, normal_[0]), step(1, normal_[1])), step(2, normal_[2]));
        hn::Store(hn::Add(near, hn::Add(step(3, normal_[0]), step(3, normal_[0]))), kInt32,
                  first + i);
    }
    constexpr hn::Rebind<std::int16_t, decltype(kInt32)> kNarrow;
    for (int a = 0; a < 8; a += 2) {
        const auto twice = hn::Set(kInt32, 2 * first[a]);
        for (int b = 0; b < 16; b += kLanes32) {
            const auto steps =
                hn::ShiftRightSame(hn::Add(hn::Load(kInt32, first + b), twice), guard_bits);
            hn::Store(hn::DemoteTo(kNarrow, steps), kNarrow,
                      reinterpret_cast<std::int16_t*>(plane_steps_ + 8 * a + b));
        }
    }
}

/// @param sign  of each projection's area: 0, or -1 where it is negative
HWY_INLINE void TriangleCells::set_edges(const std::array<FixedPoint, 3>& corners,
                                         const int sign[3]) {
    constexpr hn::FixedTag<std::int32_t, 4> d;
    constexpr hn::FixedTag<std::int64_t, 2> d64;
    const auto load = [&](int i) { return hn::Load(d, &corners[static_cast<unsigned>(i)].x); };
    // Lane k: where edge k begins. Lane 3 is an edge from a corner to itself.
    const auto ab_low = hn::InterleaveLower(d, load(0), load(1));
    const auto ab_high = hn::InterleaveUpper(d, load(0), load(1));
    const auto ca_low = hn::InterleaveLower(d, load(2), load(0));
    const auto ca_high = hn::InterleaveUpper(d, load(2), load(0));
    using V = decltype(ab_low);
    const V from[3] = {hn::ConcatLowerLower(d, ca_low, ab_low),
                       hn::ConcatUpperUpper(d, ca_low, ab_low),
                       hn::ConcatLowerLower(d, ca_high, ab_high)};
    const auto zero = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) hn::Store(zero, d, edge_axes_[axis] + 12);
    hn::Store(hn::Zero(d64), d64, edge_offset_.even + 6);
    hn::Store(hn::Zero(d64), d64, edge_offset_.odd + 6);
    const auto odd = [&](V v) { return hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(d64, v))); };

    for (int p = 0; p < 3; ++p) {
        const int u = p, v = (p + 1) % 3, w = (p + 2) % 3;
        const auto s = hn::Set(d, sign[p]);
        const auto oriented = [&](V a) { return hn::Sub(hn::Xor(a, s), s); };
        const V along_u = oriented(hn::Sub(from[v], hn::Shuffle0321(from[v])));
        const V along_v = oriented(hn::Sub(hn::Shuffle0321(from[u]), from[u]));
        hn::Store(along_u, d, edge_axes_[u] + 4 * p);
        hn::Store(along_v, d, edge_axes_[v] + 4 * p);
        hn::Store(zero, d, edge_axes_[w] + 4 * p);
        hn::Store(hn::Add(hn::Abs(along_u), hn::Abs(along_v)), d, edge_reach_ + 4 * p);
        hn::Store(hn::Add(hn::Max(along_u, zero), hn::Max(along_v, zero)), d, edge_best_ + 4 * p);
        const auto offset = [&](V a, V b, V at_u, V at_v) {
            return hn::Sub(hn::Zero(d64), hn::Add(hn::MulEven(a, at_u), hn::MulEven(b, at_v)));
        };
        hn::Store(offset(along_u, along_v, from[u], from[v]), d64, edge_offset_.even + 2 * p);
        hn::Store(offset(odd(along_u), odd(along_v), odd(from[u]), odd(from[v])), d64,
                  edge_offset_.odd + 2 * p);
    }
    for (int p = 0; p < 3; ++p)
        for (int e = 4 * p; e < 4 * p + 3; ++e) {
            // The squares' numbers have the bits of the axis that comes first lowest.
            const int first = p == 2 ? 0 : p, second = p == 2 ? 2 : p + 1;
            store_plane<Order::morton>(edge_best_[e], edge_axes_[first][e], edge_axes_[second][e],
                                       edge_steps_[e]);
        }
}

inline void TriangleCells::set_thin_offsets() {
    thin_edge_offset_ = edge_offset_;
    for (int p = 0; p < 3; ++p)
        for (int e = 4 * p; e < 4 * p + 3; ++e) {
            // The edge passes within half a voxel, along u or v, of the voxel's centre. Written as
            // a correction of the best corner that the steps already contain.
            const std::int64_t nu = edge_axes_[p][e], nv = edge_axes_[(p + 1) % 3][e];
            const std::int64_t twice =
                nu + nv + std::max(std::abs(nu), std::abs(nv)) - 2 * std::int64_t{edge_best_[e]};
            std::int64_t* offsets = e % 2 == 0 ? thin_edge_offset_.even : thin_edge_offset_.odd;
            offsets[e / 2] += twice << (voxel_shift_ - 1);
        }
}

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
