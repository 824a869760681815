// SPDX-License-Identifier: MIT
#include "octavo/trace/wide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octavo/trace/wide.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#include "octavo/trace/wide_batch-inl.h"
#include "octavo/trace/wide_beam-inl.h"
#include "octavo/trace/wide_sheaf-inl.h"
#include "octavo/trace/wide_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

/// Keeps some vectors of rays in flight, so that one computes while the others wait for memory.
template <bool kCone, bool kPrefetch, std::size_t... kVectors, class Reader, class Results>
HWY_INLINE void walk_with(std::index_sequence<kVectors...> /*vectors*/, shared::DagView dag,
                          Reader& reader, shared::Stop stop, Results& results) {
    std::array walks{((void)kVectors, Walk<kCone, kPrefetch>(dag, stop))...};
    while (true) {
        bool more = false;
        for (auto& walk : walks) more = walk.refill(reader) || more || !walk.idle();
        if (!more) return;
        for (auto& walk : walks) walk.step(results);
    }
}

template <bool kCone, class Reader, class Results>
HWY_INLINE void walk_all(shared::DagView dag, bool far_nodes, Reader& reader, shared::Stop stop,
                         Results& results) {
    if (far_nodes)
        walk_with<kCone, true>(std::make_index_sequence<4>(), dag, reader, stop, results);
    else
        walk_with<kCone, false>(std::make_index_sequence<2>(), dag, reader, stop, results);
}

/// Marks the rays that hit something.
struct AnyResults {
    std::uint8_t* occluded;

    HWY_INLINE void add(const HitLanes& lanes) {
        HWY_ALIGN std::int32_t ray[kLanes];
        const std::size_t count = hn::CompressStore(lanes.ray, lanes.hit, IntTag(), ray);
        for (std::size_t i = 0; i < count; ++i) occluded[ray[i]] = 1;
    }
};

/// shared::make_hit() for a vector of rays.
struct ClosestResults {
    int depth;
    shared::GridHit* hits;

    HWY_INLINE void add(const HitLanes& lanes) {
        const FloatTag df;
        const IntTag di;
        const Ints one = hn::Set(di, 1);
        const Floats x = lanes.entry[0], y = lanes.entry[1], z = lanes.entry[2];
        const Ints y_or_z = hn::IfThenElse(hn::RebindMask(di, hn::Ge(y, z)), one, hn::Set(di, 2));
        const Ints axis = hn::IfThenZeroElse(hn::RebindMask(di, hn::Ge(x, hn::Max(y, z))), y_or_z);
        const Ints falls = hn::And(hn::Shr(lanes.down, axis), one);
        const IntMask inside = hn::RebindMask(di, hn::Lt(max3(x, y, z), lanes.t));
        const Ints face = hn::IfThenElse(inside, hn::Set(di, shared::kFaceInside),
                                         hn::Add(hn::Add(axis, axis), falls));
        const Ints last = hn::Sub(hn::Shl(one, hn::Sub(hn::Set(di, depth), lanes.height)), one);

        HWY_ALIGN std::int32_t ray[kLanes], path[3][kLanes], height[kLanes], faces[kLanes];
        HWY_ALIGN float t[kLanes];
        for (int a = 0; a < 3; ++a) {
            const Ints bit = hn::Set(di, 1 << a);
            const IntMask down = hn::TestBit(lanes.down, bit);
            const Ints real =
                hn::Xor(hn::Shr(lanes.corner[a], lanes.height), hn::IfThenElseZero(down, last));
            hn::CompressStore(real, lanes.hit, di, path[a]);
        }
        hn::CompressStore(lanes.height, lanes.hit, di, height);
        hn::CompressStore(face, lanes.hit, di, faces);
        hn::CompressStore(lanes.t, hn::RebindMask(df, lanes.hit), df, t);
        const std::size_t count = hn::CompressStore(lanes.ray, lanes.hit, di, ray);
        for (std::size_t i = 0; i < count; ++i)
            hits[ray[i]] = {t[i], uvec3(path[0][i], path[1][i], path[2][i]), height[i], faces[i],
                            0};
    }
};

void TraceClosest(shared::DagView dag, bool far_nodes, std::span<const shared::GridRay> rays,
                  shared::Stop stop, shared::GridHit* hits) {
    ClosestResults results{dag.depth, hits};
    BatchReader reader(dag, rays, stop);
    if (stop.cone > 0.0f)
        walk_all<true>(dag, far_nodes, reader, stop, results);
    else
        walk_all<false>(dag, far_nodes, reader, stop, results);
}

/// Each by itself, with no more in common than the smallest node that holds the starts.
template <bool kCone>
HWY_NOINLINE void trace_any_alone(shared::DagView dag, bool far_nodes,
                                  std::span<const shared::GridRay> rays, shared::Stop stop,
                                  std::uint8_t* occluded) {
    AnyResults results{occluded};
    BatchReader reader(dag, rays, stop);
    walk_all<kCone>(dag, far_nodes, reader, stop, results);
}

/// Marks the rays that hit something, and tells the reader.
struct SheafResults {
    SheafReader& reader;
    std::uint8_t* occluded;

    HWY_INLINE void add(const HitLanes& lanes) {
        HWY_ALIGN std::int32_t ray[kLanes];
        const std::size_t count = hn::CompressStore(lanes.ray, lanes.hit, IntTag(), ray);
        for (std::size_t i = 0; i < count; ++i) {
            occluded[ray[i]] = 1;
            reader.answer(ray[i]);
        }
    }
};

/// In sheaves where rays run close together, alone where they do not.
void TraceAnyInSheaves(shared::DagView dag, bool far_nodes, std::span<const shared::GridRay> rays,
                       shared::Stop stop, std::uint8_t* occluded) {
    SheafReader reader(dag, stop);
    SheafResults results{reader, occluded};
    std::size_t alone = 0;  // the first ray that is in no sheaf and still to be traced
    const auto trace_alone = [&](std::size_t end) {
        if (alone < end)
            trace_any_alone<false>(dag, far_nodes, rays.subspan(alone, end - alone), stop,
                                   occluded + alone);
    };
    constexpr std::size_t kStretch = SheafReader::kGroups * kRaysPerBatch;
    for (std::size_t first = 0; first < rays.size(); first += kStretch) {
        const std::size_t end = std::min(first + kStretch, rays.size());
        reader.begin(first);
        for (std::size_t next = first; next < end; next += kRaysPerBatch) {
            if (!reader.add(rays, (next - first) / kRaysPerBatch)) continue;
            trace_alone(next);
            alone = std::min(next + kRaysPerBatch, end);
        }
        walk_all<false>(dag, far_nodes, reader, stop, results);
    }
    trace_alone(rays.size());
}

/// @return  do the first rays run close together?
bool TraceAny(shared::DagView dag, bool far_nodes, bool sheaves,
              std::span<const shared::GridRay> rays, shared::Stop stop, std::uint8_t* occluded) {
    const bool alike = SheafReader::run_alike(rays.first(std::min(kRaysPerBatch, rays.size())));
    if (stop.cone > 0.0f)
        trace_any_alone<true>(dag, far_nodes, rays, stop, occluded);
    else if (sheaves && alike && dag.depth > SheafReader::least_depth(stop))
        TraceAnyInSheaves(dag, far_nodes, rays, stop, occluded);
    else
        trace_any_alone<false>(dag, far_nodes, rays, stop, occluded);
    return alike;
}

float BeamStart(shared::DagView dag, const shared::Bundle& beam, shared::Stop stop) {
    return BeamWalk(dag, beam, stop).start();
}

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octavo {
namespace {

/// Below a leaf's depth there are no nodes to walk, a root that may be a hit needs no walk, and
/// gathers count words in 31 bits: for all these the shared text is fast enough.
bool fits_lanes(const Dag& dag, const shared::Stop& stop) {
    return dag.depth() >= 3 && stop.height < dag.depth() && dag.words().size() < (1u << 31);
}

/// Measured with 2 MB of cache for each core: 12 and 30 MB were faster as near, 386 MB as far.
bool far_nodes(const Dag& dag, WideWalk walk) {
    constexpr std::uint64_t kNearBytes = std::uint64_t{64} << 20;
    return walk == WideWalk::by_size ? dag.size_bytes() > kNearBytes : walk == WideWalk::far_nodes;
}

/// Where space is crowded, shafts find nothing to cross. Words for each square of voxels of a face
/// of the grid, at 4096^3: courtyard 0.2, scan 0.4, hairball 6.
bool is_crowded(const Dag& dag) {
    return dag.words().size() > 2 * (std::uint64_t{dag.resolution()} * dag.resolution());
}

/// Rays that meet nothing have to pass all cells of their shaft: where they are many, it costs more
/// than it saves. The rays that this thread traced last are the nearest thing to know it by.
constexpr double kMostlyOccluded = 0.7;
thread_local bool last_were_occluded = true;

/// Vectors and the shared text choose differently between a number and what is none.
bool is_finite(const shared::Bundle& beam) {
    const auto finite = [](const vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    return finite(beam.frac) && finite(beam.dir_low) && finite(beam.dir_high) &&
           !std::isnan(beam.t_min) && !std::isnan(beam.t_max);
}

}  // namespace

HWY_EXPORT(TraceClosest);
HWY_EXPORT(TraceAny);
HWY_EXPORT(BeamStart);

float beam_start_wide(const Dag& dag, const shared::Bundle& beam, shared::Stop stop) noexcept {
    const shared::DagView view = shared::view(dag);
    const bool mixed = glm::any(glm::notEqual(glm::lessThan(beam.dir_low, vec3(0.0f)),
                                              glm::lessThan(beam.dir_high, vec3(0.0f))));
    if (mixed || view.depth == 0 || !is_finite(beam)) return beam_start(view, beam, stop);
    return HWY_DYNAMIC_DISPATCH(BeamStart)(view, beam, stop);
}

void trace_closest_wide(const Dag& dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                        std::span<shared::GridHit> hits, WideWalk walk) noexcept {
    const shared::DagView view = shared::view(dag);
    if (!fits_lanes(dag, stop)) {
        for (std::size_t i = 0; i < rays.size(); ++i)
            hits[i] = shared::trace_closest(view, rays[i], stop);
        return;
    }
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = shared::make_miss(rays[i].t_max, 0);
    if (!dag.empty())
        HWY_DYNAMIC_DISPATCH(TraceClosest)(view, far_nodes(dag, walk), rays, stop, hits.data());
}

void trace_any_wide(const Dag& dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                    std::span<std::uint8_t> occluded, WideWalk walk, Sheaves sheaves) noexcept {
    const shared::DagView view = shared::view(dag);
    if (!fits_lanes(dag, stop)) {
        for (std::size_t i = 0; i < rays.size(); ++i)
            occluded[i] = shared::trace_any(view, rays[i], stop) ? 1 : 0;
        return;
    }
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    if (dag.empty() || rays.empty()) return;
    const bool try_sheaves = sheaves == Sheaves::always || (!is_crowded(dag) && last_were_occluded);
    const bool alike = HWY_DYNAMIC_DISPATCH(TraceAny)(view, far_nodes(dag, walk), try_sheaves, rays,
                                                      stop, occluded.data());
    if (alike && sheaves == Sheaves::where_they_pay)
        last_were_occluded =
            static_cast<double>(std::count(occluded.begin(), occluded.end(), std::uint8_t{1})) >
            kMostlyOccluded * static_cast<double>(rays.size());
}

}  // namespace octavo
#endif
