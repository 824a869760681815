// SPDX-License-Identifier: MIT
//
// One vector of rays on its way through the DAG: traverse.h with a ray in each lane. Compiled once
// for each SIMD target.
#if defined(OCTAVO_TRACE_WIDE_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTAVO_TRACE_WIDE_WALK_INL_H
#undef OCTAVO_TRACE_WIDE_WALK_INL_H
#else
#define OCTAVO_TRACE_WIDE_WALK_INL_H
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "octavo/trace/wide_batch-inl.h"

// What Highway has no name for: loads that expand, and gathers of pairs.
#undef OCTAVO_WIDE_AVX512
#define OCTAVO_WIDE_AVX512 (HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL)

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

/// Lanes whose ray has met a cell where it stops.
struct HitLanes {
    IntMask hit;  // the others are to be left alone
    Ints ray;
    Ints corner[3];  // mirrored
    Ints height;
    Ints down;
    Floats entry[3];  // when the low planes of the cell are crossed
    Floats t;
};

/// Every lane makes one step of the shared text's loop at a time: down into its cell where that
/// exists, else on to the next one. Both ways are computed for all lanes, without a branch; a step
/// needs the crossing of three planes only, of the cell's far ones or of its middle ones.
///
/// Lanes that have finished take new rays when a quarter of them have.
///
/// @tparam kPrefetch  for DAGs far larger than the caches: a step asks for the nodes that the next
///                    one reads, instead of waiting for them. Wants more vectors in flight.
template <bool kCone, bool kPrefetch>
class Walk {
public:
    Walk(shared::DagView dag, shared::Stop stop) : stop_(stop), depth_(dag.depth) {
        words_ = reinterpret_cast<const std::int32_t*>(dag.words);
        const FloatTag df;
        const IntTag di;
        for (int axis = 0; axis < 3; ++axis) {
            cell_[axis] = corner_[axis] = hn::Zero(di);
            frac_[axis] = inv_dir_[axis] = hn::Zero(df);
        }
        t_ = t_end_ = hn::Zero(df);
        down_ = ray_ = node_ = hn::Zero(di);
        height_ = hn::Set(di, 2);
        low_ = high_ = hn::Zero(di);
        lane_ = hn::Iota(di, 0);
        live_ = hn::VecFromMask(di, hn::FirstN(di, 0));
        for (std::int32_t& node : stack_) node = 0;
    }

    [[nodiscard]] bool idle() const { return count_live_ == 0; }

    /// Gives new rays to lanes that have finished, if enough have. @return whether it took any
    template <class Reader>
    HWY_INLINE bool refill(Reader& reader) {
        if (count_live_ > kLanes - std::max<std::size_t>(1, kLanes / 4)) return false;
        const std::size_t count = std::min(reader.available(), kLanes - count_live_);
        if (count == 0) return false;
        load(reader.batch(), reader.take(count), count);
        return true;
    }

    template <class Results>
    HWY_INLINE void step(Results& results) {
        const FloatTag df;
        const IntTag di;
        const Ints one = hn::Set(di, 1);
        const Ints two = hn::Set(di, 2);
        if constexpr (kPrefetch) read_node();

        // Does the cell exist? In a leaf its 2x2x2 block's byte says so, whole or by its voxels.
        const Ints child = child_at(hn::Shl(one, height_));
        const Ints block = child_at(two);
        const Ints half_leaf = hn::IfThenElse(hn::Gt(block, hn::Set(di, 3)), high_, low_);
        const Ints byte = hn::And(
            hn::Shr(half_leaf, hn::ShiftLeft<3>(hn::And(block, hn::Set(di, 3)))), hn::Set(di, 255));
        const IntMask in_leaf = hn::Lt(height_, two);
        const Ints whole = hn::VecFromMask(di, hn::Gt(byte, hn::Zero(di)));
        const Ints kids =
            hn::IfThenElse(in_leaf, hn::IfThenElse(hn::Eq(height_, one), whole, byte), low_);
        const Ints child_bit = hn::Shl(one, child);
        const IntMask live = hn::MaskFromVec(live_);
        const IntMask exists = hn::And(live, hn::TestBit(kids, child_bit));

        IntMask hit = hn::And(exists, hn::Lt(height_, hn::Set(di, stop_.height + 1)));
        if constexpr (kCone) hit = hn::Or(hit, hn::And(exists, stops_by_cone()));
        if (!hn::AllFalse(di, hit)) results.add(hit_lanes(hit));
        const IntMask descends = hn::AndNot(hit, exists);
        const IntMask advances = hn::AndNot(exists, live);

        // Down: the child that the ray is in at time t. On: the cell beyond the nearest far plane.
        const Ints height_down = hn::Add(height_, hn::VecFromMask(di, descends));
        const Ints width = hn::Shl(one, height_down);
        Floats crossing[3];
        for (int axis = 0; axis < 3; ++axis)
            crossing[axis] =
                plane_time(hn::Add(corner_[axis], width), cell_[axis], frac_[axis], inv_dir_[axis]);
        t_ = hn::IfThenElse(hn::RebindMask(df, advances),
                            min3(crossing[0], crossing[1], crossing[2]), t_);
        Ints next[3];
        Ints changed = hn::Zero(di);
        for (int axis = 0; axis < 3; ++axis) {
            const IntMask crossed = hn::RebindMask(di, hn::Le(crossing[axis], t_));
            next[axis] = hn::Add(corner_[axis], hn::IfThenElseZero(crossed, width));
            changed = hn::Or(changed, hn::Xor(corner_[axis], next[axis]));
        }
        // The highest bit that changed, by a float's exponent.
        const Ints last = hn::Sub(hn::ShiftRight<23>(hn::BitCast(di, hn::ConvertTo(df, changed))),
                                  hn::Set(di, 127));
        const IntMask ends =
            hn::And(advances, hn::Or(hn::Not(hn::RebindMask(di, hn::Lt(t_, t_end_))),
                                     hn::Gt(last, hn::Set(di, depth_ - 1))));
        const IntMask gone = hn::Or(ends, hit);
        live_ = hn::IfThenZeroElse(gone, live_);
        count_live_ = hn::CountTrue(di, hn::MaskFromVec(live_));

        const IntMask climbs = hn::And(hn::AndNot(ends, advances), hn::Gt(last, height_));
        const IntMask to_node = hn::AndNot(in_leaf, descends);
        const IntMask to_ancestor = hn::And(climbs, hn::Gt(last, one));
        height_ = hn::IfThenElse(climbs, last, height_down);

        const Ints lower = hn::And(low_, hn::Sub(child_bit, one));
        const Ints pointer =
            hn::Add(hn::Add(node_, one), count_bits(hn::And(lower, hn::Set(di, 255))));
        const Ints below = hn::GatherIndex(di, words_, hn::IfThenElse(to_node, pointer, node_));
        const Ints level = hn::IfThenElseZero(to_ancestor, hn::Add(last, one));
        const Ints above = hn::GatherIndex(di, stack_, stack_place(level));
        node_ = hn::IfThenElse(to_node, below, hn::IfThenElse(to_ancestor, above, node_));
        // In every lane the node is that of the cell's parent, or the leaf around it: writing it
        // where it stands already does no harm.
        hn::ScatterIndex(node_, di, stack_, stack_place(hn::Max(hn::Add(height_, one), two)));
        if constexpr (kPrefetch)
            prefetch_node();
        else
            read_node();
        const Ints align = hn::Neg(hn::Shl(one, height_));
        for (int axis = 0; axis < 3; ++axis) corner_[axis] = hn::And(next[axis], align);
    }

private:
    /// Of numbers below 256.
    HWY_INLINE static Ints count_bits(Ints bytes) {
        const IntTag di;
#if OCTAVO_WIDE_AVX512
        const __m512i counts =
            _mm512_broadcast_i32x4(_mm_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4));
        const __m512i low = hn::And(bytes, hn::Set(di, 15)).raw;
        const __m512i high = hn::ShiftRight<4>(bytes).raw;
        return hn::Add(Ints{_mm512_shuffle_epi8(counts, low)},
                       Ints{_mm512_shuffle_epi8(counts, high)});
#else
        Ints v = hn::Sub(bytes, hn::And(hn::ShiftRight<1>(bytes), hn::Set(di, 0x55)));
        v = hn::Add(hn::And(v, hn::Set(di, 0x33)),
                    hn::And(hn::ShiftRight<2>(v), hn::Set(di, 0x33)));
        return hn::And(hn::Add(v, hn::ShiftRight<4>(v)), hn::Set(di, 15));
#endif
    }

    HWY_INLINE Ints stack_place(Ints level) const {
        constexpr int kShift = std::bit_width(kLanes) - 1;
        return hn::Add(hn::ShiftLeft<kShift>(level), lane_);
    }

    /// The real number of the child of this width, among its siblings, that lies at the corner.
    HWY_INLINE Ints child_at(Ints width) const {
        const IntTag di;
        Ints child = down_;
        for (int axis = 0; axis < 3; ++axis) {
            const IntMask high = hn::TestBit(corner_[axis], width);
            child = hn::IfThenElse(high, hn::Xor(child, hn::Set(di, 1 << axis)), child);
        }
        return child;
    }

    HWY_INLINE void read_node() {
        const IntTag di;
#if OCTAVO_WIDE_AVX512
        // Both words at once: half as many loads.
        const __m512i a = _mm512_i32gather_epi64(_mm512_castsi512_si256(node_.raw), words_, 4);
        const __m512i b =
            _mm512_i32gather_epi64(_mm512_extracti64x4_epi64(node_.raw, 1), words_, 4);
        const __m512i even = hn::Add(lane_, lane_).raw;
        low_ = Ints{_mm512_permutex2var_epi32(a, even, b)};
        high_ = Ints{_mm512_permutex2var_epi32(a, hn::Add(Ints{even}, hn::Set(di, 1)).raw, b)};
#else
        const Ints in_leaf = hn::VecFromMask(di, hn::Lt(height_, hn::Set(di, 2)));
        low_ = hn::GatherIndex(di, words_, node_);
        high_ = hn::GatherIndex(di, words_, hn::Sub(node_, in_leaf));
#endif
    }
    /// A gather that misses the caches holds up all that follows it, and this does not.
    HWY_INLINE void prefetch_node() const {
        HWY_ALIGN std::int32_t nodes[kLanes];
        hn::Store(node_, IntTag(), nodes);
        for (std::size_t lane = 0; lane < kLanes; ++lane) hwy::Prefetch(words_ + nodes[lane]);
    }

    /// When the low planes of the cell are crossed.
    HWY_INLINE Floats entry(int axis) const {
        return plane_time(corner_[axis], cell_[axis], frac_[axis], inv_dir_[axis]);
    }

    HWY_INLINE HitLanes hit_lanes(IntMask hit) const {
        return {hit,     ray_,  {corner_[0], corner_[1], corner_[2]},
                height_, down_, {entry(0), entry(1), entry(2)},
                t_};
    }

    /// shared::may_stop(), by the cone.
    HWY_INLINE IntMask stops_by_cone() const {
        const FloatTag df;
        const IntTag di;
        const Floats travelled =
            hn::Add(hn::Set(df, stop_.time_before), max3(entry(0), entry(1), entry(2)));
        const Floats width = hn::ConvertTo(df, hn::Shl(hn::Set(di, 1), height_));
        return hn::RebindMask(di, hn::Lt(width, hn::Mul(travelled, hn::Set(df, stop_.cone))));
    }

    /// Rays first to first + count of the batch go to as many free lanes.
    template <class SomeBatch>
    HWY_NOINLINE void load(const SomeBatch& batch, std::size_t first, std::size_t count) {
        const IntTag di;
        // As many free lanes as there are rays, and the number of each among them.
        const std::uint32_t all = free_lanes();
        std::uint32_t chosen = all;
        for (auto more = static_cast<std::size_t>(std::popcount(all)); more > count; --more)
            chosen &= ~std::bit_floor(chosen);
#if OCTAVO_WIDE_AVX512
        const auto bits = static_cast<__mmask16>(chosen);
        const IntMask take{bits};
        const auto load_ints = [&](const std::int32_t* from, Ints& to) {
            to = Ints{_mm512_mask_expandloadu_epi32(to.raw, bits, from + first)};
        };
        const auto load_floats = [&](const float* from, Floats& to) {
            to = Floats{_mm512_mask_expandloadu_ps(to.raw, bits, from + first)};
        };
#else
        HWY_ALIGN std::int32_t places[kLanes];
        HWY_ALIGN std::int32_t wanted[kLanes];
        std::int32_t next = 0;
        for (std::size_t i = 0; i < kLanes; ++i) {
            const bool takes = (chosen >> i & 1) != 0;
            places[i] = takes ? next++ : 0;
            wanted[i] = takes ? -1 : 0;
        }
        const FloatTag df;
        const auto places_index = hn::SetTableIndices(di, places);
        const auto places_float = hn::SetTableIndices(df, places);
        const IntMask take = hn::MaskFromVec(hn::Load(di, wanted));
        const FloatMask take_float = hn::RebindMask(df, take);
        const auto load_ints = [&](const std::int32_t* from, Ints& to) {
            to = hn::IfThenElse(
                take, hn::TableLookupLanes(hn::LoadU(di, from + first), places_index), to);
        };
        const auto load_floats = [&](const float* from, Floats& to) {
            to = hn::IfThenElse(
                take_float, hn::TableLookupLanes(hn::LoadU(df, from + first), places_float), to);
        };
#endif
        for (int axis = 0; axis < 3; ++axis) {
            load_ints(batch.cell[axis], cell_[axis]);
            load_floats(batch.frac[axis], frac_[axis]);
            load_floats(batch.inv_dir[axis], inv_dir_[axis]);
            load_ints(batch.corner[axis], corner_[axis]);
        }
        load_floats(batch.t, t_);
        load_floats(batch.t_end, t_end_);
        load_ints(batch.down, down_);
        load_ints(batch.ray, ray_);
        load_ints(batch.height, height_);
        load_ints(batch.node, node_);
        if constexpr (kPrefetch)
            prefetch_node();
        else
            low_ = hn::IfThenElse(take, hn::GatherIndex(di, words_, node_), low_);
        if constexpr (SomeBatch::kStaysInCell) {
            const Ints least = hn::Set(di, 2);
            const Ints above = hn::Add(height_, hn::Set(di, 1));
            hn::ScatterIndex(node_, di, stack_, stack_place(hn::Max(above, least)));
        } else {
            for (int height = batch.top; height <= depth_; ++height)
                hn::BlendedStore(hn::Set(di, batch.nodes[height]), take, di,
                                 stack_ + static_cast<std::size_t>(height) * kLanes);
        }
        live_ = hn::Or(live_, hn::VecFromMask(di, take));
        count_live_ += count;
    }

    /// A bit for each lane without a ray.
    HWY_INLINE std::uint32_t free_lanes() const {
        const IntTag di;
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(di, hn::Eq(live_, hn::Zero(di)), bits);
        return bits[0] | std::uint32_t{bits[1]} << 8;
    }

    const std::int32_t* words_;
    shared::Stop stop_;
    int depth_;
    std::size_t count_live_ = 0;

    Ints cell_[3], corner_[3];
    Floats frac_[3], inv_dir_[3];
    Floats t_, t_end_;
    Ints down_, ray_;
    Ints height_;  // of the cell that the ray is in, see corner_
    Ints node_;    // its parent; in a leaf, the leaf
    Ints low_;     // the node's first word
    Ints high_;    // a leaf's second word
    Ints lane_;
    Ints live_;  // all bits set where the lane has a ray
    HWY_ALIGN std::int32_t stack_[(kMaxDepth + 2) * kLanes];  // by height: the nodes on the path
};

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
