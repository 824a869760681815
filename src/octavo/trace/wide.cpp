// SPDX-License-Identifier: MIT
#include "octavo/trace/wide.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octavo/trace/wide.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#include "octavo/trace/wide_batch-inl.h"
#include "octavo/trace/wide_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

/// Keeps two vectors of rays in flight, so that one computes while the other waits for memory.
template <bool kCone, class Results>
HWY_INLINE void walk_all(shared::DagView dag, std::span<const shared::GridRay> rays,
                         shared::Stop stop, Results& results) {
    BatchReader reader(dag, rays, stop);
    Walk<kCone> first(dag, stop);
    Walk<kCone> second(dag, stop);
    while (true) {
        const bool more = first.refill(reader) | second.refill(reader);
        if (!more && first.idle() && second.idle()) return;
        first.step(results);
        second.step(results);
    }
}

/// Marks the rays that hit something.
struct AnyResults {
    std::uint8_t* occluded;

    void add(std::uint32_t ray, const ivec3&, int, float) { occluded[ray] = 1; }
    static constexpr bool kNeedsCell = false;
};

/// Makes the shared text's hits.
struct ClosestResults {
    const shared::GridRay* rays;
    int depth;
    shared::GridHit* hits;

    void add(std::uint32_t ray, const ivec3& corner, int height, float t) {
        const shared::GridRay& r = rays[ray];
        const shared::UpwardRay up = shared::mirror_ray(r.cell, r.frac, r.dir, depth);
        hits[ray] = shared::make_hit(up, depth, corner, height, t, 0);
    }
    static constexpr bool kNeedsCell = true;
};

void TraceClosest(shared::DagView dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                  shared::GridHit* hits) {
    ClosestResults results{rays.data(), dag.depth, hits};
    if (stop.cone > 0.0f)
        walk_all<true>(dag, rays, stop, results);
    else
        walk_all<false>(dag, rays, stop, results);
}

void TraceAny(shared::DagView dag, std::span<const shared::GridRay> rays, shared::Stop stop,
              std::uint8_t* occluded) {
    AnyResults results{occluded};
    if (stop.cone > 0.0f)
        walk_all<true>(dag, rays, stop, results);
    else
        walk_all<false>(dag, rays, stop, results);
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

}  // namespace

HWY_EXPORT(TraceClosest);
HWY_EXPORT(TraceAny);

void trace_closest_wide(const Dag& dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                        std::span<shared::GridHit> hits) noexcept {
    const shared::DagView view = shared::view(dag);
    if (!fits_lanes(dag, stop)) {
        for (std::size_t i = 0; i < rays.size(); ++i)
            hits[i] = shared::trace_closest(view, rays[i], stop);
        return;
    }
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = shared::make_miss(rays[i].t_max, 0);
    if (!dag.empty()) HWY_DYNAMIC_DISPATCH(TraceClosest)(view, rays, stop, hits.data());
}

void trace_any_wide(const Dag& dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                    std::span<std::uint8_t> occluded) noexcept {
    const shared::DagView view = shared::view(dag);
    if (!fits_lanes(dag, stop)) {
        for (std::size_t i = 0; i < rays.size(); ++i)
            occluded[i] = shared::trace_any(view, rays[i], stop) ? 1 : 0;
        return;
    }
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    if (!dag.empty()) HWY_DYNAMIC_DISPATCH(TraceAny)(view, rays, stop, occluded.data());
}

}  // namespace octavo
#endif
