// SPDX-License-Identifier: MIT
#include "octavo/backend/vulkan/loader.h"

#include <dlfcn.h>

#include "octavo/core/error.h"

namespace octavo::vulkan {
namespace {

Loader load_library() {
    Loader l;
    void* library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
        l.missing = "no Vulkan library is installed (libvulkan.so.1; Debian: libvulkan1)";
        return l;
    }
    l.vkGetInstanceProcAddr =
        reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
    if (l.vkGetInstanceProcAddr == nullptr) {
        l.missing = "libvulkan.so.1 is no Vulkan library";
        return l;
    }
#define OCTAVO_LOAD(name) \
    l.name = reinterpret_cast<PFN_##name>(l.vkGetInstanceProcAddr(nullptr, #name));
    OCTAVO_VULKAN_GLOBAL(OCTAVO_LOAD)
#undef OCTAVO_LOAD
    if (l.vkCreateInstance == nullptr || l.vkEnumerateInstanceVersion == nullptr)
        l.missing = "the Vulkan library is older than 1.1";
    return l;
}

}  // namespace

const Loader& loader() {
    static const Loader loaded = load_library();
    return loaded;
}

void InstanceFunctions::load(VkInstance instance) {
    const auto get = loader().vkGetInstanceProcAddr;
#define OCTAVO_LOAD(name) name = reinterpret_cast<PFN_##name>(get(instance, #name));
    OCTAVO_VULKAN_INSTANCE(OCTAVO_LOAD)
    OCTAVO_LOAD(vkCreateDebugUtilsMessengerEXT)
    OCTAVO_LOAD(vkDestroyDebugUtilsMessengerEXT)
#undef OCTAVO_LOAD
}

void DeviceFunctions::load(const InstanceFunctions& instance, VkDevice device) {
#define OCTAVO_LOAD(name) \
    name = reinterpret_cast<PFN_##name>(instance.vkGetDeviceProcAddr(device, #name));
    OCTAVO_VULKAN_DEVICE(OCTAVO_LOAD)
#undef OCTAVO_LOAD
}

std::string result_name(VkResult result) {
    switch (result) {
#define OCTAVO_NAME(name) \
    case name:            \
        return #name;
        OCTAVO_NAME(VK_ERROR_OUT_OF_HOST_MEMORY)
        OCTAVO_NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY)
        OCTAVO_NAME(VK_ERROR_INITIALIZATION_FAILED)
        OCTAVO_NAME(VK_ERROR_DEVICE_LOST)
        OCTAVO_NAME(VK_ERROR_MEMORY_MAP_FAILED)
        OCTAVO_NAME(VK_ERROR_LAYER_NOT_PRESENT)
        OCTAVO_NAME(VK_ERROR_EXTENSION_NOT_PRESENT)
        OCTAVO_NAME(VK_ERROR_FEATURE_NOT_PRESENT)
        OCTAVO_NAME(VK_ERROR_INCOMPATIBLE_DRIVER)
        OCTAVO_NAME(VK_ERROR_TOO_MANY_OBJECTS)
        OCTAVO_NAME(VK_ERROR_FRAGMENTATION)
        OCTAVO_NAME(VK_ERROR_UNKNOWN)
#undef OCTAVO_NAME
        default:
            return "VkResult " + std::to_string(static_cast<int>(result));
    }
}

void check(VkResult result, const std::string& doing) {
    if (result == VK_SUCCESS) return;
    const std::string text = "Vulkan: " + doing + " failed: " + result_name(result);
    if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY)
        throw Error(Errc::limit, text);
    if (result == VK_ERROR_DEVICE_LOST)
        throw Error(Errc::io,
                    text +
                        "; the driver stopped the device, as after a pass that ran longer "
                        "than the system's watchdog allows; open it anew");
    throw Error(Errc::io, text);
}

}  // namespace octavo::vulkan
