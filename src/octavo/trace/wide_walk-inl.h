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

#include <hwy/highway.h>

#include "octavo/trace/wide_batch-inl.h"

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
template <bool kCone>
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
        for (auto& level : stack_)
            for (std::int32_t& node : level) node = 0;
    }

    [[nodiscard]] bool idle() const { return count_live_ == 0; }

    /// Gives new rays to lanes that have finished, if enough have. @return whether it took any
    HWY_INLINE bool refill(BatchReader& reader) {
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

        // Does the cell exist? In a leaf its 2x2x2 block's byte says so, whole or by its voxels.
        const Ints child = child_at(height_);
        const Ints block = child_at(one);
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
        const Ints above = hn::GatherIndex(di, stack_[0], stack_place(level));
        node_ = hn::IfThenElse(to_node, below, hn::IfThenElse(to_ancestor, above, node_));
        // In every lane the node is that of the cell's parent, or the leaf around it: writing it
        // where it stands already does no harm.
        hn::ScatterIndex(node_, di, stack_[0], stack_place(hn::Max(hn::Add(height_, one), two)));
        low_ = hn::GatherIndex(di, words_, node_);
        const Ints leaf_lane = hn::VecFromMask(di, hn::Lt(height_, two));
        high_ = hn::GatherIndex(di, words_, hn::Sub(node_, leaf_lane));
        const Ints align = hn::Neg(hn::Shl(one, height_));
        for (int axis = 0; axis < 3; ++axis) corner_[axis] = hn::And(next[axis], align);
    }

private:
    HWY_INLINE static Ints count_bits(Ints bytes) {
        const IntTag di;
        Ints v = hn::Sub(bytes, hn::And(hn::ShiftRight<1>(bytes), hn::Set(di, 0x55)));
        v = hn::Add(hn::And(v, hn::Set(di, 0x33)),
                    hn::And(hn::ShiftRight<2>(v), hn::Set(di, 0x33)));
        return hn::And(hn::Add(v, hn::ShiftRight<4>(v)), hn::Set(di, 15));
    }

    HWY_INLINE Ints stack_place(Ints level) const {
        constexpr int kShift = std::bit_width(kLanes) - 1;
        return hn::Add(hn::ShiftLeft<kShift>(level), lane_);
    }

    /// The real number of the child, among its siblings, that lies at the corner.
    HWY_INLINE Ints child_at(Ints height) const {
        const IntTag di;
        const Ints one = hn::Set(di, 1);
        const Ints x = hn::And(hn::Shr(corner_[0], height), one);
        const Ints y = hn::And(hn::Shr(corner_[1], height), one);
        const Ints z = hn::And(hn::Shr(corner_[2], height), one);
        return hn::Xor(hn::Or(x, hn::Or(hn::ShiftLeft<1>(y), hn::ShiftLeft<2>(z))), down_);
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
    HWY_NOINLINE void load(const Batch& batch, std::size_t first, std::size_t count) {
        const FloatTag df;
        const IntTag di;
        // The number of the free lane among the free lanes; those from `count` on stay free.
        HWY_ALIGN std::int32_t places[kLanes];
        HWY_ALIGN std::int32_t wanted[kLanes];
        HWY_ALIGN std::int32_t live[kLanes];
        hn::Store(live_, di, live);
        std::int32_t free = 0;
        for (std::size_t i = 0; i < kLanes; ++i) {
            const bool takes = live[i] == 0 && free < static_cast<std::int32_t>(count);
            places[i] = takes ? free++ : 0;
            wanted[i] = takes ? -1 : 0;
        }
        const auto places_index = hn::SetTableIndices(di, places);
        const auto places_float = hn::SetTableIndices(df, places);
        const Ints wanted_vector = hn::Load(di, wanted);
        const IntMask take = hn::MaskFromVec(wanted_vector);
        const FloatMask take_float = hn::RebindMask(df, take);
        const auto load_ints = [&](const std::int32_t* from, Ints& to) {
            to = hn::IfThenElse(
                take, hn::TableLookupLanes(hn::LoadU(di, from + first), places_index), to);
        };
        const auto load_floats = [&](const float* from, Floats& to) {
            to = hn::IfThenElse(
                take_float, hn::TableLookupLanes(hn::LoadU(df, from + first), places_float), to);
        };
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
        low_ = hn::IfThenElse(take, hn::GatherIndex(di, words_, node_), low_);
        for (int height = batch.top; height <= depth_; ++height)
            hn::BlendedStore(hn::Set(di, batch.nodes[height]), take, di, stack_[height]);
        live_ = hn::Or(live_, wanted_vector);
        count_live_ += count;
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
    Ints live_;                                            // all bits set where the lane has a ray
    HWY_ALIGN std::int32_t stack_[kMaxDepth + 2][kLanes];  // by height: the nodes on the path
};

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
