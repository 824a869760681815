// SPDX-License-Identifier: MIT
#include "octavo/backend/vulkan/instance.h"

#include <algorithm>
#include <cstring>

#include "octavo/backend/vulkan/vulkan_queue.h"
#include "octavo/core/error.h"

namespace octavo::vulkan {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* message,
                                          void* messages) {
    static_cast<std::vector<std::string>*>(messages)->emplace_back(message->pMessage);
    return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(std::vector<std::string>& messages) {
    VkDebugUtilsMessengerCreateInfoEXT info{};
    info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = on_message;
    info.pUserData = &messages;
    return info;
}

const char* type_name(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete GPU";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated GPU";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual GPU";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "CPU";
        default:
            return "other";
    }
}

/// What a device can and cannot; the chains point into the struct itself.
struct Description {
    VkPhysicalDeviceProperties2 properties{};
    VkPhysicalDeviceVulkan11Properties properties11{};
    VkPhysicalDeviceVulkan12Properties properties12{};
    VkPhysicalDeviceFeatures2 features{};
    VkPhysicalDeviceVulkan12Features features12{};

    Description(const InstanceFunctions& f, VkPhysicalDevice device) {
        properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
        f.vkGetPhysicalDeviceProperties2(device, &properties);
        if (properties.properties.apiVersion < VK_API_VERSION_1_2) return;
        properties11.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES;
        properties12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES;
        properties.pNext = &properties11;
        properties11.pNext = &properties12;
        f.vkGetPhysicalDeviceProperties2(device, &properties);
        features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
        features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
        features.pNext = &features12;
        f.vkGetPhysicalDeviceFeatures2(device, &features);
    }
    Description(const Description&) = delete;
    Description& operator=(const Description&) = delete;
};

std::string version(std::uint32_t v) {
    return std::to_string(VK_API_VERSION_MAJOR(v)) + "." + std::to_string(VK_API_VERSION_MINOR(v)) +
           "." + std::to_string(VK_API_VERSION_PATCH(v));
}

std::string lacks(const Description& d, int family) {
    if (d.properties.properties.apiVersion < VK_API_VERSION_1_2)
        return "it has Vulkan " + version(d.properties.properties.apiVersion) + "; 1.2 is needed";
    if (!d.features12.bufferDeviceAddress) return "it lacks bufferDeviceAddress";
    if (!d.features12.scalarBlockLayout) return "it lacks scalarBlockLayout";
    if (family < 0) return "it has no queue for compute";
    return {};
}

}  // namespace

bool has_validation_layer() {
    const Loader& l = loader();
    if (!l.missing.empty()) return false;
    std::uint32_t count = 0;
    l.vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    l.vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::ranges::any_of(layers, [](const VkLayerProperties& layer) {
        return std::strcmp(layer.layerName, kValidationLayer) == 0;
    });
}

int compute_family(const InstanceFunctions& f, VkPhysicalDevice device) {
    std::uint32_t count = 0;
    f.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    f.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    for (std::uint32_t i = 0; i < count; ++i)
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) return static_cast<int>(i);
    return -1;
}

std::uint64_t largest_allocation(const InstanceFunctions& f, VkPhysicalDevice device) {
    return Description(f, device).properties11.maxMemoryAllocationSize;
}

Instance::Instance(bool validation) {
    const Loader& l = loader();
    if (!l.missing.empty()) throw Error(Errc::unsupported, l.missing);
    if (validation && !has_validation_layer())
        throw Error(Errc::unsupported,
                    "the Vulkan validation layer is not installed "
                    "(Debian: vulkan-validationlayers)");
    VkApplicationInfo application{};
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.pApplicationName = "octavo";
    application.apiVersion = VK_API_VERSION_1_2;
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &application;
    const VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(messages_);
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    if (validation) {
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &kValidationLayer;
        info.enabledExtensionCount = 1;
        info.ppEnabledExtensionNames = &extension;
        info.pNext = &messenger;
    }
    const VkResult result = l.vkCreateInstance(&info, nullptr, &instance_);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        throw Error(
            Errc::unsupported,
            "no Vulkan driver is installed (Debian: mesa-vulkan-drivers, or your GPU's own)");
    check(result, "making an instance");
    functions_.load(instance_);
    if (validation)
        check(
            functions_.vkCreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_),
            "listening to the validation layers");

    std::uint32_t count = 0;
    if (functions_.vkEnumeratePhysicalDevices(instance_, &count, nullptr) == VK_SUCCESS) {
        devices_.resize(count);
        functions_.vkEnumeratePhysicalDevices(instance_, &count, devices_.data());
        devices_.resize(count);
    }
}

Instance::~Instance() {
    if (instance_ == nullptr) return;
    if (messenger_ != nullptr)
        functions_.vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
    functions_.vkDestroyInstance(instance_, nullptr);
}

DeviceInfo Instance::info(int device) const {
    const VkPhysicalDevice handle = devices_[static_cast<std::size_t>(device)];
    const Description d(functions_, handle);
    const VkPhysicalDeviceProperties& p = d.properties.properties;
    DeviceInfo info;
    info.kind = DeviceKind::vulkan;
    info.index = device;
    info.name = p.deviceName;
    info.type = type_name(p.deviceType);
    info.driver = d.properties12.driverName;
    if (*d.properties12.driverInfo != '\0')
        info.driver += std::string(", ") + d.properties12.driverInfo;
    info.driver += ", Vulkan " + version(p.apiVersion);
    VkPhysicalDeviceMemoryProperties memory{};
    functions_.vkGetPhysicalDeviceMemoryProperties(handle, &memory);
    for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
        if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
            info.memory_bytes += memory.memoryHeaps[i].size;
    info.limits = {
        {"maxStorageBufferRange", p.limits.maxStorageBufferRange},
        {"maxMemoryAllocationSize", d.properties11.maxMemoryAllocationSize},
        {"maxComputeWorkGroupCount", p.limits.maxComputeWorkGroupCount[0]},
        {"maxComputeWorkGroupInvocations", p.limits.maxComputeWorkGroupInvocations},
        {"subgroupSize", d.properties11.subgroupSize},
    };
    info.unusable = lacks(d, compute_family(functions_, handle));
    return info;
}

int Instance::best() const {
    const auto rank = [](const std::string& type) {
        const char* const order[] = {"discrete GPU", "integrated GPU", "virtual GPU", "CPU"};
        return std::ranges::find(order, type) - std::begin(order);
    };
    int best = -1;
    std::ptrdiff_t best_rank = 0;
    std::string why = "no Vulkan driver is installed that works with a device of this machine";
    for (int i = 0; i < static_cast<int>(devices_.size()); ++i) {
        const DeviceInfo device = info(i);
        if (!device.unusable.empty()) {
            why = device.name + " cannot be used: " + device.unusable;
            continue;
        }
        if (best >= 0 && rank(device.type) >= best_rank) continue;
        best = i;
        best_rank = rank(device.type);
    }
    if (best < 0) throw Error(Errc::unsupported, why);
    return best;
}

std::vector<DeviceInfo> list() {
    const Instance instance(false);
    std::vector<DeviceInfo> devices;
    for (int i = 0; i < static_cast<int>(instance.devices().size()); ++i)
        devices.push_back(instance.info(i));
    return devices;
}

}  // namespace octavo::vulkan
