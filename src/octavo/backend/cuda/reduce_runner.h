// SPDX-License-Identifier: MIT
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <functional>

#include "octavo/backend/cuda/reduce_steps.h"

/// Between reduce.cpp, which knows the rest of Octavo, and reduce.cu, which nvcc compiles.
namespace octavo::cuda {

class ReduceMemory {
public:
    virtual ~ReduceMemory() = default;

    /// Device memory for a use; the next call for the same use may take it away. Uses are literals.
    virtual void* array(const char* use, std::uint64_t bytes) = 0;

    /// @throws Error where the call failed
    virtual void check(cudaError_t error) = 0;
};

using TakeLevel =
    std::function<void(int height, const std::uint32_t* device_words, std::uint32_t words)>;

/// reduce_tile() with CUB.
void reduce_on_device(ReduceMemory& memory, const std::uint32_t* codes, const Candidate* leaves,
                      std::uint32_t n, int top, cudaStream_t stream, const TakeLevel& take);

}  // namespace octavo::cuda
