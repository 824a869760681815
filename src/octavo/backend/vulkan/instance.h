// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "octavo/backend/device.h"
#include "octavo/backend/vulkan/loader.h"

namespace octavo::vulkan {

/// A Vulkan instance and what it knows about the devices.
class Instance {
public:
    /// @throws Error unsupported where there is no Vulkan, or no such layer
    explicit Instance(bool validation);
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    [[nodiscard]] const InstanceFunctions& functions() const { return functions_; }
    [[nodiscard]] const std::vector<VkPhysicalDevice>& devices() const { return devices_; }
    [[nodiscard]] DeviceInfo info(int device) const;

    /// The number of the best device that can be used. @throws Error unsupported: there is none
    [[nodiscard]] int best() const;

    /// What the validation layers have said.
    [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }

private:
    VkInstance instance_ = nullptr;
    VkDebugUtilsMessengerEXT messenger_ = nullptr;
    InstanceFunctions functions_;
    std::vector<VkPhysicalDevice> devices_;
    std::vector<std::string> messages_;
};

/// The first queue family that computes, or -1.
[[nodiscard]] int compute_family(const InstanceFunctions& functions, VkPhysicalDevice device);

/// The most bytes that one piece of memory, and one buffer, may have.
[[nodiscard]] std::uint64_t largest_allocation(const InstanceFunctions& functions,
                                               VkPhysicalDevice device);

}  // namespace octavo::vulkan
