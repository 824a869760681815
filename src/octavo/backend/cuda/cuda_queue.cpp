// SPDX-License-Identifier: MIT
#include "octavo/backend/cuda/cuda_queue.h"

#include <cuda_runtime.h>

#include <limits>

#include "octavo/backend/cuda/kernels.h"
#include "octavo/core/error.h"

namespace octavo::cuda {
namespace {

std::string version(int v) {
    return std::to_string(v / 1000) + "." + std::to_string(v % 1000 / 10);
}

int device_count() {
    int count = 0;
    check(cudaGetDeviceCount(&count), "looking for devices");
    return count;
}

DeviceInfo info_of(int device) {
    cudaDeviceProp p{};
    check(cudaGetDeviceProperties(&p, device), "asking for a device's properties");
    int driver = 0;
    check(cudaDriverGetVersion(&driver), "asking for the driver's version");
    DeviceInfo info;
    info.kind = DeviceKind::cuda;
    info.index = device;
    info.name = p.name;
    info.type = p.integrated ? "integrated GPU" : "discrete GPU";
    info.driver = "CUDA " + version(driver) + ", compute capability " + std::to_string(p.major) +
                  "." + std::to_string(p.minor);
    info.memory_bytes = p.totalGlobalMem;
    info.limits = {
        {"multiProcessorCount", static_cast<std::uint64_t>(p.multiProcessorCount)},
        {"l2CacheSize", static_cast<std::uint64_t>(p.l2CacheSize)},
        {"maxThreadsPerMultiProcessor", static_cast<std::uint64_t>(p.maxThreadsPerMultiProcessor)},
    };
    if (p.major * 10 + p.minor < 75) info.unusable = "its compute capability is below 7.5";
    return info;
}

/// Makes a device the thread's current one, and puts the caller's back.
class Current {
public:
    explicit Current(int device) {
        check(cudaGetDevice(&before_), "asking for the device");
        if (before_ != device) check(cudaSetDevice(device), "choosing a device");
    }
    ~Current() { cudaSetDevice(before_); }
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

private:
    int before_ = 0;
};

class Queue final : public PassQueue {
public:
    Queue(int device, cudaStream_t stream) : info_(info_of(device)), stream_(stream) {
        if (!info_.unusable.empty())
            throw Error(Errc::unsupported, info_.name + " cannot be used: " + info_.unusable);
        const Current current(device);
        int pools = 0;
        check(cudaDeviceGetAttribute(&pools, cudaDevAttrMemoryPoolsSupported, device),
              "asking for a device's properties");
        pools_ = pools != 0;
        if (stream != nullptr) return;
        check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "making a stream");
        own_stream_ = true;
    }
    ~Queue() override {
        if (own_stream_) cudaStreamDestroy(stream_);
    }

    [[nodiscard]] const DeviceInfo& info() const override { return info_; }

    [[nodiscard]] std::uint64_t allocate(std::uint64_t bytes) override {
        const Current current(info_.index);
        void* address = nullptr;
        check(pools_ ? cudaMallocAsync(&address, bytes, stream_) : cudaMalloc(&address, bytes),
              "taking " + std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB");
        return reinterpret_cast<std::uint64_t>(address);
    }

    void release(std::uint64_t address) noexcept override {
        if (pools_)
            cudaFreeAsync(reinterpret_cast<void*>(address), stream_);
        else
            cudaFree(reinterpret_cast<void*>(address));  // waits for the device first
    }

    void write(std::uint64_t address, std::span<const std::byte> bytes) override {
        const Current current(info_.index);
        check(cudaMemcpyAsync(reinterpret_cast<void*>(address), bytes.data(), bytes.size(),
                              cudaMemcpyHostToDevice, stream_),
              "copying to the device");
        // Pinned memory would be read later than now.
        check(cudaStreamSynchronize(stream_), "copying to the device");
    }

    void read(std::uint64_t address, std::span<std::byte> bytes) override {
        const Current current(info_.index);
        check(cudaMemcpyAsync(bytes.data(), reinterpret_cast<const void*>(address), bytes.size(),
                              cudaMemcpyDeviceToHost, stream_),
              "copying from the device");
        finish();
    }

    [[nodiscard]] shared::WordArray upload(std::span<const std::uint32_t> words) override {
        if (words.empty()) return {};
        const std::uint64_t address = allocate(words.size_bytes());
        try {
            write(address, std::as_bytes(words));
        } catch (...) {
            release(address);
            throw;
        }
        return {reinterpret_cast<const shared::uint*>(address)};
    }
    void release(const shared::WordArray& words) noexcept override {
        if (words.at != nullptr) release(reinterpret_cast<std::uint64_t>(words.at));
    }

    void run(Pass pass, const shared::RayJob& job, std::uint64_t threads) override {
        start(pass, job, threads);
    }
    void run(Pass pass, const shared::PixelJob& job, std::uint64_t threads) override {
        start(pass, job, threads);
    }

    void cut() override {}  // each kernel is a piece of its own

    void finish() override { check(cudaStreamSynchronize(stream_), "running passes"); }

private:
    template <typename Job>
    void start(Pass pass, const Job& job, std::uint64_t threads) {
        if (threads == 0) return;
        if (threads > std::numeric_limits<std::uint32_t>::max())
            throw Error(Errc::limit, "a pass has more than 2^32 threads");
        const Current current(info_.index);
        check(launch(pass, job, static_cast<std::uint32_t>(threads), stream_), "starting a pass");
    }

    DeviceInfo info_;
    cudaStream_t stream_ = nullptr;
    bool own_stream_ = false;
    bool pools_ = false;
};

}  // namespace

void check(int code, const std::string& doing) {
    const auto error = static_cast<cudaError_t>(code);
    if (error == cudaSuccess) return;
    if (error == cudaErrorNoDevice) throw Error(Errc::unsupported, "there is no CUDA device");
    if (error == cudaErrorInsufficientDriver)
        throw Error(Errc::unsupported,
                    "there is no CUDA driver, or it is older than this build's CUDA " +
                        version(CUDART_VERSION));
    const std::string text =
        "CUDA: " + doing + " failed: " + cudaGetErrorName(error) + ", " + cudaGetErrorString(error);
    if (error == cudaErrorNoKernelImageForDevice)
        throw Error(Errc::unsupported, text + "; build with its CMAKE_CUDA_ARCHITECTURES");
    throw Error(error == cudaErrorMemoryAllocation ? Errc::limit : Errc::io, text);
}

std::vector<DeviceInfo> list() {
    std::vector<DeviceInfo> devices;
    const int count = device_count();
    for (int i = 0; i < count; ++i) devices.push_back(info_of(i));
    return devices;
}

std::unique_ptr<PassQueue> open_queue(int device, CUstream_st* stream) {
    const int count = device_count();
    const int number = device < 0 ? 0 : device;
    if (number >= count)
        throw Error(Errc::unsupported, "there is no CUDA device " + std::to_string(number));
    return std::make_unique<Queue>(number, stream);
}

}  // namespace octavo::cuda
