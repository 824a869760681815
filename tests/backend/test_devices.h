// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "backend/host_queue.h"
#include "octavo/backend/gpu_device.h"
#include "octavo/construct/build.h"
#include "octavo/core/error.h"
#if OCTAVO_HAS_VULKAN
#include "octavo/backend/vulkan/vulkan_queue.h"
#endif

namespace octavo::test {

inline BuildResult build_at(const Scene& scene, int depth) {
    BuildOptions options;
    options.depth = depth;
    return build(scene, options);
}

/// A device under test. Those that are missing say why: the test is skipped.
struct TestDevice {
    std::unique_ptr<Device> device;
    std::string missing;
    const std::vector<std::string>* messages = nullptr;  // of the Vulkan validation layers
};

/// "host", the passes in a loop; "cuda"; "vulkan" with the validation layers on; "vulkan_pages",
/// the same with DAGs in pages of 4 KiB.
inline TestDevice open_test_device(const std::string& name) {
    TestDevice opened;
    try {
        if (name == "host") {
            opened.device = make_gpu_device(std::make_unique<HostQueue>());
        } else if (name == "cuda") {
            opened.device = open_device("cuda");
        } else {
#if OCTAVO_HAS_VULKAN
            auto queue = vulkan::open_queue(
                {.page_bytes = name == "vulkan_pages" ? 4096u : 0u, .validation = true});
            opened.messages = &queue->messages();
            opened.device = make_gpu_device(std::move(queue));
#else
            opened.missing = "this build has no Vulkan";
#endif
        }
    } catch (const Error& error) {
        if (error.code() != Errc::unsupported) throw;
        opened.missing = error.what();
    }
    return opened;
}

/// Opens the device of a parameter in `device`, or skips the test; no message from the validation
/// layers may be there at its end.
class OnDevice : public testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        opened_ = open_test_device(GetParam());
        if (!opened_.missing.empty()) GTEST_SKIP() << GetParam() << ": " << opened_.missing;
    }
    void TearDown() override {
        if (opened_.messages == nullptr) return;
        for (const std::string& message : *opened_.messages) ADD_FAILURE() << message;
    }
    Device& device() { return *opened_.device; }

private:
    TestDevice opened_;
};

inline const auto kTestDevices = testing::Values("host", "cuda", "vulkan", "vulkan_pages");
inline std::string device_name(const testing::TestParamInfo<const char*>& info) {
    return info.param;
}

}  // namespace octavo::test
