// SPDX-License-Identifier: MIT
#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

#include <string>

/// Vulkan's functions, found at run time: a program that links Octavo starts without a Vulkan
/// library, and only says so when a Vulkan device is asked for.
namespace octavo::vulkan {

#define OCTAVO_VULKAN_GLOBAL(X)           \
    X(vkCreateInstance)                   \
    X(vkEnumerateInstanceVersion)         \
    X(vkEnumerateInstanceLayerProperties) \
    X(vkEnumerateInstanceExtensionProperties)

#define OCTAVO_VULKAN_INSTANCE(X)               \
    X(vkDestroyInstance)                        \
    X(vkEnumeratePhysicalDevices)               \
    X(vkGetPhysicalDeviceProperties2)           \
    X(vkGetPhysicalDeviceFeatures2)             \
    X(vkGetPhysicalDeviceMemoryProperties)      \
    X(vkGetPhysicalDeviceQueueFamilyProperties) \
    X(vkCreateDevice)                           \
    X(vkGetDeviceProcAddr)

#define OCTAVO_VULKAN_DEVICE(X)      \
    X(vkDestroyDevice)               \
    X(vkGetDeviceQueue)              \
    X(vkCreateBuffer)                \
    X(vkDestroyBuffer)               \
    X(vkGetBufferMemoryRequirements) \
    X(vkGetBufferDeviceAddress)      \
    X(vkAllocateMemory)              \
    X(vkFreeMemory)                  \
    X(vkBindBufferMemory)            \
    X(vkMapMemory)                   \
    X(vkCreateShaderModule)          \
    X(vkDestroyShaderModule)         \
    X(vkCreatePipelineLayout)        \
    X(vkDestroyPipelineLayout)       \
    X(vkCreateComputePipelines)      \
    X(vkDestroyPipeline)             \
    X(vkCreateCommandPool)           \
    X(vkDestroyCommandPool)          \
    X(vkAllocateCommandBuffers)      \
    X(vkBeginCommandBuffer)          \
    X(vkEndCommandBuffer)            \
    X(vkResetCommandBuffer)          \
    X(vkCmdBindPipeline)             \
    X(vkCmdPushConstants)            \
    X(vkCmdDispatch)                 \
    X(vkCmdPipelineBarrier)          \
    X(vkCmdCopyBuffer)               \
    X(vkCreateFence)                 \
    X(vkDestroyFence)                \
    X(vkResetFences)                 \
    X(vkWaitForFences)               \
    X(vkQueueSubmit)                 \
    X(vkDeviceWaitIdle)

/// The library. Loaded once and kept.
struct Loader {
    std::string missing;  // why there is no Vulkan; empty where there is
    PFN_vkGetInstanceProcAddr vkGetInstanceProcAddr = nullptr;
#define OCTAVO_DECLARE(name) PFN_##name name = nullptr;
    OCTAVO_VULKAN_GLOBAL(OCTAVO_DECLARE)
#undef OCTAVO_DECLARE
};
[[nodiscard]] const Loader& loader();

struct InstanceFunctions {
#define OCTAVO_DECLARE(name) PFN_##name name = nullptr;
    OCTAVO_VULKAN_INSTANCE(OCTAVO_DECLARE)
#undef OCTAVO_DECLARE
    // of VK_EXT_debug_utils, where it was asked for
    PFN_vkCreateDebugUtilsMessengerEXT vkCreateDebugUtilsMessengerEXT = nullptr;
    PFN_vkDestroyDebugUtilsMessengerEXT vkDestroyDebugUtilsMessengerEXT = nullptr;

    void load(VkInstance instance);
};

struct DeviceFunctions {
#define OCTAVO_DECLARE(name) PFN_##name name = nullptr;
    OCTAVO_VULKAN_DEVICE(OCTAVO_DECLARE)
#undef OCTAVO_DECLARE

    void load(const InstanceFunctions& instance, VkDevice device);
};

/// "VK_ERROR_DEVICE_LOST"
[[nodiscard]] std::string result_name(VkResult result);

/// @throws Error  where a call failed: limit where memory is used up, else io; with what the caller
/// was doing and, of a lost device, what may have lost it
void check(VkResult result, const std::string& doing);

}  // namespace octavo::vulkan
