// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "octavo/backend/gpu_visibility.h"

struct CUstream_st;

namespace octavo::cuda {

/// Shadow and ambient occlusion for an engine whose G-buffer is on a CUDA device already: device
/// pointers in, device pointers out, in the order of the caller's stream.
class Effects {
public:
    /// Copies the DAG to the device of the stream, and waits for the copy.
    ///
    /// @param stream      must outlive the effects, and be that of `device`
    /// @param attributes  of the DAG's cells; none: no looks()
    /// @param light       of the cells, as octavo::light_cells() gives it
    /// @throws Error  unsupported where there is no such device; limit where its memory is used up
    Effects(const Dag& dag, const Grid& grid, int device, CUstream_st* stream,
            const Attributes& attributes = {}, const CellLight& light = {});
    ~Effects();
    Effects(const Effects&) = delete;
    Effects& operator=(const Effects&) = delete;

    /// As octavo::visibility(): shadow and ambient are device pointers to a float for each point,
    /// or null. Puts the work into the stream and returns; only a light made of triangles is copied
    /// first, which waits.
    ///
    /// @throws Error  bad_argument where an option is out of range; limit, io
    void visibility(const DeviceGBuffer& gbuffer, const VisibilityOptions& options, float* shadow,
                    float* ambient);

    /// What the cells at the points look like, and the light that is stored around them: three
    /// floats for each point, linear light, to device pointers. Puts the work into the stream and
    /// returns.
    ///
    /// @throws Error  bad_argument where what is asked for was not given to the constructor
    void looks(const DeviceGBuffer& gbuffer, const DevicePointLooks& out);

    /// The DAG on the device, for kernels of the caller's own that include trace/traverse.h.
    [[nodiscard]] const shared::DagView& dag() const { return model_->dag; }
    /// Its cells' looks and light, for kernels that include light/cell_views.h.
    [[nodiscard]] const GpuModel& model() const { return *model_; }

private:
    std::unique_ptr<PassQueue> queue_;
    Grid grid_;
    std::unique_ptr<GpuModel> model_;
};

}  // namespace octavo::cuda
