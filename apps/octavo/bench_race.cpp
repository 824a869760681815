// SPDX-License-Identifier: MIT
#include "bench_race.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "degrees.h"
#include "octavo/trace/wide.h"

namespace octavo::cli {
namespace {

/// Rays that a task traces: with them Embree and the voxels are both far above a task's cost.
constexpr std::size_t kRaysPerTask = 4096;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Seconds that all tasks of a ray set take, on all threads of the arena.
template <class Trace>
double time_rays(std::size_t count, const Trace& trace) {
    const auto start = std::chrono::steady_clock::now();
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, (count + kRaysPerTask - 1) / kRaysPerTask, 1),
        [&](const tbb::blocked_range<std::size_t>& tasks) {
            for (std::size_t i = tasks.begin(); i != tasks.end(); ++i)
                trace(i * kRaysPerTask, std::min(kRaysPerTask, count - i * kRaysPerTask));
        });
    return seconds_since(start);
}

void count(Row& row, const RaySet& set, double one, double wide) {
    const double millions = 1e-6 * static_cast<double>(set.size());
    row.one.push_back(millions / one);
    row.voxels.push_back(millions / wide);
    row.rays += set.size();
}
void count_device(Row& row, const RaySet& set, double seconds) {
    row.device.push_back(1e-6 * static_cast<double>(set.size()) / seconds);
}
void compare(Row& row, const RaySet& set, double wide, double embree1, double embree16) {
    const double millions = 1e-6 * static_cast<double>(set.size());
    row.embree1.push_back(millions / embree1);
    row.embree16.push_back(millions / embree16);
    row.ratio.push_back(std::min(embree1, embree16) / wide);
}

}  // namespace

Race::Race(const Model& model, const TriangleTracer* triangles, const NanovdbTracer* nanovdb,
           Device* device, bool wide)
    : model_(model),
      view_(shared::view(model.dag)),
      triangles_(triangles),
      nanovdb_(nanovdb),
      device_(device),
      device_dag_(device != nullptr ? device->upload(model.dag) : nullptr),
      wide_(wide),
      partitions_(model.dag, Partitions::Pace::flight) {}

void Race::start_at_beam(const PixelRays& pixels, std::size_t tile, int size,
                         std::span<shared::GridRay> rays) const {
    const int columns = size / kTilePixels;
    const int x = static_cast<int>(tile) % columns * kTilePixels;
    const int y = static_cast<int>(tile) / columns * kTilePixels;
    const auto beam = pixels.bundle(x, y, x + kTilePixels, y + kTilePixels);
    if (!beam) return;
    const float start = beam_start_wide(model_.dag, *beam, shared::stop_at_voxels());
    for (shared::GridRay& ray : rays) ray.t_min = start;
}

/// `hit(i)`: what the DAG says of ray i.
template <class Hit>
void Race::race_nanovdb(Row& row, const RaySet& set, const Hit& hit) const {
    if (nanovdb_ == nullptr) return;
    std::vector<std::uint8_t> found(set.size());
    const double seconds = time_rays(set.size(), [&](std::size_t first, std::size_t some) {
        nanovdb_->trace(std::span(set.voxel_rays).subspan(first, some),
                        std::span(found).subspan(first, some));
    });
    row.nanovdb.push_back(1e-6 * static_cast<double>(set.size()) / seconds);
    for (std::size_t i = 0; i < set.size(); ++i) row.nanovdb_agreed += (found[i] != 0) == hit(i);
}

void Race::primary(Row& row, const RaySet& set, const PixelRays& pixels, int size) {
    std::vector<shared::GridHit> hits(set.size());
    const double one = time_rays(set.size(), [&](std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i)
            hits[i] = shared::trace_closest(view_, set.voxel_rays[i], shared::stop_at_voxels());
    });
    double wide = one;
    if (wide_) {
        std::vector<shared::GridRay> rays = set.voxel_rays;
        wide = time_rays(set.size(), [&](std::size_t first, std::size_t count) {
            const auto some = std::span(rays).subspan(first, count);
            for (std::size_t i = 0; i < count; i += kTileRays)
                start_at_beam(pixels, (first + i) / kTileRays, size, some.subspan(i, kTileRays));
            trace_closest_wide(model_.dag, some, shared::stop_at_voxels(),
                               std::span(hits).subspan(first, count));
        });
    }
    voxel_hits_ = hits;
    count(row, set, one, wide);
    if (device_ != nullptr) {
        std::vector<shared::GridHit> found(set.size());
        count_device(
            row, set,
            device_->trace_closest(*device_dag_, set.voxel_rays, shared::stop_at_voxels(), found));
    }
    race_nanovdb(row, set, [&](std::size_t i) { return hits[i].face != shared::kFaceNone; });
    for (const shared::GridHit& hit : hits) row.hits += hit.face != shared::kFaceNone;
    if (triangles_ == nullptr) return;
    triangle_hits_.resize(set.size());
    const auto embree = [&](TriangleTracer::Width width) {
        return time_rays(set.size(), [&](std::size_t first, std::size_t some) {
            triangles_->closest(std::span(set.triangle_rays).subspan(first, some), width, true,
                                std::span(triangle_hits_).subspan(first, some));
        });
    };
    compare(row, set, wide, embree(TriangleTracer::Width::one),
            embree(TriangleTracer::Width::sixteen));
    for (std::size_t i = 0; i < set.size(); ++i)
        row.agreed += agrees(set.voxel_rays[i], hits[i], triangle_hits_[i]);
}

void Race::any(Row& row, const RaySet& set, bool coherent) {
    if (set.size() == 0) return;
    std::vector<std::uint8_t> single(set.size()), wide_any(set.size()), mesh(set.size());
    const double one = time_rays(set.size(), [&](std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i)
            single[i] = shared::trace_any(view_, set.voxel_rays[i], shared::stop_at_voxels());
    });
    const auto trace_wide = [&](std::size_t first, std::size_t count) {
        trace_any_wide(model_.dag, std::span(set.voxel_rays).subspan(first, count),
                       shared::stop_at_voxels(), std::span(wide_any).subspan(first, count),
                       &partitions_);
    };
    if (wide_ && coherent) {
        constexpr int kMostPasses = 8;
        std::size_t tables = 0;
        for (int i = 0; i < kMostPasses && (i == 0 || partitions_.count() > tables); ++i) {
            tables = partitions_.count();
            time_rays(set.size(), trace_wide);
        }
    }
    double wide = one;
    if (wide_)
        wide = time_rays(set.size(), trace_wide);
    else
        wide_any = single;
    count(row, set, one, wide);
    if (device_ != nullptr) {
        std::vector<std::uint32_t> occluded(set.size());
        count_device(
            row, set,
            device_->trace_any(*device_dag_, set.voxel_rays, shared::stop_at_voxels(), occluded));
    }
    race_nanovdb(row, set, [&](std::size_t i) { return wide_any[i] != 0; });
    for (const std::uint8_t hit : wide_any) row.hits += hit;
    if (triangles_ == nullptr) return;
    const auto embree = [&](TriangleTracer::Width width) {
        return time_rays(set.size(), [&](std::size_t first, std::size_t some) {
            triangles_->any(std::span(set.triangle_rays).subspan(first, some), width, coherent,
                            std::span(mesh).subspan(first, some));
        });
    };
    compare(row, set, wide, embree(TriangleTracer::Width::one),
            embree(TriangleTracer::Width::sixteen));
    for (std::size_t i = 0; i < set.size(); ++i) row.agreed += wide_any[i] == mesh[i];
}

void Race::ambient_cone(Cone& cone, const RaySet& set) const {
    if (set.size() == 0 || !wide_) return;
    std::vector<std::uint8_t> full(set.size()), coarse(set.size());
    const auto trace = [&](float angle, std::vector<std::uint8_t>& to) {
        return time_rays(set.size(), [&](std::size_t first, std::size_t count) {
            trace_any_wide(model_.dag, std::span(set.voxel_rays).subspan(first, count),
                           {0, angle, 0.0f}, std::span(to).subspan(first, count));
        });
    };
    trace(0.0f, full);
    const double seconds = trace(static_cast<float>(cone.degrees * kRadiansPerDegree), coarse);
    cone.voxels.push_back(1e-6 * static_cast<double>(set.size()) / seconds);
    for (std::size_t i = 0; i < set.size(); i += kAmbientSamples) {
        int more = 0;
        for (std::size_t k = i; k < i + kAmbientSamples; ++k) more += coarse[k] - full[k];
        const double darker = static_cast<double>(more) / kAmbientSamples;
        cone.darker += darker;
        cone.squared += darker * darker;
        ++cone.points;
    }
}

std::vector<SurfacePoint> Race::surface(const RaySet& primary) const {
    std::vector<SurfacePoint> points;
    for (std::size_t i = 0; i < primary.size(); ++i) {
        const shared::GridRay& ray = primary.voxel_rays[i];
        const shared::GridHit& hit = voxel_hits_[i];
        const bool mesh = triangles_ != nullptr;
        if (mesh ? !std::isfinite(triangle_hits_[i].t) : hit.face >= shared::kFaceInside) continue;
        const double t = mesh ? triangle_hits_[i].t : hit.t;
        dvec3 normal(0.0);
        if (mesh)
            normal = dvec3(triangle_hits_[i].normal);
        else
            normal[hit.face / 2] = 1.0;
        if (!(glm::length(normal) > 0.0)) continue;
        if (glm::dot(normal, dvec3(ray.dir)) > 0.0) normal = -normal;
        const dvec3 grid = dvec3(ray.cell) + dvec3(ray.frac) + t * dvec3(ray.dir);
        points.push_back({model_.grid().to_world(grid), glm::normalize(normal)});
    }
    return points;
}

}  // namespace octavo::cli
