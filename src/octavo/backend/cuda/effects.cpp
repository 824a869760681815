// SPDX-License-Identifier: MIT
#include "octavo/backend/cuda/effects.h"

#include "octavo/backend/cuda/cuda_queue.h"
#include "octavo/render/settings.h"

namespace octavo::cuda {

Effects::Effects(const Dag& dag, const Grid& grid, int device, CUstream_st* stream)
    : queue_(open_queue(device, stream)),
      grid_(grid),
      dag_(queue_->upload(dag.words(), dag.empty() ? 0 : dag.depth())) {}

Effects::~Effects() {
    queue_->release(dag_);
}

void Effects::visibility(const DeviceGBuffer& gbuffer, const VisibilityOptions& options,
                         float* shadow, float* ambient) {
    check(options, gbuffer.points, gbuffer.points, shadow != nullptr ? gbuffer.points : 0,
          ambient != nullptr ? gbuffer.points : 0);
    std::unique_ptr<GpuLamp> lamp;
    if (options.light && shadow != nullptr)
        lamp = std::make_unique<GpuLamp>(*queue_, *options.light, grid_);
    queue_visibility(*queue_, dag_, grid_, gbuffer, lamp.get(), options, shadow, ambient);
}

}  // namespace octavo::cuda
