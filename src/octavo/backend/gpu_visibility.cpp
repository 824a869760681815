// SPDX-License-Identifier: MIT
#include "octavo/backend/gpu_visibility.h"

#include <algorithm>

namespace octavo {
namespace {

/// Points that are worked on at once: they fill any GPU, and bound the scratch memory.
constexpr std::uint64_t kPointsAtOnce = 1 << 19;

}  // namespace

void queue_visibility(PassQueue& queue, const shared::DagView& dag, const Grid& grid,
                      const DeviceGBuffer& gbuffer, const GpuLamp* lamp,
                      const VisibilityOptions& options, float* shadow, float* ambient) {
    const std::uint64_t most = std::min(kPointsAtOnce, gbuffer.points);
    if (most == 0) return;
    const DeviceArray<shared::PointArray> points(queue, most);
    const DeviceArray<shared::UintArray> sky_seen(queue, most);
    const DeviceArray<shared::LightArray> lamp_seen(queue, most);
    shared::PixelJob job{};
    job.dag = dag;
    job.points = points.get();
    job.sky_seen = sky_seen.get();
    job.lamp_seen = lamp_seen.get();
    job.frame = options.frame;
    job.grid_origin_high = vec3(grid.origin);
    job.grid_origin_low = vec3(grid.origin - dvec3(job.grid_origin_high));
    job.voxels_per_unit = static_cast<float>(1.0 / grid.voxel_size);
    job.bias = static_cast<float>(options.bias);
    job.position_stride = gbuffer.position_stride;
    job.normal_stride = gbuffer.normal_stride;
    job.sky_rays = options.ao_samples;
    job.sky_radius = static_cast<float>(options.ao_radius / grid.voxel_size);
    job.sky_stop.cone = static_cast<float>(options.ao_cone);
    job.lamp_rays = options.shadow_samples;
    job.lamp_beams = 1;
    job.shadows = 1;
    if (lamp != nullptr) job.lamp = lamp->placed;
    for (std::uint64_t first = 0; first < gbuffer.points; first += most) {
        const std::uint64_t some = std::min(most, gbuffer.points - first);
        const auto offset = static_cast<std::ptrdiff_t>(first);
        job.first_point = static_cast<std::uint32_t>(first);
        job.positions.at = const_cast<float*>(gbuffer.positions) + offset * gbuffer.position_stride;
        job.normals.at = const_cast<float*>(gbuffer.normals) + offset * gbuffer.normal_stride;
        queue.run(Pass::gbuffer, job, some);
        if (ambient != nullptr && options.ao_samples > 0) {
            job.ambient.at = ambient + offset;
            in_parts(job, {0, options.ao_samples}, [&] {
                queue.run(Pass::sky, job, some);
                queue.cut();
            });
            queue.run(Pass::ambient_out, job, some);
        }
        if (shadow != nullptr && lamp != nullptr) {
            job.shadow.at = shadow + offset;
            in_parts(job, {0, options.shadow_samples}, [&] {
                queue.run(Pass::lamp, job, some);
                queue.cut();
            });
            queue.run(Pass::shadow_out, job, some);
        }
    }
}

}  // namespace octavo
