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

#include <algorithm>
#include <cstring>

#include "octavo/trace/wide_batch-inl.h"
#include "octavo/trace/wide_lanes-inl.h"

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
/// exists, else on to the next one. Where both lead is known before the words of the node are, and
/// found while these are on their way; they only choose. A lane that has finished stands still,
/// until a quarter of them have: then their hits are told, and they take new rays.
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
        word_ = hn::Zero(di);
        above_lane_ = hn::Iota(di, static_cast<std::int32_t>(kLanes));
        least_height_ = hn::Set(di, stop.height + 1);
        leaf_shift_ = down_z_ = hn::Zero(di);
        live_ = hn::FirstN(di, 0);
        for (std::int32_t& node : stack_) node = 0;
    }

    [[nodiscard]] bool idle() const { return count_live_ == 0; }

    /// Gives new rays to lanes that have finished, if enough have. @return whether it took any
    template <class Reader, class Results>
    HWY_INLINE bool refill(Reader& reader, Results& results) {
        if (count_live_ > kLanes - std::max<std::size_t>(1, kLanes / 4)) return false;
        bool took = false;
        while (count_live_ < kLanes) {
            const std::size_t count = std::min(reader.available(), kLanes - count_live_);
            if (count == 0) break;
            if (!took) tell(results);
            load(reader.batch(), reader.take(count), count);
            took = true;
        }
        return took;
    }

    /// Tells the hits of lanes that have finished.
    template <class Results>
    HWY_INLINE void tell(Results& results) {
        const IntMask found = this->found();
        if (hn::AllFalse(IntTag(), found)) return;
        results.add(hit_lanes(found));
        t_ = hn::IfThenElse(hn::RebindMask(FloatTag(), found), t_end_, t_);
    }

    HWY_INLINE void step() {
        const FloatTag df;
        const IntTag di;
        const Ints one = hn::Set(di, 1);
        if constexpr (kPrefetch) read_node(node_, height_, corner_[2]);

        // Down: the child that the ray is in at time t. On: the cell beyond the nearest far plane.
        const Ints width = hn::Shl(one, height_);
        const Ints half = hn::ShiftRight<1>(width);
        Floats exits[3];
        IntMask high[3];
        for (int axis = 0; axis < 3; ++axis) {
            const Ints offset = hn::Sub(corner_[axis], cell_[axis]);
            const Floats middle = time_at(hn::Add(offset, half), axis);
            high[axis] = hn::RebindMask(di, hn::Le(middle, t_));
            exits[axis] = time_at(hn::Add(offset, width), axis);
        }
        const Floats exit = min3(exits[0], exits[1], exits[2]);
        Ints on[3];
        Ints changed = hn::Zero(di);
        for (int axis = 0; axis < 3; ++axis) {
            const IntMask crossed = hn::RebindMask(di, hn::Le(exits[axis], exit));
            on[axis] = add_where(crossed, corner_[axis], width);
            changed = hn::Or(changed, hn::Xor(corner_[axis], on[axis]));
        }
        // The height of the cell beyond, and its parent, or the leaf around it. The grid's far
        // planes are crossed when the ray ends, or later.
        const Ints last = highest_bit(changed);
        const Ints above = gather_where(hn::Gt(last, height_), node_, stack_, stack_place(last));
        const Ints align = hn::Shl(hn::Set(di, -1), last);

        // Does the cell exist? In a leaf its 2x2x2 block's byte says so, whole or by its voxels.
        const Ints child_bit = hn::Shl(one, child_at(width));
        const IntMask in_leaf = hn::Lt(height_, hn::Set(di, 2));
        const Ints kids = hn::IfThenElse(in_leaf, leaf_byte(), word_);
        const Ints wanted = hn::IfThenElse(hn::Eq(height_, one), hn::Set(di, 255), child_bit);
        const IntMask exists = has_any_where(live_, kids, wanted);
        const IntMask goes_on = hn::AndNot(exists, live_);
        IntMask descends = at_least_where(exists, height_, least_height_);
        if constexpr (kCone) descends = hn::AndNot(stops_by_cone(), descends);
        const IntMask advances = less_where(goes_on, exit, t_end_);
        live_ = hn::Or(descends, advances);
        count_live_ = hn::CountTrue(di, live_);

        const Ints lower = hn::And(word_, hn::Sub(child_bit, one));
        const Ints pointer = hn::Add(node_, count_bits(lower));
        const IntMask to_node = at_least_where(descends, height_, hn::Set(di, 2));
        const Ints node =
            gather_where(to_node, hn::IfThenElse(advances, above, node_), words_ + 1, pointer);
        // A ray that ends here, without a hit, has its time at the end, too: see found().
        t_ = hn::IfThenElse(hn::RebindMask(df, goes_on), exit, t_);
        const Ints height = hn::IfThenElse(advances, last, subtract_where(descends, height_, one));
        const Ints down = hn::IfThenElseZero(descends, half);
        Ints corner[3];
        for (int axis = 0; axis < 3; ++axis)
            corner_[axis] = corner[axis] =
                and_where(advances, add_where(high[axis], corner_[axis], down), on[axis], align);
        height_ = height;
        node_ = node;
        if constexpr (!kPrefetch) read_node(node, height, corner[2]);
        // It stands at its place already where the ray has gone on.
        hn::ScatterIndex(node, di, stack_, stack_place(height));
        if constexpr (kPrefetch) prefetch_nodes(to_node);
    }

private:
    /// Where the stack has the parent of a cell of this height, or the leaf around it.
    HWY_INLINE Ints stack_place(Ints height) const {
        constexpr int kShift = std::bit_width(kLanes) - 1;
        return hn::Add(hn::ShiftLeft<kShift>(height), above_lane_);
    }

    /// The real number of the child of this width, among its siblings, that lies at the corner.
    HWY_INLINE Ints child_at(Ints width) const {
        const IntTag di;
        Ints child = down_;
        for (int axis = 0; axis < 3; ++axis) {
            child = xor_where(has_any(corner_[axis], width), child, hn::Set(di, 1 << axis));
        }
        return child;
    }

    /// The byte of the 2x2x2 block of a leaf that the ray is in, and other bits above it.
    HWY_INLINE Ints leaf_byte() const {
        const IntTag di;
        const Ints two = hn::Set(di, 2);
        Ints shift = xor_where(has_any(corner_[0], two), leaf_shift_, hn::Set(di, 8));
        shift = xor_where(has_any(corner_[1], two), shift, hn::Set(di, 16));
        return hn::Shr(word_, shift);
    }

    HWY_INLINE void read_node(Ints node, Ints height, Ints corner_z) {
        const IntTag di;
        const Ints two = hn::Set(di, 2);
        const IntMask in_leaf = hn::Lt(height, two);
        const IntMask upper = has_any_where(in_leaf, hn::Xor(corner_z, down_z_), two);
        word_ = hn::GatherIndex(di, words_, add_where(upper, node, hn::Set(di, 1)));
    }
    /// A gather that misses the caches holds up all that follows it, and this does not. Two numbers
    /// come in one load: a core has more loads to do here than it has ports for. So it asks for no
    /// more nodes than go down in nearly every step; those above have just been read.
    HWY_INLINE void prefetch_nodes(IntMask lanes) const {
        constexpr std::size_t kMost = std::min<std::size_t>(kLanes, 10);
        static_assert(kMost % 2 == 0);
        const IntTag di;
        HWY_ALIGN std::int32_t nodes[kLanes];
        hn::Store(hn::Compress(hn::IfThenElseZero(lanes, node_), lanes), di, nodes);
        for (std::size_t i = 0; i < kMost; i += 2) {
            std::uint64_t two = 0;
            std::memcpy(&two, nodes + i, sizeof two);
            hwy::Prefetch(words_ + (two & 0xFFFFFFFFu));
            hwy::Prefetch(words_ + (two >> 32));
        }
    }

    /// shared::plane_time() of planes so far from the ray's own cell.
    HWY_INLINE Floats time_at(Ints offset, int axis) const {
        return hn::Mul(hn::Sub(hn::ConvertTo(FloatTag(), offset), frac_[axis]), inv_dir_[axis]);
    }
    /// When the low planes of the cell are crossed.
    HWY_INLINE Floats entry(int axis) const {
        return time_at(hn::Sub(corner_[axis], cell_[axis]), axis);
    }

    /// Lanes that have ended before their ray has: with a hit that has not been told.
    HWY_INLINE IntMask found() const {
        return hn::AndNot(live_, hn::RebindMask(IntTag(), hn::Lt(t_, t_end_)));
    }
    HWY_INLINE HitLanes hit_lanes(IntMask found) const {
        return {found,   ray_,  {corner_[0], corner_[1], corner_[2]},
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
    HWY_NOINLINE void load(const Batch& batch, std::size_t first, std::size_t count) {
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
        leaf_shift_ = hn::ShiftLeft<3>(hn::And(down_, hn::Set(di, 3)));
        down_z_ = hn::ShiftRight<1>(hn::And(down_, hn::Set(di, 4)));
        load_ints(batch.ray, ray_);
        load_ints(batch.height, height_);
        load_ints(batch.node, node_);
        if constexpr (kPrefetch)
            prefetch_nodes(take);
        else
            word_ = hn::IfThenElse(take, hn::GatherIndex(di, words_, node_), word_);
        for (int height = batch.top; height <= depth_; ++height)
            hn::BlendedStore(hn::Set(di, batch.nodes[height]), take, di,
                             stack_ + static_cast<std::size_t>(height) * kLanes);
        live_ = hn::Or(live_, take);
        count_live_ += count;
    }

    /// A bit for each lane without a ray.
    HWY_INLINE std::uint32_t free_lanes() const {
        const IntTag di;
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(di, hn::Not(live_), bits);
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
    Ints word_;    // the node's first word; in a leaf, the one with the block that the ray is in
    Ints above_lane_;
    Ints least_height_;                                       // where a ray does not stop
    Ints leaf_shift_;                                         // of down_: 8 for x and 16 for y
    Ints down_z_;                                             // of down_: 2 for z
    IntMask live_;                                            // the lane has a ray on its way
    HWY_ALIGN std::int32_t stack_[(kMaxDepth + 2) * kLanes];  // by height: the nodes on the path
};

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
