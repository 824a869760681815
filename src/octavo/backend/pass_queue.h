// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "octavo/backend/device.h"
#include "octavo/light/cell_views.h"
#include "octavo/light/sky.h"
#include "octavo/render/effects.h"

#include "octavo/backend/passes.h"

namespace octavo {

/// The passes of passes.h.
enum class Pass {
    closest,
    any,
    beam,
    primary,
    surface,
    gbuffer,
    sky,
    lamp_beam,
    lamp,
    light,
    shade,
    ambient_out,
    shadow_out,
    looks,
    cached,
    gbuffer_looks,
};
inline constexpr int kPasses = 16;

/// Threads of a group: the 8x8 pixels of a tile.
inline constexpr std::uint64_t kGroupThreads = 64;

/// A device that runs passes over arrays in its own memory, in the order in which they are asked
/// for. What Vulkan and CUDA do differently is in here, and nothing else.
///
/// An address is a number that the device's threads understand; no dereferencing on the host.
/// Everything throws Error: limit where the device's memory is used up, io where it fails.
class PassQueue {
public:
    virtual ~PassQueue() = default;

    [[nodiscard]] virtual const DeviceInfo& info() const = 0;

    /// Memory on the device, 256-byte aligned, of undefined content.
    [[nodiscard]] virtual std::uint64_t allocate(std::uint64_t bytes) = 0;
    /// Gives it back when the passes that were asked for so far are done.
    virtual void release(std::uint64_t address) noexcept = 0;

    /// Copies to the device, after the passes asked for so far; `bytes` may change when it returns.
    virtual void write(std::uint64_t address, std::span<const std::byte> bytes) = 0;
    /// Copies from the device, after the passes asked for so far.
    virtual void read(std::uint64_t address, std::span<std::byte> bytes) = 0;

    /// Puts words that threads read one by one on the device: as one array, or in pages where that
    /// would be larger than the device allows. Of no words: nothing.
    [[nodiscard]] virtual shared::WordArray upload(std::span<const std::uint32_t> words) = 0;
    virtual void release(const shared::WordArray& words) noexcept = 0;

    /// Asks for threads 0 to `threads` - 1 of a pass; returns before they run.
    virtual void run(Pass pass, const shared::RayJob& job, std::uint64_t threads) = 0;
    virtual void run(Pass pass, const shared::PixelJob& job, std::uint64_t threads) = 0;

    /// A place where the work may be cut, so that no piece of it runs longer than a system's
    /// watchdog allows.
    virtual void cut() = 0;

    /// Waits until all that was asked for is done.
    virtual void finish() = 0;
};

/// Words on a device that threads only read: of a DAG, of what its cells look like.
class DeviceWords {
public:
    DeviceWords() = default;
    DeviceWords(PassQueue& queue, std::span<const std::uint32_t> words)
        : queue_(&queue), words_(queue.upload(words)) {}
    DeviceWords(DeviceWords&& other) noexcept { *this = std::move(other); }
    DeviceWords& operator=(DeviceWords&& other) noexcept {
        std::swap(queue_, other.queue_);
        std::swap(words_, other.words_);
        return *this;
    }
    ~DeviceWords() {
        if (queue_ && words_.at) queue_->release(words_);
    }

    [[nodiscard]] const shared::WordArray& get() const { return words_; }

private:
    PassQueue* queue_ = nullptr;
    shared::WordArray words_;
};

/// An array on a device, of what OCTAVO_ARRAY declares.
template <typename Array>
class DeviceArray {
public:
    using Value = std::remove_pointer_t<decltype(Array::at)>;

    DeviceArray() = default;
    DeviceArray(PassQueue& queue, std::uint64_t size)
        : queue_(&queue),
          size_(size),
          address_(queue.allocate(std::max<std::uint64_t>(size, 1) * sizeof(Value))) {}
    DeviceArray(PassQueue& queue, std::span<const Value> values)
        : DeviceArray(queue, values.size()) {
        if (!values.empty()) queue.write(address_, std::as_bytes(values));
    }
    DeviceArray(DeviceArray&& other) noexcept { *this = std::move(other); }
    DeviceArray& operator=(DeviceArray&& other) noexcept {
        std::swap(queue_, other.queue_);
        std::swap(size_, other.size_);
        std::swap(address_, other.address_);
        return *this;
    }
    ~DeviceArray() {
        if (queue_) queue_->release(address_);
    }

    [[nodiscard]] Array get() const { return {reinterpret_cast<Value*>(address_)}; }
    [[nodiscard]] std::uint64_t size() const { return size_; }

    /// The first values.size() of it.
    void read(std::span<Value> values) const {
        queue_->read(address_, std::as_writable_bytes(values));
    }
    [[nodiscard]] std::vector<Value> read() const {
        std::vector<Value> values(size_);
        read(values);
        return values;
    }

private:
    PassQueue* queue_ = nullptr;
    std::uint64_t size_ = 0;
    std::uint64_t address_ = 0;
};

}  // namespace octavo
