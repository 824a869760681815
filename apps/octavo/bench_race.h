// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench_differences.h"
#include "bench_rays.h"
#include "nanovdb_tracer.h"
#include "octavo/backend/device.h"
#include "octavo/io/model.h"
#include "octavo/render/pixel_rays.h"
#include "octavo/trace/partitions.h"
#include "triangle_tracer.h"

namespace octavo::cli {

/// What one kind of ray came to, frame by frame; MRays/s.
struct Row {
    std::string name;
    std::vector<double> one;     // the shared text, a ray at a time
    std::vector<double> voxels;  // lanes and tables; with --no-wide as `one`
    std::vector<double> device;  // a device's, without beams and copies
    std::vector<double> nanovdb;
    std::vector<double> embree1;
    std::vector<double> embree16;
    std::vector<double> ratio;  // of `voxels` to the better of Embree's
    std::size_t rays = 0;
    std::size_t hits = 0;
    std::size_t agreed = 0;
    std::size_t nanovdb_agreed = 0;
};

/// Ambient rays that stop at cells which look smaller than an angle: the speed, and how much darker
/// the points come out than with rays to the voxels.
struct Cone {
    double degrees;
    std::vector<double> voxels{};  // MRays/s
    double darker = 0.0;           // sums over the points, of the open part of their sky
    double squared = 0.0;
    std::size_t points = 0;
};

/// Rays of a point in ambient_rays(), which Race::ambient_cone() takes together.
inline constexpr int kAmbientSamples = 64;

/// One frame's rays, traced by everything in turn.
class Race {
public:
    /// @param triangles, nanovdb, device  also race, where they are not null
    Race(const Model& model, const TriangleTracer* triangles, const NanovdbTracer* nanovdb,
         Device* device, bool wide);

    void primary(Row& row, const RaySet& set, const PixelRays& pixels, int size);
    /// Where they are coherent, the voxels' tables that they ask for are made before.
    void any(Row& row, const RaySet& set, bool coherent);

    /// `set`: kAmbientSamples rays for each point.
    void ambient_cone(Cone& cone, const RaySet& set) const;

    /// Why the last primary rays' hits on voxels and triangles differ.
    void differences(const RaySet& primary, Differences& sum) const {
        count_differences(primary, model_.grid(), *triangles_, voxel_hits_, triangle_hits_, sum);
    }

    /// Where the last primary rays met the triangles, or the voxels where there are none.
    [[nodiscard]] std::vector<SurfacePoint> surface(const RaySet& primary) const;

    [[nodiscard]] const Partitions& partitions() const { return partitions_; }

private:
    void start_at_beam(const PixelRays& pixels, std::size_t tile, int size,
                       std::span<shared::GridRay> rays) const;
    template <class Hit>
    void race_nanovdb(Row& row, const RaySet& set, const Hit& hit) const;

    const Model& model_;
    shared::DagView view_;
    const TriangleTracer* triangles_;
    const NanovdbTracer* nanovdb_;
    Device* device_;
    std::unique_ptr<DeviceDag> device_dag_;
    bool wide_;
    Partitions partitions_;
    std::vector<shared::GridHit> voxel_hits_;
    std::vector<TriangleHit> triangle_hits_;
};

}  // namespace octavo::cli
