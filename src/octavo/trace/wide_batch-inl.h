// SPDX-License-Identifier: MIT
//
// Sets rays up for the vector walk, a batch at a time: mirrored, clipped to the grid, those that
// miss the grid left out, and placed in the smallest cell that holds the starts of all of them.
// Compiled once for each SIMD target.
#if defined(OCTAVO_TRACE_WIDE_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTAVO_TRACE_WIDE_BATCH_INL_H
#undef OCTAVO_TRACE_WIDE_BATCH_INL_H
#else
#define OCTAVO_TRACE_WIDE_BATCH_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "octavo/trace/wide.h"
#include "octavo/trace/wide_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

HWY_INLINE Floats max3(Floats x, Floats y, Floats z) {
    return hn::Max(x, hn::Max(y, z));
}
HWY_INLINE Floats min3(Floats x, Floats y, Floats z) {
    return hn::Min(x, hn::Min(y, z));
}

/// shared::plane_time() on one axis of many rays.
HWY_INLINE Floats plane_time(Ints plane, Ints cell, Floats frac, Floats inv_dir) {
    return hn::Mul(hn::Sub(hn::ConvertTo(FloatTag(), hn::Sub(plane, cell)), frac), inv_dir);
}

/// A vector of rays, mirrored as by shared::mirror_ray() and clipped to the grid.
struct RayLanes {
    Ints cell[3];
    Floats frac[3];
    Floats inv_dir[3];
    Floats low;  // the times in the grid
    Floats high;
    Ints down;         // a child number: the axes that are mirrored
    FloatMask live;    // the others miss the grid
    Floats origin[3];  // real, to float's precision
    Floats dir[3];     // real
};

/// Rays first to first + count.
HWY_INLINE RayLanes read_rays(shared::DagView dag, std::span<const shared::GridRay> rays,
                              std::size_t first, std::size_t count) {
    static_assert(sizeof(shared::GridRay) == 44 && offsetof(shared::GridRay, t_max) == 40);
    constexpr int kRayWords = sizeof(shared::GridRay) / 4;
    const FloatTag df;
    const IntTag di;
    const float* words = &rays[first].frac.x - 3;
    const auto* whole = reinterpret_cast<const std::int32_t*>(&rays[first].cell.x);
    const Ints lane = hn::Iota(di, 0);
    const Ints at =
        hn::Mul(hn::Min(lane, hn::Set(di, static_cast<int>(count) - 1)), hn::Set(di, kRayWords));

    RayLanes r;
    r.low = hn::GatherIndex(df, words + 9, at);
    r.high = hn::GatherIndex(df, words + 10, at);
    r.down = hn::Zero(di);
    Floats entry[3], leave[3];
    for (int axis = 0; axis < 3; ++axis) {
        const Ints real = hn::GatherIndex(di, whole + axis, at);
        const Floats part = hn::GatherIndex(df, words + 3 + axis, at);
        const Floats dir = hn::GatherIndex(df, words + 6 + axis, at);
        const FloatMask falls = hn::Lt(dir, hn::Zero(df));
        const IntMask falls_int = hn::RebindMask(di, falls);
        const Ints side = hn::Set(di, 1 << dag.depth);
        r.cell[axis] = hn::IfThenElse(falls_int, hn::Sub(side, real), real);
        r.frac[axis] = hn::IfThenElse(falls, hn::Neg(part), part);
        r.inv_dir[axis] = hn::Div(hn::Set(df, 1.0f), hn::Max(hn::Abs(dir), hn::Set(df, 1e-20f)));
        r.down = hn::Or(r.down, hn::IfThenElseZero(falls_int, hn::Set(di, 1 << axis)));
        entry[axis] = plane_time(hn::Zero(di), r.cell[axis], r.frac[axis], r.inv_dir[axis]);
        leave[axis] = plane_time(side, r.cell[axis], r.frac[axis], r.inv_dir[axis]);
        r.origin[axis] = hn::Add(hn::ConvertTo(df, real), part);
        r.dir[axis] = dir;
    }
    // Where one is not a number, Max and Min give their second: the ray then misses.
    r.low = hn::Max(max3(entry[0], entry[1], entry[2]), r.low);
    r.high = hn::Min(min3(leave[0], leave[1], leave[2]), r.high);
    r.live = hn::And(hn::Lt(r.low, r.high), hn::FirstN(df, count));
    return r;
}

/// An array for each number, and room for a vector after the last.
struct Batch {
    static constexpr std::size_t kSize = kRaysPerBatch + kLanes;

    HWY_ALIGN std::int32_t cell[3][kSize];
    HWY_ALIGN float frac[3][kSize];
    HWY_ALIGN float inv_dir[3][kSize];
    HWY_ALIGN float t[kSize];
    HWY_ALIGN float t_end[kSize];
    HWY_ALIGN std::int32_t down[kSize];  // a child number: the axes that are mirrored
    HWY_ALIGN std::int32_t ray[kSize];
    HWY_ALIGN std::int32_t start[3][kSize];  // a real voxel

    // The cell that the ray starts in, one below the node that holds the batch, or below the root.
    HWY_ALIGN std::int32_t corner[3][kSize];
    HWY_ALIGN std::int32_t height[kSize];
    HWY_ALIGN std::int32_t node[kSize];  // its parent

    std::size_t count = 0;
    int top = 0;                        // height of the node that holds the batch
    std::int32_t nodes[kMaxDepth + 1];  // by height, from the root to `top`
};

/// Leaves no ray of a batch out, and has nothing to ask for.
struct AllRays {
    std::uint64_t without(std::size_t /*first*/, std::span<const shared::GridRay> /*some*/) {
        return 0;
    }
    void soon(std::size_t /*first*/, std::size_t /*count*/) {}
};

/// Hands out rays in batches.
///
/// The rays of the next batch are asked for as those of this one are taken. All at once would be
/// more than a core can wait for, and none would make it wait for each.
///
/// @tparam Filter  without(first, some) has a bit for each ray of a batch, the first one's number
///                 being `first`, that need not be traced; soon(first, count) may ask for what it
///                 will write of these rays
template <class Filter>
class BatchReader {
public:
    BatchReader(shared::DagView dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                Filter& filter)
        : dag_(dag), rays_(rays), stop_(stop), filter_(filter) {}

    /// Rays of the batch that are still to be taken; makes the next batch where there are none.
    [[nodiscard]] std::size_t available() {
        while (next_ == batch_.count && next_ray_ < rays_.size()) read_batch();
        return batch_.count - next_;
    }
    /// The place in batch() of the next ray, and takes this many.
    std::size_t take(std::size_t count) {
        const std::size_t first = next_;
        next_ += count;
        const std::size_t soon = next_ray_ + first;
        if (soon + count <= rays_.size()) {
            prefetch(rays_.subspan(soon, count));
            filter_.soon(soon, count);
        }
        return first;
    }
    [[nodiscard]] const Batch& batch() const { return batch_; }

private:
    void read_batch() {
        const std::size_t count = std::min(kRaysPerBatch, rays_.size() - next_ray_);
        const std::uint64_t without = filter_.without(next_ray_, rays_.subspan(next_ray_, count));
        batch_.count = 0;
        next_ = 0;
        for (std::size_t i = 0; i < count; i += kLanes) {
            const std::uint64_t wanted = ~(without >> i) & kLaneBits;
            if (wanted != 0) read_vector(next_ray_ + i, std::min(kLanes, count - i), wanted);
        }
        next_ray_ += count;
        if (batch_.count > 0) place();
    }

    void read_vector(std::size_t first, std::size_t count, std::uint64_t wanted) {
        const FloatTag df;
        const IntTag di;
        const RayLanes rays = read_rays(dag_, rays_, first, count);
        const std::uint8_t bits[8] = {static_cast<std::uint8_t>(wanted),
                                      static_cast<std::uint8_t>(wanted >> 8)};
        const FloatMask live = hn::And(rays.live, hn::LoadMaskBits(df, bits));
        const IntMask live_int = hn::RebindMask(di, live);
        const std::size_t n = batch_.count;
        const Ints ray = hn::Add(hn::Iota(di, 0), hn::Set(di, static_cast<int>(first)));
        const Ints start[3] = {start_voxel(rays, 0), start_voxel(rays, 1), start_voxel(rays, 2)};
        const auto store = [&](const auto& keep_ints, const auto& keep_floats) {
            for (int axis = 0; axis < 3; ++axis) {
                keep_ints(rays.cell[axis], batch_.cell[axis] + n);
                keep_ints(start[axis], batch_.start[axis] + n);
                keep_floats(rays.frac[axis], batch_.frac[axis] + n);
                keep_floats(rays.inv_dir[axis], batch_.inv_dir[axis] + n);
            }
            keep_floats(rays.low, batch_.t + n);
            keep_floats(rays.high, batch_.t_end + n);
            keep_ints(rays.down, batch_.down + n);
            keep_ints(ray, batch_.ray + n);
        };
        // Nearly always all of them: a store that leaves some out takes several times as long.
        if (hn::AllTrue(di, live_int))
            store([&](Ints from, std::int32_t* to) { hn::StoreU(from, di, to); },
                  [&](Floats from, float* to) { hn::StoreU(from, df, to); });
        else
            store([&](Ints from, std::int32_t* to) { hn::CompressStore(from, live_int, di, to); },
                  [&](Floats from, float* to) { hn::CompressStore(from, live, df, to); });
        batch_.count = n + hn::CountTrue(di, live_int);
    }

    /// The real voxel that each ray is in when it starts: nearly always, see place().
    HWY_INLINE Ints start_voxel(const RayLanes& rays, int axis) const {
        const IntTag di;
        const Floats way = hn::Mul(rays.low, hn::Abs(rays.dir[axis]));
        const Floats offset = hn::Floor(hn::Add(rays.frac[axis], way));
        const Ints last = hn::Set(di, (1 << dag_.depth) - 1);
        const Ints up = hn::Add(rays.cell[axis], hn::ConvertTo(di, offset));
        const Ints inside = hn::Min(hn::Max(up, hn::Zero(di)), last);
        return xor_where(has_any(rays.down, hn::Set(di, 1 << axis)), inside, last);
    }
    /// All bits where the axis is mirrored.
    HWY_INLINE Ints is_down(std::size_t i, int axis) const {
        const IntTag di;
        const Ints bit = hn::Set(di, 1 << axis);
        return hn::VecFromMask(di, hn::Eq(hn::And(hn::Load(di, batch_.down + i), bit), bit));
    }

    /// Finds the node that holds all starts, and the first cell of each ray in it. Rounding may put
    /// a ray outside after all: it then starts at the root.
    void place() {
        const FloatTag df;
        const IntTag di;
        Ints differ = hn::Zero(di);
        ivec3 first;
        float latest = batch_.t[0];
        for (int axis = 0; axis < 3; ++axis) {
            first[axis] = batch_.start[axis][0];
            for (std::size_t i = 0; i < batch_.count; i += kLanes) {
                const Ints other =
                    hn::Xor(hn::Load(di, batch_.start[axis] + i), hn::Set(di, first[axis]));
                const IntMask in = hn::RebindMask(di, hn::FirstN(df, batch_.count - i));
                differ = hn::Or(differ, hn::IfThenElseZero(in, other));
            }
        }
        if (stop_.cone > 0.0f)
            for (std::size_t i = 1; i < batch_.count; ++i) latest = std::max(latest, batch_.t[i]);
        HWY_ALIGN std::int32_t differ_lanes[kLanes];
        hn::Store(differ, di, differ_lanes);
        std::uint32_t any = 0;
        for (const std::int32_t d : differ_lanes) any |= static_cast<std::uint32_t>(d);
        descend(first, std::bit_width(any), latest);

        for (std::size_t i = 0; i < batch_.count; i += kLanes) {
            const Floats t = hn::Load(df, batch_.t + i);
            const Ints width = hn::Set(di, 1 << batch_.top);
            Ints corner[3];
            FloatMask inside = hn::FirstN(df, batch_.count - i);
            for (int axis = 0; axis < 3; ++axis) {
                const Ints last = hn::Set(di, (1 << dag_.depth) - 1);
                const Ints up = hn::Xor(hn::Set(di, first[axis]), hn::And(last, is_down(i, axis)));
                corner[axis] = hn::And(up, hn::Set(di, -(1 << batch_.top)));
                inside = hn::And(inside, hn::Le(time(corner[axis], i, axis), t));
                inside = hn::And(inside, hn::Gt(time(hn::Add(corner[axis], width), i, axis), t));
            }
            const IntMask in = hn::RebindMask(di, inside);
            const Ints child =
                hn::IfThenElse(in, hn::Set(di, batch_.top - 1), hn::Set(di, dag_.depth - 1));
            const Ints half = hn::Shl(hn::Set(di, 1), child);
            for (int axis = 0; axis < 3; ++axis) {
                const Ints low = hn::IfThenElseZero(in, corner[axis]);
                const IntMask high =
                    hn::RebindMask(di, hn::Le(time(hn::Add(low, half), i, axis), t));
                hn::Store(hn::Add(low, hn::IfThenElseZero(high, half)), di,
                          batch_.corner[axis] + i);
            }
            hn::Store(child, di, batch_.height + i);
            hn::Store(hn::IfThenElseZero(in, hn::Set(di, batch_.nodes[batch_.top])), di,
                      batch_.node + i);
        }
    }

    HWY_INLINE Floats time(Ints plane, std::size_t i, int axis) const {
        return plane_time(plane, hn::Load(IntTag(), batch_.cell[axis] + i),
                          hn::Load(FloatTag(), batch_.frac[axis] + i),
                          hn::Load(FloatTag(), batch_.inv_dir[axis] + i));
    }

    /// From the root towards a cell, while nodes exist, are this high or higher, and no ray of the
    /// batch may stop at them.
    void descend(const ivec3& cell, int least, float latest) {
        int height = dag_.depth;
        std::uint32_t node = 0;
        batch_.nodes[height] = 0;
        while (height > std::max({least, 3, stop_.height + 1})) {
            // Rounded up, for times that differ from the ray's own in the last bits.
            const float stops_below = (stop_.time_before + latest) * stop_.cone * 1.001f;
            if (!(static_cast<float>(1 << (height - 1)) > stops_below)) break;
            const int child = shared::child_number((cell >> (height - 1)) & 1);
            if ((shared::dag_load(dag_, node) & (1u << child)) == 0) break;
            node = shared::load_child(dag_, node, child);
            --height;
            batch_.nodes[height] = static_cast<std::int32_t>(node);
        }
        batch_.top = height;
    }

    shared::DagView dag_;
    std::span<const shared::GridRay> rays_;
    shared::Stop stop_;
    Filter& filter_;
    std::size_t next_ray_ = 0;
    std::size_t next_ = 0;
    Batch batch_;
};

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
