// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

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
/// @throws Error   limit where the scratch memory, 60 bytes for each of at most 2^19 points, is not
///                 there
void queue_visibility(PassQueue& queue, const shared::DagView& dag, const Grid& grid,
                      const DeviceGBuffer& gbuffer, const GpuLamp* lamp,
                      const VisibilityOptions& options, float* shadow, float* ambient);

}  // namespace octavo
