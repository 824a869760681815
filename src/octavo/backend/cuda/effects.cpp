// SPDX-License-Identifier: MIT
#include "octavo/backend/cuda/effects.h"

#include "octavo/backend/cuda/cuda_queue.h"
#include "octavo/render/settings.h"

namespace octavo::cuda {

Effects::Effects(const Dag& dag, const Grid& grid, int device, CUstream_st* stream,
                 const Attributes& attributes, const CellLight& light)
    : queue_(open_queue(device, stream)),
      grid_(grid),
      model_(std::make_unique<GpuModel>(*queue_, dag, attributes, light)) {}

Effects::~Effects() = default;

void Effects::visibility(const DeviceGBuffer& gbuffer, const VisibilityOptions& options,
                         float* shadow, float* ambient) {
    check(options, gbuffer.points, gbuffer.points, shadow != nullptr ? gbuffer.points : 0,
          ambient != nullptr ? gbuffer.points : 0);
    std::unique_ptr<GpuLamp> lamp;
    if (options.light && shadow != nullptr)
        lamp = std::make_unique<GpuLamp>(*queue_, *options.light, grid_);
    queue_visibility(*queue_, model_->dag, grid_, gbuffer, lamp.get(), options, shadow, ambient);
}

void Effects::looks(const DeviceGBuffer& gbuffer, const DevicePointLooks& out) {
    queue_looks(*queue_, *model_, grid_, gbuffer, out);
}

}  // namespace octavo::cuda
