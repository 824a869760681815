// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <cstring>

#include "octavo/backend/pass_queue.h"

namespace octavo::test {

/// A device whose threads are a loop on the host. It runs the text that nvcc compiles for CUDA, so
/// what orders the passes, and the passes, are tested where there is no GPU.
class HostQueue final : public PassQueue {
public:
    [[nodiscard]] const DeviceInfo& info() const override { return info_; }
    [[nodiscard]] std::uint64_t allocate(std::uint64_t bytes) override {
        ++allocations;
        void* memory = std::malloc(bytes);
        std::memset(memory, 0x7f, bytes);  // of undefined content
        return reinterpret_cast<std::uint64_t>(memory);
    }
    void release(std::uint64_t address) noexcept override {
        --allocations;
        std::free(reinterpret_cast<void*>(address));
    }
    void write(std::uint64_t address, std::span<const std::byte> bytes) override {
        std::memcpy(reinterpret_cast<void*>(address), bytes.data(), bytes.size());
    }
    void read(std::uint64_t address, std::span<std::byte> bytes) override {
        std::memcpy(bytes.data(), reinterpret_cast<const void*>(address), bytes.size());
    }
    [[nodiscard]] shared::WordArray upload(std::span<const std::uint32_t> words) override {
        if (words.empty()) return {};
        const std::uint64_t address = allocate(words.size_bytes());
        write(address, std::as_bytes(words));
        return {reinterpret_cast<const shared::uint*>(address)};
    }
    void release(const shared::WordArray& words) noexcept override {
        if (words.at != nullptr) release(reinterpret_cast<std::uint64_t>(words.at));
    }
    void run(Pass pass, const shared::RayJob& job, std::uint64_t threads) override {
        for (std::uint32_t i = 0; i < threads; ++i)
            pass == Pass::closest ? closest_pass(job, i) : any_pass(job, i);
    }
    void run(Pass pass, const shared::PixelJob& job, std::uint64_t threads) override {
        for (std::uint32_t i = 0; i < threads; ++i) run_one(pass, job, i);
    }
    void cut() override {}
    void finish() override {}

    int allocations = 0;

private:
    static void run_one(Pass pass, const shared::PixelJob& job, std::uint32_t i) {
        switch (pass) {
            case Pass::beam:
                return beam_pass(job, i);
            case Pass::primary:
                return primary_pass(job, i);
            case Pass::surface:
                return surface_pass(job, i);
            case Pass::gbuffer:
                return gbuffer_pass(job, i);
            case Pass::sky:
                return sky_pass(job, i);
            case Pass::lamp_beam:
                return lamp_beam_pass(job, i);
            case Pass::lamp:
                return lamp_pass(job, i);
            case Pass::light:
                return light_pass(job, i);
            case Pass::shade:
                return shade_pass(job, i);
            case Pass::ambient_out:
                return ambient_out_pass(job, i);
            case Pass::shadow_out:
                return shadow_out_pass(job, i);
            case Pass::looks:
                return looks_pass(job, i);
            case Pass::cached:
                return cached_pass(job, i);
            case Pass::gbuffer_looks:
                return gbuffer_looks_pass(job, i);
            default:
                std::abort();
        }
    }

    DeviceInfo info_ = [] {
        DeviceInfo info;
        info.name = "host";
        info.type = "CPU";
        return info;
    }();
};

}  // namespace octavo::test
