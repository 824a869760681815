// SPDX-License-Identifier: MIT
//
// Rays that are certainly occluded, by the partitions of the nodes that they go through. Compiled
// once for each SIMD target.
#if defined(OCTAVO_TRACE_WIDE_PROOF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTAVO_TRACE_WIDE_PROOF_INL_H
#undef OCTAVO_TRACE_WIDE_PROOF_INL_H
#else
#define OCTAVO_TRACE_WIDE_PROOF_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "octavo/trace/cell_walk.h"
#include "octavo/trace/partitions.h"
#include "octavo/trace/wide_batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Takes rays that follow each other in groups, and finds those of each group that are occluded for
/// certain. A plane has one time whichever way it is reached, so a ray is in one voxel at a time,
/// and from one to the next it crosses at most one plane of each axis: the voxels that it is in
/// between entering a cell and leaving it are a chain in which each touches the one before. Where
/// the empty space of the cell does not connect the first with the last, a full one is among them.
///
/// A cell that occluded some rays is likely to occlude those that come next. So the last ones of
/// these are tried first; only then is a ray that is left led through the grid to find others.
class Prover {
public:
    Prover(shared::DagView dag, Partitions& partitions)
        : dag_(dag),
          partitions_(partitions),
          height_(partitions.height()),
          credit_(partitions.pays() ? kMostCredit : partitions.credit()) {}
    Prover(const Prover&) = delete;
    Prover& operator=(const Prover&) = delete;
    ~Prover() {
        partitions_.earn(count_found_);
        partitions_.set_credit(credit_);
    }

    /// By some of the rays: those that spread are not looked at one group after the other.
    [[nodiscard]] static bool run_alike(std::span<const shared::GridRay> rays) {
        if (rays.size() < kLanes) return false;
        const vec3 first = glm::normalize(rays[0].dir);
        // The first few lie side by side in memory, and tell most spreading ones.
        for (std::size_t i = 1; i < rays.size(); i += i < 3 ? 1 : 7)
            if (!(glm::dot(rays[i].dir, first) > kAlike * glm::length(rays[i].dir))) return false;
        return true;
    }

    /// @param rays  kRaysPerBatch or fewer
    /// @return      a bit for each ray that is occluded; the others are still to be traced
    std::uint64_t occluded(std::span<const shared::GridRay> rays) {
        if (groups_to_skip_ > 0) return --groups_to_skip_, 0;
        const FloatTag df;
        Floats distance = hn::Zero(df);
        open_ = 0;
        for (std::size_t i = 0; i < rays.size(); i += kLanes) {
            const RayLanes& r = lanes_[i / kLanes] =
                read_rays(dag_, rays, i, std::min(kLanes, rays.size() - i));
            open_ |= bits_of(r.live) << i;
            for (const Floats& origin : r.origin)
                distance = hn::Max(distance, hn::IfThenElseZero(r.live, hn::Abs(origin)));
        }
        const std::uint64_t live = open_;
        const float reach =
            hn::GetLane(hn::MaxOfLanes(df, distance)) + static_cast<float>(1 << dag_.depth);
        if (!(reach < kFarthest)) return 0;
        slack_ = kRounding * reach;
        try_remembered();
        if (credit_ >= 0 || --groups_without_search_ < 0) {
            groups_without_search_ = kGroupsWithoutSearch;
            search(rays);
        }
        const std::uint64_t found = live & ~open_;
        if (found == 0 && credit_ < 0) {
            groups_to_skip_ = groups_without_search_;
            groups_without_search_ = 0;
        }
        count_found_ += static_cast<std::size_t>(std::popcount(found));
        return found;
    }

private:
    static_assert(kRaysPerBatch == 64);

    /// Cells that are remembered. Four and eight were as fast or slower.
    static constexpr std::size_t kRemembered = 6;
    /// A search takes about as long as tracing this many rays.
    static constexpr int kRaysForSearch = 3;
    static constexpr int kLeastToSearch = 6;
    // Searches that find too little become rare.
    static constexpr int kMostCredit = 16;
    static constexpr int kGroupsWithoutSearch = 7;

    /// The cosine of the angle between directions that are alike.
    static constexpr float kAlike = 0.8f;

    /// From the grid's corner; voxels. A float tells neighbouring planes apart, in their times too.
    static constexpr float kFarthest = 1e6f;
    /// A part of a ray's way from its origin to a plane. The plane's time is rounded three times,
    /// and the place where the ray is at a time three times again, each by 2^-24 at most: 4e-7.
    static constexpr float kRounding = 2e-6f;

    struct Cell {
        const std::uint8_t* table = nullptr;
        ivec3 corner;  // real
    };

    void try_remembered() {
        for (std::size_t i = 0; i < kRemembered && open_ != 0; ++i) {
            if (remembered_[i].table == nullptr) return;
            const std::uint64_t before = open_;
            test(remembered_[i]);
            if (i > 0 && open_ != before) std::swap(remembered_[i], remembered_[i - 1]);
        }
    }

    /// Leads a ray through the grid, and tries its cells on all rays. Goes on with another while
    /// that paid.
    void search(std::span<const shared::GridRay> rays) {
        std::uint64_t guides = open_;
        bool pays = true;
        while (pays && std::popcount(guides) >= kLeastToSearch) {
            const int guide = middle_of(guides);
            const std::uint64_t bit = std::uint64_t{1} << guide;
            const std::uint64_t before = open_;
            bool complete = true;
            CellWalk walk(dag_, rays[static_cast<std::size_t>(guide)], height_);
            while ((open_ & bit) != 0 && walk.next()) {
                const Cell cell{partitions_.find(walk.node(), std::popcount(open_)), walk.corner()};
                complete = complete && cell.table != nullptr;
                if (cell.table != nullptr && !is_remembered(cell)) try_new(cell);
            }
            const int found = std::popcount(before & ~open_);
            pays = found >= kRaysForSearch;
            // Where tables were missing, more may be found when they are there.
            const int cost = complete ? kRaysForSearch : 1;
            credit_ = std::clamp(credit_ + found - cost, -kMostCredit, kMostCredit);
            guides &= open_ & ~bit;
        }
    }
    /// A ray among others is more likely to share their fate than one at the end of them.
    static int middle_of(std::uint64_t rays) {
        for (int i = std::popcount(rays) / 2; i > 0; --i) rays &= rays - 1;
        return std::countr_zero(rays);
    }
    [[nodiscard]] bool is_remembered(const Cell& cell) const {
        return std::any_of(remembered_.begin(), remembered_.end(), [&](const Cell& other) {
            return other.table != nullptr && other.corner == cell.corner;
        });
    }
    void try_new(const Cell& cell) {
        const std::uint64_t before = open_;
        test(cell);
        if (open_ == before) return;
        std::move_backward(remembered_.begin(), remembered_.end() - 1, remembered_.end());
        remembered_[0] = cell;
    }

    void test(const Cell& cell) {
        const std::uint64_t open = open_;
        for (std::size_t i = 0; i < kRaysPerBatch; i += kLanes) {
            const std::uint64_t some = open >> i & kLaneBits;
            if (some != 0) open_ &= ~((some & parted(lanes_[i / kLanes], cell)) << i);
        }
    }

    /// Those rays of a vector that go through the whole cell, from a place on its faces to one that
    /// its empty space does not connect with it.
    HWY_INLINE std::uint64_t parted(const RayLanes& r, const Cell& cell) const {
        const FloatTag df;
        const IntTag di;
        const Ints width = hn::Set(di, 1 << height_);
        const Ints far_side = hn::Sub(hn::Set(di, 1 << dag_.depth), width);
        IntMask falls[3];
        Floats from_origin[3], enter[3], leave[3];
        for (int axis = 0; axis < 3; ++axis) {
            falls[axis] = hn::TestBit(r.down, hn::Set(di, 1 << axis));
            const Ints real = hn::Set(di, cell.corner[axis]);
            const Ints corner = hn::IfThenElse(falls[axis], hn::Sub(far_side, real), real);
            const Ints offset = hn::Sub(corner, r.cell[axis]);
            from_origin[axis] = hn::Sub(hn::ConvertTo(df, offset), r.frac[axis]);
            enter[axis] = hn::Mul(from_origin[axis], r.inv_dir[axis]);
            leave[axis] =
                plane_time(hn::Add(corner, width), r.cell[axis], r.frac[axis], r.inv_dir[axis]);
        }
        const Floats t_enter = max3(enter[0], enter[1], enter[2]);
        const Floats t_leave = min3(leave[0], leave[1], leave[2]);
        FloatMask passes = hn::And(hn::Lt(t_enter, t_leave),
                                   hn::And(hn::Ge(t_enter, r.low), hn::Le(t_leave, r.high)));
        if (hn::AllFalse(df, passes)) return 0;

        // The blocks of the first voxel and of the last. Where rounding leaves open which block it
        // is, nothing is proven.
        const float blocks_per_voxel =
            static_cast<float>(Partitions::kBlocks) / static_cast<float>(1 << height_);
        const Floats scale = hn::Set(df, blocks_per_voxel);
        const Floats slack = hn::Set(df, slack_ * blocks_per_voxel);
        const Ints last = hn::Set(di, Partitions::kBlocks - 1);
        Ints first_block = hn::Zero(di), last_block = hn::Zero(di);
        for (int axis = 0; axis < 3; ++axis) {
            const Floats speed = hn::Mul(hn::Max(hn::Abs(r.dir[axis]), hn::Set(df, 1e-20f)), scale);
            const Floats start = hn::Mul(from_origin[axis], scale);
            const Ints mirror = hn::IfThenElseZero(falls[axis], last);
            const auto block = [&](Floats t, FloatMask at_face, Ints face) {
                const Floats at = hn::Sub(hn::Mul(t, speed), start);
                const Floats low = hn::Floor(hn::Sub(at, slack));
                const Floats high = hn::Floor(hn::Add(at, slack));
                passes = hn::And(passes, hn::Or(at_face, hn::Eq(low, high)));
                const Ints up = hn::IfThenElse(hn::RebindMask(di, at_face), face,
                                               hn::And(hn::ConvertTo(di, low), last));
                return hn::Shl(hn::Xor(up, mirror), hn::Set(di, 3 * axis));
            };
            first_block =
                hn::Or(first_block, block(t_enter, hn::Eq(enter[axis], t_enter), hn::Zero(di)));
            last_block = hn::Or(last_block, block(t_leave, hn::Eq(leave[axis], t_leave), last));
        }
        const auto* bytes = reinterpret_cast<const std::int32_t*>(cell.table);
        const Ints both = hn::And(hn::GatherOffset(di, bytes, first_block),
                                  hn::GatherOffset(di, bytes, last_block));
        const IntMask apart = hn::Eq(hn::And(both, hn::Set(di, 255)), hn::Zero(di));
        return bits_of(hn::And(passes, hn::RebindMask(df, apart)));
    }

    static HWY_INLINE std::uint64_t bits_of(FloatMask mask) {
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(FloatTag(), mask, bits);
        return (bits[0] | std::uint64_t{bits[1]} << 8) & kLaneBits;
    }

    shared::DagView dag_;
    Partitions& partitions_;
    int height_;
    RayLanes lanes_[kRaysPerBatch / kLanes];
    std::uint64_t open_ = 0;  // the group's rays that may meet something and are not proven to
    float slack_ = 0.0f;      // voxels
    std::array<Cell, kRemembered> remembered_;
    std::size_t count_found_ = 0;
    int credit_;  // of searches: rays that they found, beyond what they cost
    int groups_without_search_ = 0;
    int groups_to_skip_ = 0;
};

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
