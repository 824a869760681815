// SPDX-License-Identifier: MIT
// What is found once for each triangle, before it is tested against any cell: overlap-inl.h has the
// tests and their source.
//
// Included once for every SIMD target (Highway's foreach_target), so the guard toggles.
#if defined(OCTAVO_VOXELIZE_TRIANGLE_SETUP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTAVO_VOXELIZE_TRIANGLE_SETUP_INL_H
#undef OCTAVO_VOXELIZE_TRIANGLE_SETUP_INL_H
#else
#define OCTAVO_VOXELIZE_TRIANGLE_SETUP_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "octavo/voxelize/fixed_point.h"
#include "octavo/voxelize/rule.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A number on each axis; the fourth says nothing. What is written as a vector may be read as a
// vector or number by number, but not the other way: a load waits where it spans several stores.
constexpr hn::FixedTag<std::int32_t, 4> kAxes{};
using Axes = hn::Vec<decltype(kAxes)>;

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

/// A triangle's plane, bounds, and edges in its three projections. Plane and edges are linear
/// functions of a cell's corner, exact, and not negative where the triangle may meet the cell: kept
/// are what gives their value anywhere, and their steps from cell to cell in a window of 4x4x4.
class TriangleSetup {
public:
    /// @param voxel_shift  log2 of a voxel in units: cells of this size follow `rule`, larger
    ///                     ones hold every voxel of theirs that either rule could mark
    TriangleSetup(const std::array<FixedPoint, 3>& corners, int voxel_shift, VoxelRule rule);

protected:
    // 3 projections x 4 lanes, of which 3 are edges, and a whole number of vectors.
    static constexpr int kEdgeLanes = 16;

    // 64 bits for each edge, even lanes and odd ones apart, as products come.
    struct WideEdges {
        HWY_ALIGN std::int64_t even[kEdgeLanes / 2];
        HWY_ALIGN std::int64_t odd[kEdgeLanes / 2];
    };

    static constexpr hn::CappedTag<std::int32_t, 16> kInt32{};
    static constexpr hn::CappedTag<std::int64_t, 8> kInt64{};
    static constexpr hn::CappedTag<std::uint16_t, 32> kUint16{};
    static constexpr int kLanes32 = static_cast<int>(hn::MaxLanes(kInt32));
    static constexpr int kLanes64 = static_cast<int>(hn::MaxLanes(kInt64));
    static constexpr int kLanes16 = static_cast<int>(hn::MaxLanes(kUint16));

    // The plane passes a cell when 0 <= low + n . (corner - vertex) <= range.
    struct PlaneTest {
        std::int64_t low;    // in 2^(shift - 1), so that half a voxel is whole
        std::int64_t range;  // in 2^shift
    };

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

private:
    void set_plane();
    void set_plane_steps(std::int64_t sum, std::int64_t positive);
    void set_edges(const std::array<FixedPoint, 3>& corners, const int sign[3]);
    void set_thin_offsets();
};

inline TriangleSetup::TriangleSetup(const std::array<FixedPoint, 3>& corners, int voxel_shift,
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

HWY_INLINE void TriangleSetup::set_plane() {
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
    set_plane_steps(sum, positive);
}

/// The plane's steps in 16 bits: which low bits are left out, and what that may cost.
/// @param sum       |n|
/// @param positive  of it, what belongs to steps up
HWY_INLINE void TriangleSetup::set_plane_steps(std::int64_t sum, std::int64_t positive) {
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
HWY_INLINE void TriangleSetup::set_edges(const std::array<FixedPoint, 3>& corners,
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

inline void TriangleSetup::set_thin_offsets() {
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
