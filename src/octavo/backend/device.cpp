// SPDX-License-Identifier: MIT
#include "octavo/backend/device.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "octavo/backend/cpu/cpu_device.h"
#include "octavo/backend/gpu_device.h"
#include "octavo/backend/timed_queue.h"
#include "octavo/core/error.h"
#if OCTAVO_HAS_CUDA
#include "octavo/backend/cuda/cuda_queue.h"
#include "octavo/backend/cuda/reduce.h"
#endif
#if OCTAVO_HAS_VULKAN
#include "octavo/backend/vulkan/vulkan_queue.h"
#endif

namespace octavo {
namespace {

[[maybe_unused]] Error not_built(const char* kind) {
    return Error(Errc::unsupported, std::string("this build of Octavo has no ") + kind);
}

std::vector<DeviceInfo> list_cuda() {
#if OCTAVO_HAS_CUDA
    return cuda::list();
#else
    throw not_built("CUDA");
#endif
}

std::vector<DeviceInfo> list_vulkan() {
#if OCTAVO_HAS_VULKAN
    return vulkan::list();
#else
    throw not_built("Vulkan");
#endif
}

std::unique_ptr<PassQueue> open_cuda([[maybe_unused]] int index) {
#if OCTAVO_HAS_CUDA
    return cuda::open_queue(index);
#else
    throw not_built("CUDA");
#endif
}

std::unique_ptr<PassQueue> open_vulkan([[maybe_unused]] int index) {
#if OCTAVO_HAS_VULKAN
    return vulkan::open_queue({.device = index});
#else
    throw not_built("Vulkan");
#endif
}

struct NamedDevice {
    DeviceKind kind;
    int index;  // -1: the best
};

Error no_such(const std::string& name, const char* known) {
    return Error(Errc::bad_argument,
                 "'" + name + "' is no device for this: say " + known + "; see `octavo devices`");
}

/// "cuda", "vulkan:1"
NamedDevice parse(const std::string& name, const char* known) {
    const std::string_view text = name;
    const std::size_t colon = std::min(text.find(':'), text.size());
    NamedDevice device{DeviceKind::cuda, -1};
    if (text.substr(0, colon) == "vulkan")
        device.kind = DeviceKind::vulkan;
    else if (text.substr(0, colon) != "cuda")
        throw no_such(name, known);
    if (colon == text.size()) return device;
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + colon + 1, end, device.index);
    if (error != std::errc() || rest != end || device.index < 0) throw no_such(name, known);
    return device;
}

/// A driver that merely emulates a GPU is slower than what the CPU does by itself.
bool is_gpu(const DeviceInfo& device) {
    return device.kind != DeviceKind::cpu && device.type != "CPU" && device.unusable.empty();
}

/// The best GPU, or none.
std::unique_ptr<PassQueue> open_best() {
    const std::pair<std::vector<DeviceInfo> (*)(), std::unique_ptr<PassQueue> (*)(int)> kinds[] = {
        {list_cuda, open_cuda}, {list_vulkan, open_vulkan}};
    for (const auto& [list, open] : kinds) {
        try {
            for (const DeviceInfo& device : list())
                if (is_gpu(device)) return open(-1);
        } catch (const Error& error) {
            if (error.code() != Errc::unsupported) throw;
        }
    }
    return nullptr;
}

}  // namespace

const char* device_kind_name(DeviceKind kind) {
    switch (kind) {
        case DeviceKind::cuda:
            return "cuda";
        case DeviceKind::vulkan:
            return "vulkan";
        case DeviceKind::cpu:
            break;
    }
    return "cpu";
}

std::string DeviceInfo::id() const {
    const std::string kind_name = device_kind_name(kind);
    return kind == DeviceKind::cpu ? kind_name : kind_name + ":" + std::to_string(index);
}

DeviceList list_devices() {
    DeviceList all;
    all.devices.push_back(cpu_info());
    const auto add = [&](DeviceKind kind, const auto& list) {
        try {
            const std::vector<DeviceInfo> some = list();
            all.devices.insert(all.devices.end(), some.begin(), some.end());
            if (some.empty()) all.missing.emplace_back(device_kind_name(kind), "no device");
        } catch (const Error& error) {
            all.missing.emplace_back(device_kind_name(kind), error.what());
        }
    };
    add(DeviceKind::cuda, list_cuda);
    add(DeviceKind::vulkan, list_vulkan);
    return all;
}

void check(std::size_t points, std::size_t normals, const PointLooks& out) {
    const auto fits = [&](std::span<vec3> array) {
        return array.empty() || array.size() == points;
    };
    if (normals != points || !fits(out.albedo) || !fits(out.emission) || !fits(out.light))
        throw Error(Errc::bad_argument, "the arrays of a G-buffer differ in length");
}

std::string only_on_cpu(const RenderOptions& options) {
    if (options.primary) return "primary hits from triangles";
    if (!options.wide) return "rays one by one";
    return {};
}

std::unique_ptr<Device> open_device(const std::string& name, PassTimes* times) {
    std::unique_ptr<PassQueue> queue;
    if (name == "auto") {
        queue = open_best();
    } else if (name != "cpu") {
        const NamedDevice device = parse(name, "auto, cpu, cuda, vulkan, cuda:N or vulkan:N");
        queue =
            device.kind == DeviceKind::cuda ? open_cuda(device.index) : open_vulkan(device.index);
    }
    if (!queue) return make_cpu_device();
    if (times != nullptr) queue = make_timed_queue(std::move(queue), *times);
    return make_gpu_device(std::move(queue));
}

ReduceFunction reducer_on(const std::string& name) {
    if (name == "cpu") return {};
    constexpr const char* kKnown = "cpu, cuda or cuda:N";
    const NamedDevice device = parse(name, kKnown);
    if (device.kind != DeviceKind::cuda) throw no_such(name, kKnown);
#if OCTAVO_HAS_CUDA
    return cuda::make_reducer(device.index);
#else
    throw not_built("CUDA");
#endif
}

}  // namespace octavo
