// SPDX-License-Identifier: MIT
#include "octavo/backend/timed_queue.h"

#include <chrono>
#include <utility>

namespace octavo {
namespace {

const char* name_of(Pass pass) {
    constexpr const char* kNames[kPasses] = {"closest",    "any",     "beam",   "primary",
                                             "surface",    "gbuffer", "sky",    "lamp beam",
                                             "lamp",       "light",   "shade",  "ambient out",
                                             "shadow out", "looks",   "cached", "gbuffer looks"};
    return kNames[static_cast<int>(pass)];
}

class TimedQueue final : public PassQueue {
public:
    TimedQueue(std::unique_ptr<PassQueue> queue, PassTimes& times)
        : queue_(std::move(queue)), times_(times) {}

    [[nodiscard]] const DeviceInfo& info() const override { return queue_->info(); }
    [[nodiscard]] std::uint64_t allocate(std::uint64_t bytes) override {
        return queue_->allocate(bytes);
    }
    void release(std::uint64_t address) noexcept override { queue_->release(address); }
    void write(std::uint64_t address, std::span<const std::byte> bytes) override {
        queue_->write(address, bytes);
    }
    void read(std::uint64_t address, std::span<std::byte> bytes) override {
        queue_->read(address, bytes);
    }
    [[nodiscard]] shared::WordArray upload(std::span<const std::uint32_t> words) override {
        return queue_->upload(words);
    }
    void release(const shared::WordArray& words) noexcept override { queue_->release(words); }
    void run(Pass pass, const shared::RayJob& job, std::uint64_t threads) override {
        time(pass, job, threads);
    }
    void run(Pass pass, const shared::PixelJob& job, std::uint64_t threads) override {
        time(pass, job, threads);
    }
    void cut() override { queue_->cut(); }
    void finish() override { queue_->finish(); }

private:
    void time(Pass pass, const auto& job, std::uint64_t threads) {
        queue_->finish();
        const auto start = std::chrono::steady_clock::now();
        queue_->run(pass, job, threads);
        queue_->finish();
        times_[name_of(pass)] +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    std::unique_ptr<PassQueue> queue_;
    PassTimes& times_;
};

}  // namespace

std::unique_ptr<PassQueue> make_timed_queue(std::unique_ptr<PassQueue> queue, PassTimes& times) {
    return std::make_unique<TimedQueue>(std::move(queue), times);
}

}  // namespace octavo
