// SPDX-License-Identifier: MIT
//
// beam_start() of beam.h with the eight children of a cell in one test. Compiled once for each SIMD
// target.
#if defined(OCTAVO_TRACE_WIDE_BEAM_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTAVO_TRACE_WIDE_BEAM_INL_H
#undef OCTAVO_TRACE_WIDE_BEAM_INL_H
#else
#define OCTAVO_TRACE_WIDE_BEAM_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "octavo/trace/dag_view.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The times are those of shared::plane_time(), and a cell is entered no earlier than its parent:
/// so the least entry into a cell where a ray may stop is the same in whatever order they come.
///
/// Vectors hold x, y, z and nothing, or the four children on one side of z.
class BeamWalk {
public:
    /// @param beam  finite, its directions of one sign on each axis
    BeamWalk(shared::DagView dag, const shared::Bundle& beam, shared::Stop stop)
        : dag_(dag), beam_(beam), stop_(stop), best_(beam.t_max) {
        const shared::UpwardRay slow =
            shared::mirror_ray(beam.cell, beam.frac, beam.dir_low, dag.depth);
        const shared::UpwardRay fast =
            shared::mirror_ray(beam.cell, beam.frac, beam.dir_high, dag.depth);
        down_ = slow.down;
        for (int a = 0; a < 3; ++a) {
            cell_[a] = slow.cell[a];
            frac_[a] = slow.frac[a];
            slow_[a] = slow.inv_dir[a];
            fast_[a] = fast.inv_dir[a];
        }
    }

    [[nodiscard]] float start() {
        const std::int32_t falls = shared::child_number(down_);
        int height = dag_.depth;
        // The root is the only child of a cell twice as wide.
        Frame& above = stack_[static_cast<unsigned>(height + 1)];
        hn::Store(hn::Zero(IntTag()), IntTag(), above.corner);
        test(above, height, 1u);
        if (above.to_visit == 0) return best_;
        std::uint32_t node = 0;
        std::int32_t child = 0;
        hn::Store(hn::Zero(IntTag()), IntTag(), stack_[static_cast<std::size_t>(height)].corner);
        while (true) {
            Frame* frame = &stack_[static_cast<std::size_t>(height)];
            frame->node = node;
            test(*frame, height - 1, shared::mirror_children(children(height, node, child), down_));
            int mirrored = 0;
            do {
                while (frame->to_visit == 0) {
                    if (++height > dag_.depth) return best_;
                    ++frame;
                }
                mirrored = shared::lowest_bit(frame->to_visit);
                frame->to_visit &= frame->to_visit - 1;
            } while (!(frame->enter[mirrored] < best_));
            child = mirrored ^ falls;
            if (height > 2) node = shared::load_child(dag_, frame->node, child);
            --height;
            const IntTag d;
            const auto offset = hn::Load(d, kOffsets[mirrored]);
            hn::Store(hn::Add(hn::Load(d, frame->corner), hn::ShiftLeftSame(offset, height)), d,
                      stack_[static_cast<std::size_t>(height)].corner);
        }
    }

private:
    using FloatTag = hn::FixedTag<float, 4>;
    using IntTag = hn::FixedTag<std::int32_t, 4>;
    using Floats = hn::Vec<FloatTag>;

    /// A cell on the way from the root, under its height.
    struct Frame {
        HWY_ALIGN std::int32_t corner[4];  // mirrored
        HWY_ALIGN float enter[8];          // of its children, mirrored
        std::uint32_t to_visit;            // of these
        std::uint32_t node;
    };

    [[nodiscard]] HWY_INLINE std::uint32_t children(int height, std::uint32_t node,
                                                    std::int32_t child) const {
        if (height > 2) return shared::dag_load(dag_, node) & 255u;
        const std::uint32_t at = height == 2 ? node : stack_[2].node;
        const shared::uvec2 leaf(shared::dag_load(dag_, at), shared::dag_load(dag_, at + 1));
        return height == 2 ? shared::leaf_children(leaf) : shared::leaf_voxels(leaf, child);
    }

    /// Looks at children of this height: the answer gets better by those where rays may stop, and
    /// others that may better it are to visit.
    HWY_INLINE void test(Frame& frame, int height, std::uint32_t children) {
        const FloatTag d;
        const IntTag di;
        const auto size = hn::Set(di, 1 << height);
        const auto cells = hn::Sub(hn::Load(di, frame.corner), hn::Load(di, cell_));
        const auto slow = hn::Load(d, slow_), fast = hn::Load(d, fast_);
        const auto frac = hn::Load(d, frac_);
        const auto low = hn::Sub(hn::ConvertTo(d, cells), frac);
        const auto middle = hn::Sub(hn::ConvertTo(d, hn::Add(cells, size)), frac);
        const auto high = hn::Sub(hn::ConvertTo(d, hn::Add(cells, hn::Add(size, size))), frac);
        const auto low_slow = hn::Mul(low, slow), low_fast = hn::Mul(low, fast);
        const auto middle_slow = hn::Mul(middle, slow), middle_fast = hn::Mul(middle, fast);
        const auto high_slow = hn::Mul(high, slow), high_fast = hn::Mul(high, fast);
        const auto middle_first = hn::Min(middle_slow, middle_fast);
        const auto middle_last = hn::Max(middle_slow, middle_fast);

        const auto t_min = hn::Set(d, beam_.t_min);
        const auto end = hn::Set(d, std::min(beam_.t_max, best_));
        const Four enters(hn::Min(low_slow, low_fast), middle_first);
        const auto enter_xy = hn::Max(hn::Max(enters.x, enters.y), t_min);
        const auto enter0 = hn::Max(enter_xy, enters.z0), enter1 = hn::Max(enter_xy, enters.z1);
        const Four leaves(middle_last, hn::Max(high_slow, high_fast));
        const auto leave_xy = hn::Min(hn::Min(leaves.x, leaves.y), end);
        const auto leave0 = hn::Min(leave_xy, leaves.z0), leave1 = hn::Min(leave_xy, leaves.z1);
        hn::Store(enter0, d, frame.enter);
        hn::Store(enter1, d, frame.enter + 4);
        std::uint32_t some = children & bits(hn::Lt(enter0, leave0), hn::Lt(enter1, leave1));

        std::uint32_t last = some;  // where rays may stop
        if (height > stop_.height) {
            const auto width = hn::Set(d, static_cast<float>(1 << height));
            const auto spread = hn::Set(d, beam_.spread);
            last &= bits(hn::Lt(width, hn::Mul(enter0, spread)),
                         hn::Lt(width, hn::Mul(enter1, spread)));
            if (stop_.cone > 0.0f) {
                const Four latest(hn::Max(low_slow, low_fast), middle_last);
                const auto latest_xy = hn::Max(latest.x, latest.y);
                const auto before = hn::Set(d, stop_.time_before), cone = hn::Set(d, stop_.cone);
                const auto seen = [&](Floats z) {
                    return hn::Mul(hn::Add(before, hn::Max(latest_xy, z)), cone);
                };
                last |= some & bits(hn::Lt(width, seen(latest.z0)), hn::Lt(width, seen(latest.z1)));
            }
        }
        frame.to_visit = some & ~last;
        for (; last != 0; last &= last - 1)
            best_ = std::min(best_, frame.enter[shared::lowest_bit(last)]);
    }

    /// Of x, y and z on two planes each: x and y for the four children on one side of z, and z for
    /// those on each.
    struct Four {
        HWY_INLINE Four(Floats first, Floats second) {
            const FloatTag d;
            const auto both = hn::InterleaveLower(d, first, second);
            x = hn::ConcatLowerLower(d, both, both);
            y = hn::InterleaveUpper(d, both, both);
            z0 = hn::Broadcast<2>(first);
            z1 = hn::Broadcast<2>(second);
        }
        Floats x, y, z0, z1;
    };

    template <class Mask>
    static HWY_INLINE std::uint32_t bits(Mask lower, Mask upper) {
        std::uint8_t low[8] = {}, high[8] = {};
        hn::StoreMaskBits(FloatTag(), lower, low);
        hn::StoreMaskBits(FloatTag(), upper, high);
        return low[0] | static_cast<std::uint32_t>(high[0]) << 4;
    }

    HWY_ALIGN static constexpr std::int32_t kOffsets[8][4] = {
        {0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {1, 1, 0, 0},
        {0, 0, 1, 0}, {1, 0, 1, 0}, {0, 1, 1, 0}, {1, 1, 1, 0}};

    HWY_ALIGN std::int32_t cell_[4] = {};
    HWY_ALIGN float frac_[4] = {}, slow_[4] = {}, fast_[4] = {};
    shared::DagView dag_;
    shared::Bundle beam_;
    shared::Stop stop_;
    ivec3 down_;
    float best_;
    std::array<Frame, kMaxDepth + 2> stack_;
};

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
