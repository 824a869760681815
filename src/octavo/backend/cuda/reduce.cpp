// SPDX-License-Identifier: MIT
#include "octavo/backend/cuda/reduce.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "octavo/backend/cuda/cuda_queue.h"
#include "octavo/backend/cuda/reduce_runner.h"
#include "octavo/core/error.h"

namespace octavo::cuda {
namespace {

/// The device's memory for one tile, kept for the next.
class Memory final : public ReduceMemory {
public:
    explicit Memory(PassQueue& queue) : queue_(queue) {}
    ~Memory() override {
        for (const auto& [use, part] : parts_) queue_.release(part.address);
    }

    void* array(const char* use, std::uint64_t bytes) override {
        Part& part = parts_[use];
        if (part.bytes < bytes) {
            if (part.address != 0) queue_.release(part.address);
            part = {};
            const std::uint64_t more = bytes + bytes / 4;
            part.address = queue_.allocate(more);
            part.bytes = more;
        }
        return reinterpret_cast<void*>(part.address);
    }

    void check(cudaError_t error) override { cuda::check(error, "reducing a tile"); }

private:
    struct Part {
        std::uint64_t address = 0;
        std::uint64_t bytes = 0;
    };
    PassQueue& queue_;
    std::map<std::string, Part> parts_;
};

class Reducer {
public:
    explicit Reducer(int device) : device_(device) {
        check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "making a stream");
        queue_ = open_queue(device, stream_);
        memory_ = std::make_unique<Memory>(*queue_);
    }
    ~Reducer() {
        memory_.reset();
        queue_.reset();
        cudaStreamDestroy(stream_);
    }
    Reducer(const Reducer&) = delete;
    Reducer& operator=(const Reducer&) = delete;

    void reduce(NodeStore& store, const TileOctree& octree) {
        const std::lock_guard lock(mutex_);
        check(cudaSetDevice(device_ < 0 ? 0 : device_), "choosing a device");
        codes_.clear();
        candidates_.clear();
        for (const LeafBlock& leaf : blocks_of(octree, store.top())) {
            codes_.push_back(leaf.code);
            candidates_.push_back({{static_cast<std::uint32_t>(leaf.voxels),
                                    static_cast<std::uint32_t>(leaf.voxels >> 32)}});
        }
        const auto n = static_cast<std::uint32_t>(codes_.size());
        auto* codes = put("leaf codes", std::span<const std::uint32_t>(codes_));
        auto* candidates = put("leaves", std::span<const Candidate>(candidates_));
        reduce_on_device(*memory_, codes, candidates, n, store.top(), stream_,
                         [&](int height, const std::uint32_t* words, std::uint32_t count) {
                             words_.resize(count);
                             queue_->read(reinterpret_cast<std::uint64_t>(words),
                                          std::as_writable_bytes(std::span(words_)));
                             store.level(height).assign(words_);
                         });
    }

private:
    template <typename T>
    T* put(const char* use, std::span<const T> values) {
        void* address = memory_->array(use, values.size_bytes());
        queue_->write(reinterpret_cast<std::uint64_t>(address), std::as_bytes(values));
        return static_cast<T*>(address);
    }

    int device_;
    std::mutex mutex_;
    cudaStream_t stream_ = nullptr;
    std::unique_ptr<PassQueue> queue_;
    std::unique_ptr<Memory> memory_;
    std::vector<std::uint32_t> codes_;
    std::vector<Candidate> candidates_;
    std::vector<std::uint32_t> words_;
};

}  // namespace

ReduceFunction make_reducer(int device) {
    (void)open_queue(device);  // says what is wrong with the device, before a stream is made
    auto reducer = std::make_shared<Reducer>(device);
    return
        [reducer](NodeStore& store, const TileOctree& octree) { reducer->reduce(store, octree); };
}

}  // namespace octavo::cuda
