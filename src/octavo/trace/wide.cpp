// SPDX-License-Identifier: MIT
#include "octavo/trace/wide.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octavo/trace/wide.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#include "octavo/trace/partitions.h"
#include "octavo/trace/wide_batch-inl.h"
#include "octavo/trace/wide_beam-inl.h"
#include "octavo/trace/wide_proof-inl.h"
#include "octavo/trace/wide_walk-inl.h"

#ifndef OCTAVO_TRACE_WIDE_TYPES
#define OCTAVO_TRACE_WIDE_TYPES
namespace octavo {

/// What rays are traced through, and how.
struct WideTrace {
    shared::DagView dag;
    shared::Stop stop;
    bool far_nodes;  // see WideWalk
};

}  // namespace octavo
#endif

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

/// Keeps some vectors of rays in flight, so that one computes while the others wait for memory.
template <bool kCone, bool kPrefetch, std::size_t... kVectors, class Reader, class Results>
HWY_INLINE void walk_with(std::index_sequence<kVectors...> /*vectors*/, const WideTrace& trace,
                          Reader& reader, Results& results) {
    std::array walks{((void)kVectors, Walk<kCone, kPrefetch>(trace.dag, trace.stop))...};
    while (true) {
        bool more = false;
        for (auto& walk : walks) more = walk.refill(reader, results) || more || !walk.idle();
        if (!more) break;
        for (auto& walk : walks)
            if (!walk.idle()) walk.step();
    }
    for (auto& walk : walks) walk.tell(results);
}

template <bool kCone, class Reader, class Results>
HWY_INLINE void walk_all(const WideTrace& trace, Reader& reader, Results& results) {
    if (trace.far_nodes)
        walk_with<kCone, true>(std::make_index_sequence<8>(), trace, reader, results);
    else
        walk_with<kCone, false>(std::make_index_sequence<2>(), trace, reader, results);
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

/// Leaves no ray out, and lets each miss until it is known to hit.
struct Misses {
    std::span<shared::GridHit> hits;

    std::uint64_t without(std::size_t first, std::span<const shared::GridRay> some) {
        for (std::size_t i = 0; i < some.size(); ++i)
            hits[first + i] = shared::make_miss(some[i].t_max, 0);
        return 0;
    }
    void soon(std::size_t first, std::size_t count) { prefetch(hits.subspan(first, count)); }
};

void TraceClosest(const WideTrace& trace, std::span<const shared::GridRay> rays,
                  std::span<shared::GridHit> hits) {
    ClosestResults results{trace.dag.depth, hits.data()};
    Misses misses{hits};
    BatchReader reader(trace.dag, rays, trace.stop, misses);
    if (trace.stop.cone > 0.0f)
        walk_all<true>(trace, reader, results);
    else
        walk_all<false>(trace, reader, results);
}

template <bool kCone, class Filter>
HWY_NOINLINE void trace_any_without(Filter& filter, const WideTrace& trace,
                                    std::span<const shared::GridRay> rays, std::uint8_t* occluded) {
    AnyResults results{occluded};
    BatchReader reader(trace.dag, rays, trace.stop, filter);
    walk_all<kCone>(trace, reader, results);
}

/// Leaves those out that partitions show to be occluded.
struct Unproven {
    Prover& prover;
    std::uint8_t* occluded;

    void soon(std::size_t /*first*/, std::size_t /*count*/) {}
    std::uint64_t without(std::size_t first, std::span<const shared::GridRay> some) {
        const std::uint64_t proven = prover.occluded(some);
        for (std::uint64_t rest = proven; rest != 0; rest &= rest - 1)
            occluded[first + static_cast<std::size_t>(std::countr_zero(rest))] = 1;
        return proven;
    }
};

template <bool kCone>
void trace_any_of(const WideTrace& trace, Partitions* partitions,
                  std::span<const shared::GridRay> rays, std::uint8_t* occluded) {
    if (partitions != nullptr &&
        Prover::run_alike(rays.first(std::min(kRaysPerBatch, rays.size())))) {
        Prover prover(trace.dag, *partitions);
        Unproven unproven{prover, occluded};
        trace_any_without<kCone>(unproven, trace, rays, occluded);
    } else {
        AllRays all;
        trace_any_without<kCone>(all, trace, rays, occluded);
    }
}

void TraceAny(const WideTrace& trace, Partitions* partitions, std::span<const shared::GridRay> rays,
              std::uint8_t* occluded) {
    if (trace.stop.cone > 0.0f)
        trace_any_of<true>(trace, partitions, rays, occluded);
    else
        trace_any_of<false>(trace, partitions, rays, occluded);
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
bool in_lanes(const Dag& dag, const shared::Stop& stop, WideWalk walk) {
    return walk != WideWalk::one_by_one && dag.depth() >= 3 && stop.height < dag.depth() &&
           dag.words().size() < (1u << 31);
}

/// Whether a DAG is walked as far: measured with 2 MB of cache for each core, see docs/adr/0051.
bool far_nodes(const Dag& dag, WideWalk walk, std::uint64_t near_bytes) {
    return walk == WideWalk::by_size ? dag.size_bytes() > near_bytes : walk == WideWalk::far_nodes;
}
constexpr std::uint64_t kNearToClosest = std::uint64_t{8} << 20;
constexpr std::uint64_t kNearToAny = std::uint64_t{20} << 20;

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

float beam_start_wide(const Dag& dag, const shared::Bundle& beam, shared::Stop stop,
                      WideWalk walk) noexcept {
    const shared::DagView view = shared::view(dag);
    const bool mixed = glm::any(glm::notEqual(glm::lessThan(beam.dir_low, vec3(0.0f)),
                                              glm::lessThan(beam.dir_high, vec3(0.0f))));
    if (walk == WideWalk::one_by_one || mixed || view.depth == 0 || !is_finite(beam))
        return beam_start(view, beam, stop);
    return HWY_DYNAMIC_DISPATCH(BeamStart)(view, beam, stop);
}

void trace_closest_wide(const Dag& dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                        std::span<shared::GridHit> hits, WideWalk walk) noexcept {
    const shared::DagView view = shared::view(dag);
    if (!in_lanes(dag, stop, walk)) {
        for (std::size_t i = 0; i < rays.size(); ++i)
            hits[i] = shared::trace_closest(view, rays[i], stop);
        return;
    }
    if (dag.empty()) {
        for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = shared::make_miss(rays[i].t_max, 0);
        return;
    }
    HWY_DYNAMIC_DISPATCH(TraceClosest)
    ({view, stop, far_nodes(dag, walk, kNearToClosest)}, rays, hits.first(rays.size()));
}

void trace_any_wide(const Dag& dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                    std::span<std::uint8_t> occluded, Partitions* partitions,
                    WideWalk walk) noexcept {
    const shared::DagView view = shared::view(dag);
    if (!in_lanes(dag, stop, walk)) {
        for (std::size_t i = 0; i < rays.size(); ++i)
            occluded[i] = shared::trace_any(view, rays[i], stop) ? 1 : 0;
        return;
    }
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    if (dag.empty() || rays.empty()) return;
    if (partitions != nullptr && partitions->height() == 0) partitions = nullptr;
    HWY_DYNAMIC_DISPATCH(TraceAny)
    ({view, stop, far_nodes(dag, walk, kNearToAny)}, partitions, rays, occluded.data());
}

}  // namespace octavo
#endif
