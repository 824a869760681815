// SPDX-License-Identifier: MIT
//
// Any hit for rays that run close together, as those of neighbouring pixels to a lamp do: a shaft
// crosses empty space for all of them at once, and each ray is walked in those cells alone that the
// shaft finds. Compiled once for each SIMD target.
//
// A plane has one time, whichever way it is reached: so a ray that is walked in one cell, from the
// time when it enters to the time when it leaves, meets there what it meets on its way from the
// root. And the order in which its cells are looked into is free.
#if defined(OCTAVO_TRACE_WIDE_SHEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTAVO_TRACE_WIDE_SHEAF_INL_H
#undef OCTAVO_TRACE_WIDE_SHEAF_INL_H
#else
#define OCTAVO_TRACE_WIDE_SHEAF_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "octavo/trace/wide_batch-inl.h"
#include "octavo/trace/wide_shaft-inl.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

/// Rays that a cell of a shaft is looked into for.
struct SheafBatch {
    static constexpr std::size_t kSize = kRaysPerBatch + kLanes;
    static constexpr bool kStaysInCell = true;  // no ray goes above its node

    HWY_ALIGN std::int32_t cell[3][kSize];
    HWY_ALIGN float frac[3][kSize];
    HWY_ALIGN float inv_dir[3][kSize];
    HWY_ALIGN float t[kSize];
    HWY_ALIGN float t_end[kSize];
    HWY_ALIGN std::int32_t down[kSize];
    HWY_ALIGN std::int32_t ray[kSize];
    HWY_ALIGN std::int32_t corner[3][kSize];
    HWY_ALIGN std::int32_t height[kSize];
    HWY_ALIGN std::int32_t node[kSize];

    std::size_t count = 0;
};

/// Takes groups of kRaysPerBatch rays that follow each other, makes sheaves of them, and hands out
/// the parts of rays that lie in cells of their sheaf's shaft, until the ray has hit something or
/// there are no more cells. A sheaf's turn comes again after those of all others: by then most of
/// its rays have an answer.
class SheafReader {
public:
    static constexpr std::size_t kGroups = 32;

    /// @param dag   of a depth above least_depth()
    /// @param stop  without a cone
    SheafReader(shared::DagView dag, shared::Stop stop) : dag_(dag), least_(least_height(stop)) {}

    /// A DAG of at most this depth has nothing to share.
    [[nodiscard]] static int least_depth(shared::Stop stop) { return least_height(stop) + 2; }

    /// By some of the group, so that rays which spread are let go at little cost.
    [[nodiscard]] static bool run_alike(std::span<const shared::GridRay> rays) {
        if (rays.size() < kLanes) return false;
        const vec3 first = rays[0].dir;
        const vec3 size = glm::abs(first);
        const int a = size.x >= std::max(size.y, size.z) ? 0 : (size.y >= size.z ? 1 : 2);
        // The first few lie side by side in memory, and tell most spreading ones.
        for (std::size_t i = 0; i < rays.size(); i += i < 3 ? 1 : 7) {
            const vec3 dir = rays[i].dir;
            if (!(glm::dot(dir, first) > 0.0f) || !(dir[a] * first[a] > 0.0f)) return false;
            for (int axis = 0; axis < 3; ++axis)
                if (!(std::abs(dir[axis]) <= kSteepest * std::abs(dir[a]))) return false;
        }
        return true;
    }

    /// Forgets all rays. The next are rays first_ray to first_ray + kGroups * kRaysPerBatch.
    void begin(std::size_t first_ray) {
        first_ray_ = first_ray;
        sheaves_ = active_ = turn_ = 0;
        next_ = batch_.count = 0;
    }

    /// @param group  of rays in this range; the last of all may be shorter
    /// @return       false where they do not run close together, and are left to others
    bool add(std::span<const shared::GridRay> rays, std::size_t group) {
        const std::size_t first = first_ray_ + group * kRaysPerBatch;
        const std::size_t count = std::min(kRaysPerBatch, rays.size() - first);
        if (!run_alike(rays.subspan(first, count))) return false;
        if (sheaves_ + kMostSplits > kMostSheaves) return false;
        return read_group(rays, first, count, group);
    }

    [[nodiscard]] std::size_t available() {
        while (next_ == batch_.count && active_ > 0) read_batch();
        return batch_.count - next_;
    }
    std::size_t take(std::size_t count) {
        const std::size_t first = next_;
        next_ += count;
        return first;
    }
    [[nodiscard]] const SheafBatch& batch() const { return batch_; }

    /// This ray has hit something.
    HWY_INLINE void answer(std::int32_t ray) {
        const std::size_t slot = static_cast<std::size_t>(ray) - first_ray_;
        open_[slot / kRaysPerBatch] &= ~(std::uint64_t{1} << slot % kRaysPerBatch);
    }

private:
    static_assert(kRaysPerBatch == 64);
    static constexpr std::size_t kRays = kGroups * kRaysPerBatch;
    static constexpr std::size_t kMostSplits = 4;
    static constexpr std::size_t kMostSheaves = 2 * kGroups;
    static constexpr std::size_t kMostWaiting = 32;
    static constexpr std::size_t kSlots = kRaysPerBatch + kLanes;

    /// More than this many steps aside for one along the main axis is no sheaf.
    static constexpr float kSteepest = 4.0f;
    /// On the main axis: a smaller number comes near those that count as zero, and the ray would
    /// leave its line.
    static constexpr float kSlowest = 1e-10f;
    /// From the grid's corner; voxels.
    static constexpr float kFarthest = 1e9f;
    /// A sheaf is split where its halves have together less than this part of its width: there is a
    /// gap between them.
    static constexpr float kGap = 0.75f;
    /// Voxels; narrower sheaves are not split.
    static constexpr float kNarrow = 16.0f;

    struct Sheaf {
        std::size_t group;
        std::uint64_t rays;  // of the group
        ShaftWalk walk;
        int axis;
        bool rises;      // on this axis
        float near_end;  // where the last ray starts
        bool searched;   // to the end
        std::size_t count_waiting;
        std::array<ShaftCell, kMostWaiting> waiting;
    };

    /// What is known of a group's rays while its sheaves are made. `at`: where they cross the first
    /// and the last plane, on each of the other axes.
    struct Lines {
        HWY_ALIGN float at[2][2][kSlots];
        HWY_ALIGN float start[kSlots];
        int axis;
        float slack;
    };
    struct Bounds {
        float low[2][2], high[2][2];  // as Lines::at

        [[nodiscard]] float width(int plane, int k) const { return high[plane][k] - low[plane][k]; }
    };

    bool read_group(std::span<const shared::GridRay> rays, std::size_t first, std::size_t count,
                    std::size_t group) {
        const FloatTag df;
        const IntTag di;
        const vec3 size = glm::abs(rays[first].dir);
        const int a = size.x >= std::max(size.y, size.z) ? 0 : (size.y >= size.z ? 1 : 2);
        const int others[2] = {(a + 1) % 3, (a + 2) % 3};
        const std::size_t place = group * kRaysPerBatch;
        HWY_ALIGN float origin[3][kSlots];
        HWY_ALIGN float slope[2][kSlots];
        Lines lines;
        const Floats far = hn::Set(df, 1e30f);
        const Floats none = hn::Neg(far);
        const Floats sign = hn::Set(df, rays[first].dir[a] < 0.0f ? -1.0f : 1.0f);
        Floats low_z = far, high_z = none, distance = hn::Zero(df);
        FloatMask strays = hn::FirstN(df, 0);
        std::uint64_t open = 0;
        for (std::size_t i = 0; i < count; i += kLanes) {
            const RayLanes r = read_rays(dag_, rays, first + i, std::min(kLanes, count - i));
            for (int axis = 0; axis < 3; ++axis) {
                hn::StoreU(r.cell[axis], di, cell_[axis] + place + i);
                hn::StoreU(r.frac[axis], df, frac_[axis] + place + i);
                hn::StoreU(r.inv_dir[axis], df, inv_dir_[axis] + place + i);
                hn::Store(r.origin[axis], df, origin[axis] + i);
                distance = hn::Max(distance, hn::IfThenElseZero(r.live, hn::Abs(r.origin[axis])));
            }
            hn::StoreU(r.low, df, t_ + place + i);
            hn::StoreU(r.high, df, t_end_ + place + i);
            hn::StoreU(r.down, di, down_ + place + i);
            open |= bits_of(r.live) << i;
            FloatMask fits = hn::Gt(hn::Mul(r.dir[a], sign), hn::Set(df, kSlowest));
            const Floats start = hn::MulAdd(r.low, r.dir[a], r.origin[a]);
            const Floats end = hn::MulAdd(r.high, r.dir[a], r.origin[a]);
            hn::Store(start, df, lines.start + i);
            low_z = hn::Min(low_z, hn::IfThenElse(r.live, hn::Min(start, end), far));
            high_z = hn::Max(high_z, hn::IfThenElse(r.live, hn::Max(start, end), none));
            for (int k = 0; k < 2; ++k) {
                const Floats s = hn::IfThenElseZero(r.live, hn::Div(r.dir[others[k]], r.dir[a]));
                fits = hn::And(fits, hn::Le(hn::Abs(s), hn::Set(df, kSteepest)));
                hn::Store(s, df, slope[k] + i);
            }
            for (int axis = 0; axis < 3; ++axis)
                fits = hn::And(fits, hn::Lt(hn::Abs(r.origin[axis]), hn::Set(df, kFarthest)));
            strays = hn::Or(strays, hn::AndNot(fits, r.live));
        }
        open_[group] = open;
        if (open == 0) return true;
        ivec3 down;
        for (int axis = 0; axis < 3; ++axis) down[axis] = rays[first].dir[axis] < 0.0f;
        const float z[2] = {least_of(low_z), greatest_of(high_z)};
        const float reach = greatest_of(distance) + static_cast<float>(1 << dag_.depth);
        // Rays leave their lines by a third of this, by rounding, and so do the planes.
        lines.slack = 8e-6f * reach + 1e-3f;
        if (!hn::AllFalse(df, strays) || !(z[1] - z[0] > std::max(1.0f, lines.slack))) return false;
        lines.axis = a;
        for (int k = 0; k < 2; ++k)
            for (std::size_t i = 0; i < count; i += kLanes)
                for (int plane = 0; plane < 2; ++plane)
                    hn::Store(
                        hn::MulAdd(hn::Sub(hn::Set(df, z[plane]), hn::Load(df, origin[a] + i)),
                                   hn::Load(df, slope[k] + i), hn::Load(df, origin[others[k]] + i)),
                        df, lines.at[plane][k] + i);
        make_sheaves(lines, z, open, group, down, kMostSplits);
        return true;
    }

    /// One, or several where the rays lie in places apart.
    void make_sheaves(const Lines& lines, const float (&z)[2], std::uint64_t rays,
                      std::size_t group, const ivec3& down, std::size_t splits) {
        const Bounds all = bounds_of(lines, rays);
        int plane = 0, k = 0;
        for (int i = 1; i < 4; ++i)
            if (all.width(i / 2, i % 2) > all.width(plane, k)) plane = i / 2, k = i % 2;
        const float widest = all.width(plane, k);
        if (splits > 1 && std::popcount(rays) >= 8 && widest > kNarrow) {
            const std::uint64_t upper =
                beyond(lines.at[plane][k], all.low[plane][k] + 0.5f * widest, rays);
            const std::uint64_t lower = rays & ~upper;
            if (upper != 0 && lower != 0 &&
                bounds_of(lines, upper).width(plane, k) + bounds_of(lines, lower).width(plane, k) <
                    kGap * widest) {
                make_sheaves(lines, z, lower, group, down, splits / 2);
                make_sheaves(lines, z, upper, group, down, splits / 2);
                return;
            }
        }
        Shaft shaft;
        shaft.axis = lines.axis;
        shaft.down = down;
        const float length = z[1] - z[0];
        for (int i = 0; i < 2; ++i) {
            shaft.low[i] = all.low[0][i] - lines.slack;
            shaft.high[i] = all.high[0][i] + lines.slack;
            shaft.low_slope[i] = (all.low[1][i] - lines.slack - shaft.low[i]) / length;
            shaft.high_slope[i] = (all.high[1][i] + lines.slack - shaft.high[i]) / length;
        }
        shaft.low_z = z[0];
        shaft.first_z = z[0] - lines.slack;
        shaft.last_z = z[1] + lines.slack;
        Sheaf& sheaf = all_[sheaves_];
        sheaf.group = group;
        sheaf.rays = rays;
        sheaf.axis = lines.axis;
        sheaf.rises = down[lines.axis] == 0;
        sheaf.near_end = last_start(lines, rays, sheaf.rises);
        sheaf.searched = false;
        sheaf.count_waiting = 0;
        sheaf.walk.begin(dag_, shaft, least_);
        turns_[active_++] = static_cast<std::uint32_t>(sheaves_++);
    }

    Bounds bounds_of(const Lines& lines, std::uint64_t rays) const {
        const FloatTag df;
        const Floats far = hn::Set(df, 1e30f);
        Bounds b;
        for (int plane = 0; plane < 2; ++plane)
            for (int k = 0; k < 2; ++k) {
                Floats low = far, high = hn::Neg(far);
                for (std::size_t i = 0; i < kRaysPerBatch; i += kLanes) {
                    if ((rays >> i & kLaneBits) == 0) continue;
                    const FloatMask in = mask_of(rays >> i);
                    const Floats at = hn::Load(df, lines.at[plane][k] + i);
                    low = hn::Min(low, hn::IfThenElse(in, at, far));
                    high = hn::Max(high, hn::IfThenElse(in, at, hn::Neg(far)));
                }
                b.low[plane][k] = least_of(low);
                b.high[plane][k] = greatest_of(high);
            }
        return b;
    }
    float last_start(const Lines& lines, std::uint64_t rays, bool rises) const {
        const FloatTag df;
        const float sign = rises ? 1.0f : -1.0f;
        Floats last = hn::Set(df, -1e30f);
        for (std::size_t i = 0; i < kRaysPerBatch; i += kLanes) {
            if ((rays >> i & kLaneBits) == 0) continue;
            const Floats start = hn::Mul(hn::Load(df, lines.start + i), hn::Set(df, sign));
            last = hn::IfThenElse(mask_of(rays >> i), hn::Max(last, start), last);
        }
        return sign * greatest_of(last);
    }
    /// Those of these rays that are at more than `limit`.
    static std::uint64_t beyond(const float* at, float limit, std::uint64_t rays) {
        const FloatTag df;
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < kRaysPerBatch; i += kLanes)
            if ((rays >> i & kLaneBits) != 0)
                bits |= bits_of(hn::Gt(hn::Load(df, at + i), hn::Set(df, limit))) << i;
        return bits & rays;
    }

    static constexpr std::uint64_t kLaneBits = (std::uint64_t{1} << kLanes) - 1;
    static HWY_INLINE std::uint64_t bits_of(FloatMask mask) {
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(FloatTag(), mask, bits);
        return (bits[0] | std::uint64_t{bits[1]} << 8) & kLaneBits;
    }
    static HWY_INLINE FloatMask mask_of(std::uint64_t bits) {
        const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits & kLaneBits),
                                       static_cast<std::uint8_t>((bits & kLaneBits) >> 8)};
        return hn::LoadMaskBits(FloatTag(), bytes);
    }
    static int least_height(shared::Stop stop) { return std::max(3, stop.height + 1); }
    static float least_of(Floats v) { return hn::GetLane(hn::MinOfLanes(FloatTag(), v)); }
    static float greatest_of(Floats v) { return hn::GetLane(hn::MaxOfLanes(FloatTag(), v)); }

    /// Of one sheaf, the next cell's.
    void read_batch() {
        if (turn_ >= active_) turn_ = 0;
        Sheaf& sheaf = all_[turns_[turn_]];
        batch_.count = 0;
        next_ = 0;
        const std::uint64_t open = sheaf.rays & open_[sheaf.group];
        ShaftCell cell;
        if (open == 0 || !next_cell(sheaf, cell)) {
            turns_[turn_] = turns_[--active_];
            return;
        }
        for (std::size_t i = 0; i < kRaysPerBatch; i += kLanes)
            if ((open >> i & kLaneBits) != 0)
                read_vector(open >> i, sheaf.group * kRaysPerBatch + i, cell);
        if (batch_.count > 0) ++turn_;
    }

    /// Most rays that hit something hit a wall across their way, far from their start. So the cells
    /// that look like one come first, and those around the starts come last: few rays get there.
    bool next_cell(Sheaf& sheaf, ShaftCell& cell) {
        while (!sheaf.searched) {
            if (!sheaf.walk.next(dag_, cell)) {
                sheaf.searched = true;
                break;
            }
            if (sheaf.count_waiting == kMostWaiting || looks_closed(sheaf, cell)) return true;
            sheaf.waiting[sheaf.count_waiting++] = cell;
        }
        if (sheaf.count_waiting == 0) return false;
        cell = sheaf.waiting[--sheaf.count_waiting];
        return true;
    }
    /// Has it children side by side across the way, and does it lie beyond all starts?
    [[nodiscard]] bool looks_closed(const Sheaf& sheaf, const ShaftCell& cell) const {
        const int from = cell.corner[sheaf.axis];
        if (sheaf.rises ? static_cast<float>(from) <= sheaf.near_end
                        : static_cast<float>(from + (1 << cell.height)) >= sheaf.near_end)
            return false;
        constexpr std::uint32_t kLowHalf[3] = {0x55, 0x33, 0x0f};
        const std::uint32_t children = shared::dag_load(dag_, cell.node);
        const std::uint32_t columns = children | children >> (1 << sheaf.axis);
        return (columns & kLowHalf[sheaf.axis]) == kLowHalf[sheaf.axis];
    }

    /// @param open  rays of the vector that have an answer to come
    /// @param from  the vector's first ray, counted from first_ray_
    HWY_INLINE void read_vector(std::uint64_t open, std::size_t from, const ShaftCell& shaft_cell) {
        const FloatTag df;
        const IntTag di;
        const Ints down = hn::LoadU(di, down_ + from);
        const std::int32_t width = 1 << shaft_cell.height;
        const Ints far_side = hn::Set(di, (1 << dag_.depth) - width);
        Floats t = hn::LoadU(df, t_ + from);
        Floats t_end = hn::LoadU(df, t_end_ + from);
        Ints cell[3], corner[3];
        Floats frac[3], inv_dir[3];
        for (int axis = 0; axis < 3; ++axis) {
            cell[axis] = hn::LoadU(di, cell_[axis] + from);
            frac[axis] = hn::LoadU(df, frac_[axis] + from);
            inv_dir[axis] = hn::LoadU(df, inv_dir_[axis] + from);
            const Ints real = hn::Set(di, shaft_cell.corner[axis]);
            const IntMask falls = hn::TestBit(down, hn::Set(di, 1 << axis));
            corner[axis] = hn::IfThenElse(falls, hn::Sub(far_side, real), real);
            t = hn::Max(t, plane_time(corner[axis], cell[axis], frac[axis], inv_dir[axis]));
            t_end = hn::Min(t_end, plane_time(hn::Add(corner[axis], hn::Set(di, width)), cell[axis],
                                              frac[axis], inv_dir[axis]));
        }
        const FloatMask passes = hn::And(mask_of(open), hn::Lt(t, t_end));
        if (hn::AllFalse(df, passes)) return;
        const IntMask take = hn::RebindMask(di, passes);
        const Ints half = hn::Set(di, width / 2);
        const std::size_t n = batch_.count;
        for (int axis = 0; axis < 3; ++axis) {
            const Floats middle =
                plane_time(hn::Add(corner[axis], half), cell[axis], frac[axis], inv_dir[axis]);
            const IntMask high = hn::RebindMask(di, hn::Le(middle, t));
            hn::CompressStore(hn::Add(corner[axis], hn::IfThenElseZero(high, half)), take, di,
                              batch_.corner[axis] + n);
            hn::CompressStore(cell[axis], take, di, batch_.cell[axis] + n);
            hn::CompressStore(frac[axis], passes, df, batch_.frac[axis] + n);
            hn::CompressStore(inv_dir[axis], passes, df, batch_.inv_dir[axis] + n);
        }
        hn::CompressStore(t, passes, df, batch_.t + n);
        hn::CompressStore(t_end, passes, df, batch_.t_end + n);
        hn::CompressStore(down, take, di, batch_.down + n);
        hn::StoreU(hn::Set(di, shaft_cell.height - 1), di, batch_.height + n);
        hn::StoreU(hn::Set(di, static_cast<std::int32_t>(shaft_cell.node)), di, batch_.node + n);
        const Ints ray = hn::Add(hn::Iota(di, 0), hn::Set(di, static_cast<int>(first_ray_ + from)));
        batch_.count = n + hn::CompressStore(ray, take, di, batch_.ray + n);
    }

    shared::DagView dag_;
    int least_;
    std::size_t first_ray_ = 0;
    std::size_t sheaves_ = 0;
    std::size_t active_ = 0;
    std::size_t turn_ = 0;
    std::size_t next_ = 0;
    std::array<std::uint32_t, kMostSheaves> turns_;
    std::array<Sheaf, kMostSheaves> all_;
    std::array<std::uint64_t, kGroups> open_;  // rays without an answer

    // Of all rays, mirrored.
    HWY_ALIGN std::int32_t cell_[3][kRays + kLanes];
    HWY_ALIGN float frac_[3][kRays + kLanes];
    HWY_ALIGN float inv_dir_[3][kRays + kLanes];
    HWY_ALIGN float t_[kRays + kLanes];
    HWY_ALIGN float t_end_[kRays + kLanes];
    HWY_ALIGN std::int32_t down_[kRays + kLanes];
    SheafBatch batch_;
};

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
