// SPDX-License-Identifier: MIT
#include "octavo/backend/gpu_visibility.h"

#include <algorithm>

#include "octavo/core/error.h"

namespace octavo {
namespace {

/// Points that are worked on at once: they fill any GPU, and bound the scratch memory.
constexpr std::uint64_t kPointsAtOnce = 1 << 19;

/// Goes through the points of a G-buffer part by part, with room on the device for one part.
class GBufferParts {
public:
    GBufferParts(PassQueue& queue, const shared::DagView& dag, const Grid& grid,
                 const DeviceGBuffer& gbuffer)
        : queue_(queue),
          gbuffer_(gbuffer),
          most_(std::min(kPointsAtOnce, gbuffer.points)),
          points_(queue, most_),
          sky_seen_(queue, most_),
          lamp_times_(queue, most_),
          lamp_seen_(queue, most_) {
        job.dag = dag;
        job.grid_origin_high = vec3(grid.origin);
        job.grid_origin_low = vec3(grid.origin - dvec3(job.grid_origin_high));
        job.voxels_per_unit = static_cast<float>(1.0 / grid.voxel_size);
        job.bias = 1.0f;
        job.position_stride = gbuffer.position_stride;
        job.normal_stride = gbuffer.normal_stride;
        job.points = points_.get();
        job.sky_seen = sky_seen_.get();
        job.lamp_times = lamp_times_.get();
        job.lamp_seen = lamp_seen_.get();
    }

    /// Calls run(first, count) once the job's points are those from `first` on.
    void for_each(const auto& run) {
        for (std::uint64_t first = 0; first < gbuffer_.points; first += most_) {
            const std::uint64_t count = std::min(most_, gbuffer_.points - first);
            const auto offset = static_cast<std::ptrdiff_t>(first);
            job.first_point = static_cast<std::uint32_t>(first);
            job.positions.at =
                const_cast<float*>(gbuffer_.positions) + offset * gbuffer_.position_stride;
            job.normals.at = const_cast<float*>(gbuffer_.normals) + offset * gbuffer_.normal_stride;
            queue_.run(Pass::gbuffer, job, count);
            run(first, count);
        }
    }

    shared::PixelJob job{};

private:
    PassQueue& queue_;
    const DeviceGBuffer& gbuffer_;
    std::uint64_t most_;
    DeviceArray<shared::PointArray> points_;
    DeviceArray<shared::UintArray> sky_seen_;
    DeviceArray<shared::LightArray> lamp_times_;
    DeviceArray<shared::LightArray> lamp_seen_;
};

}  // namespace

void queue_visibility(PassQueue& queue, const shared::DagView& dag, const Grid& grid,
                      const DeviceGBuffer& gbuffer, const GpuLamp* lamp,
                      const VisibilityOptions& options, float* shadow, float* ambient) {
    if (gbuffer.points == 0) return;
    GBufferParts parts(queue, dag, grid, gbuffer);
    shared::PixelJob& job = parts.job;
    job.frame = options.frame;
    job.bias = static_cast<float>(options.bias);
    job.sky_rays = options.ao_samples;
    job.sky_radius = static_cast<float>(options.ao_radius / grid.voxel_size);
    job.sky_stop.cone = static_cast<float>(options.ao_cone);
    job.shadows = 1;
    if (lamp != nullptr) job.lamp = lamp->placed;
    parts.for_each([&](std::uint64_t first, std::uint64_t count) {
        if (ambient != nullptr && options.ao_samples > 0) {
            job.ambient.at = ambient + first;
            in_parts(job, {0, options.ao_samples}, [&] {
                queue.run(Pass::sky, job, count);
                queue.cut();
            });
            queue.run(Pass::ambient_out, job, count);
        }
        if (shadow != nullptr && lamp != nullptr) {
            job.shadow.at = shadow + first;
            queue_lamp(queue, job, {0, options.shadow_samples}, true, count);
            queue.run(Pass::shadow_out, job, count);
        }
    });
}

GpuModel::GpuModel(PassQueue& queue, const Dag& model, const Attributes& attributes,
                   const CellLight& cell_light)
    : words_(queue, model.words()) {
    dag = {words_.get().at, model.empty() ? 0 : model.depth()};
    if (attributes.empty() || model.empty()) return;
    if (!attributes.cells().fits_32_bits())
        throw Error(Errc::unsupported,
                    "a GPU shows less than 2^32 coloured cells; lower the attribute resolution");
    using Channel = Attributes::Channel;
    const auto upload = [&](std::size_t i, Channel which) {
        channels_[i] = DeviceWords(queue, attributes.channel(which).words());
        return shared::ValueView{channels_[i].get()};
    };
    sums_ = DeviceWords(queue, attributes.cells().sums());
    looks.cells = {sums_.get(), attributes.level()};
    looks.color = upload(0, Channel::color);
    looks.back = upload(1, Channel::back);
    looks.emission = upload(2, Channel::emission);
    looks.back_emission = upload(3, Channel::back_emission);
    looks.has = shared::channels_of(attributes);
    has_looks = true;
    if (cell_light.empty()) return;
    light_ = DeviceWords(queue, cell_light.words());
    light = {light_.get()};
    has_light = true;
}

void queue_looks(PassQueue& queue, const GpuModel& model, const Grid& grid,
                 const DeviceGBuffer& gbuffer, const DevicePointLooks& out) {
    if (!model.has_looks)
        throw Error(Errc::bad_argument, "the DAG was uploaded without attributes");
    if (out.light != nullptr && !model.has_light)
        throw Error(Errc::bad_argument, "the DAG was uploaded without stored light");
    if (gbuffer.points == 0) return;
    GBufferParts parts(queue, model.dag, grid, gbuffer);
    shared::PixelJob& job = parts.job;
    job.looks = model.looks;
    job.cell_light = model.light;
    job.wanted = (out.albedo != nullptr ? shared::kWantAlbedo : 0) |
                 (out.emission != nullptr ? shared::kWantEmission : 0) |
                 (out.light != nullptr ? shared::kWantLight : 0);
    parts.for_each([&](std::uint64_t first, std::uint64_t count) {
        const auto part = [&](float* all) {
            return shared::FloatArray{all == nullptr ? nullptr : all + 3 * first};
        };
        job.point_albedo = part(out.albedo);
        job.point_emission = part(out.emission);
        job.point_light = part(out.light);
        queue.run(Pass::gbuffer_looks, job, count);
        queue.cut();
    });
}

}  // namespace octavo
