// SPDX-License-Identifier: MIT
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "octavo/backend/cuda/reduce_runner.h"

namespace octavo::cuda {
namespace {

constexpr unsigned kBlockThreads = 256;

template <typename Step>
__global__ void step_kernel(Step step, std::uint32_t n) {
    const std::uint32_t i = blockIdx.x * kBlockThreads + threadIdx.x;
    if (i < n) step(i);
}

struct Maximum {
    __host__ __device__ std::uint32_t operator()(std::uint32_t a, std::uint32_t b) const {
        return a > b ? a : b;
    }
};

/// What reduce_tile() asks for, on a stream.
class CubRunner {
public:
    CubRunner(ReduceMemory& memory, cudaStream_t stream) : memory_(memory), stream_(stream) {}

    template <typename T>
    T* array(const char* use, std::uint32_t n) {
        return static_cast<T*>(memory_.array(use, sizeof(T) * std::uint64_t{n}));
    }

    template <typename Step>
    void for_each(std::uint32_t n, const Step& step) {
        step_kernel<<<(n + kBlockThreads - 1) / kBlockThreads, kBlockThreads, 0, stream_>>>(step,
                                                                                            n);
        memory_.check(cudaGetLastError());
    }

    void sort(std::uint64_t* hashes, std::uint32_t* order, std::uint32_t n) {
        auto* sorted_hashes = array<std::uint64_t>("sorted hashes", n);
        auto* sorted_order = array<std::uint32_t>("sorted order", n);
        with_scratch([&](void* scratch, std::size_t& bytes) {
            return cub::DeviceRadixSort::SortPairs(scratch, bytes, hashes, sorted_hashes, order,
                                                   sorted_order, n, 0, 64, stream_);
        });
        copy(hashes, sorted_hashes, n);
        copy(order, sorted_order, n);
    }

    void running_maximum(std::uint32_t* values, std::uint32_t n) {
        with_scratch([&](void* scratch, std::size_t& bytes) {
            return cub::DeviceScan::InclusiveScan(scratch, bytes, values, values, Maximum(), n,
                                                  stream_);
        });
    }

    void sum_before(const std::uint32_t* in, std::uint32_t* out, std::uint32_t n) {
        with_scratch([&](void* scratch, std::size_t& bytes) {
            return cub::DeviceScan::ExclusiveSum(scratch, bytes, in, out, n, stream_);
        });
    }

    std::uint32_t value(const std::uint32_t* address) {
        std::uint32_t value = 0;
        memory_.check(
            cudaMemcpyAsync(&value, address, sizeof(value), cudaMemcpyDeviceToHost, stream_));
        memory_.check(cudaStreamSynchronize(stream_));
        return value;
    }

private:
    template <typename T>
    void copy(T* to, const T* from, std::uint32_t n) {
        memory_.check(cudaMemcpyAsync(to, from, sizeof(T) * n, cudaMemcpyDeviceToDevice, stream_));
    }

    template <typename Call>
    void with_scratch(const Call& call) {
        std::size_t bytes = 0;
        memory_.check(call(nullptr, bytes));
        memory_.check(call(memory_.array("scratch", bytes), bytes));
    }

    ReduceMemory& memory_;
    cudaStream_t stream_;
};

}  // namespace

void reduce_on_device(ReduceMemory& memory, const std::uint32_t* codes, const Candidate* leaves,
                      std::uint32_t n, int top, cudaStream_t stream, const TakeLevel& take) {
    CubRunner runner(memory, stream);
    reduce_tile(runner, codes, leaves, n, top, take);
}

}  // namespace octavo::cuda
