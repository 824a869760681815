// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "octavo/io/model.h"
#include "octavo/trace/dag_view.h"

namespace octavo::cli {

/// NanoVDB's HDDA on the same voxels: what the DAG is measured against. They are values of 4 bits,
/// the smallest that NanoVDB's own builder makes; the trace reads the bits that say where a value
/// is. Present where the program was built with NanoVDB (package libnanovdb-dev).
class NanovdbTracer {
public:
    /// @throws Error  unsupported where the program was built without NanoVDB; limit where its grid
    ///                would take more than half of the machine's memory
    explicit NanovdbTracer(const Model& model);
    ~NanovdbTracer();
    NanovdbTracer(const NanovdbTracer&) = delete;
    NanovdbTracer& operator=(const NanovdbTracer&) = delete;

    [[nodiscard]] std::uint64_t size_bytes() const;

    /// On the calling thread; occluded[i] is 1 where ray i hits a voxel, else 0.
    void trace(std::span<const shared::GridRay> rays, std::span<std::uint8_t> occluded) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace octavo::cli
