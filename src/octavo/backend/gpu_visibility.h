// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "octavo/attributes/attributes.h"
#include "octavo/attributes/cell_light.h"
#include "octavo/backend/pass_queue.h"
#include "octavo/core/grid.h"
#include "octavo/light/lamp.h"
#include "octavo/render/visibility.h"

namespace octavo {

/// A light whose triangles, if it has any, are on the device.
struct GpuLamp {
    GpuLamp(PassQueue& queue, const Light& light, const Grid& grid)
        : lamp(light, grid), triangles(queue, lamp.triangles()), placed(lamp.placed()) {
        placed.triangles = triangles.get();
    }

    Lamp lamp;
    DeviceArray<shared::LampTriangles> triangles;
    shared::PlacedLamp placed;
};

/// Secondary rays of a pixel in one pass.
inline constexpr int kRaysOfAPass = 64;

/// Calls pass() with the job's [first, end) set to parts of a pixel's rays.
template <typename Run>
void in_parts(shared::PixelJob& job, const ivec2& rays, const Run& pass) {
    for (int first = rays.x; first < rays.y; first += kRaysOfAPass) {
        job.first = first;
        job.end = std::min(rays.y, first + kRaysOfAPass);
        pass();
    }
}

/// Asks for the rays [rays.x, rays.y) from each pixel to the job's lamp; with `beams` and many
/// rays, for what their way has in common first.
inline void queue_lamp(PassQueue& queue, shared::PixelJob& job, const ivec2& rays, bool beams,
                       std::uint64_t pixels) {
    job.lamp_rays = rays.y - rays.x;
    job.lamp_beams = beams && job.lamp_rays >= shared::kRaysForABeam ? 1 : 0;
    if (job.lamp_beams != 0) queue.run(Pass::lamp_beam, job, pixels);
    in_parts(job, rays, [&] {
        queue.run(Pass::lamp, job, pixels);
        queue.cut();
    });
}

/// A G-buffer in a device's memory. World space; strides in floats, at least 3.
struct DeviceGBuffer {
    const float* positions = nullptr;
    const float* normals = nullptr;
    int position_stride = 3;
    int normal_stride = 3;
    std::uint64_t points = 0;
};

/// Asks a queue for the shadow and ambient occlusion of a G-buffer, see visibility(). Where an
/// address is null nothing is computed. Returns before it is done.
///
/// @param lamp     of options.light, or null
/// @throws Error   limit where the scratch memory, 68 bytes for each of at most 2^19 points, is not
///                 there
void queue_visibility(PassQueue& queue, const shared::DagView& dag, const Grid& grid,
                      const DeviceGBuffer& gbuffer, const GpuLamp* lamp,
                      const VisibilityOptions& options, float* shadow, float* ambient);

/// A DAG on a device, with what its cells look like and their light where there are any.
struct GpuModel {
    /// @throws Error  unsupported where there are 2^32 cells or more
    GpuModel(PassQueue& queue, const Dag& dag, const Attributes& attributes,
             const CellLight& light);

    shared::DagView dag;
    shared::CellLooks looks{};
    shared::LightView light{};
    bool has_looks = false;
    bool has_light = false;

private:
    DeviceWords words_;
    DeviceWords sums_;
    std::array<DeviceWords, 4> channels_;
    DeviceWords light_;
};

/// Three floats for each point, linear light, on a device; null where it is not asked for. As
/// PointLooks.
struct DevicePointLooks {
    float* albedo = nullptr;
    float* emission = nullptr;
    float* light = nullptr;
};

/// Asks a queue for what the cells at a G-buffer's points look like. Returns before it is done.
/// @throws Error  bad_argument where what is asked for is not in the model
void queue_looks(PassQueue& queue, const GpuModel& model, const Grid& grid,
                 const DeviceGBuffer& gbuffer, const DevicePointLooks& out);

}  // namespace octavo
