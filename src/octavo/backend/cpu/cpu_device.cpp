// SPDX-License-Identifier: MIT
#include "octavo/backend/cpu/cpu_device.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>
#include <vector>

#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"
#include "octavo/trace/wide.h"
#include "octavo/voxelize/tile_rasterizer.h"

namespace octavo {
namespace {

/// Rays that one task traces.
constexpr std::size_t kRaysPerTask = 1024;

class CpuDag final : public DeviceDag {
public:
    explicit CpuDag(const Dag& dag) : words(dag) {}
    Dag words;
};

const Dag& words(const DeviceDag& dag) {
    return static_cast<const CpuDag&>(dag).words;
}

/// Calls trace(first, count) for parts of an array, on all threads. @return the seconds it took
template <typename Trace>
double for_each_task(std::size_t count, const Trace& trace) {
    const auto start = std::chrono::steady_clock::now();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (count + kRaysPerTask - 1) / kRaysPerTask),
                      [&](const tbb::blocked_range<std::size_t>& tasks) {
                          for (std::size_t i = tasks.begin(); i != tasks.end(); ++i)
                              trace(i * kRaysPerTask,
                                    std::min(kRaysPerTask, count - i * kRaysPerTask));
                      });
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class CpuDevice final : public Device {
public:
    [[nodiscard]] const DeviceInfo& info() const override { return info_; }

    [[nodiscard]] std::unique_ptr<DeviceDag> upload(const Dag& dag) override {
        return std::make_unique<CpuDag>(dag);
    }

    double trace_closest(const DeviceDag& dag, std::span<const shared::GridRay> rays,
                         const shared::Stop& stop, std::span<shared::GridHit> hits) override {
        return for_each_task(rays.size(), [&](std::size_t first, std::size_t count) {
            trace_closest_wide(words(dag), rays.subspan(first, count), stop,
                               hits.subspan(first, count));
        });
    }

    double trace_any(const DeviceDag& dag, std::span<const shared::GridRay> rays,
                     const shared::Stop& stop, std::span<std::uint32_t> occluded) override {
        return for_each_task(rays.size(), [&](std::size_t first, std::size_t count) {
            std::vector<std::uint8_t> found(count);
            trace_any_wide(words(dag), rays.subspan(first, count), stop, found);
            std::ranges::copy(found, occluded.subspan(first, count).begin());
        });
    }

    [[nodiscard]] Image render(const DeviceDag& dag, const Grid& grid,
                               const RenderOptions& options) override {
        return octavo::render(words(dag), grid, options);
    }

    void visibility(const DeviceDag& dag, const Grid& grid, std::span<const vec3> positions,
                    std::span<const vec3> normals, const VisibilityOptions& options,
                    std::span<float> shadow, std::span<float> ambient) override {
        const std::vector<dvec3> in_double(positions.begin(), positions.end());
        octavo::visibility(words(dag), grid, in_double, normals, options, shadow, ambient);
    }

private:
    DeviceInfo info_ = cpu_info();
};

std::string processor_name() {
    std::ifstream cpuinfo("/proc/cpuinfo");
    for (std::string line; std::getline(cpuinfo, line);)
        if (line.starts_with("model name"))
            if (const auto colon = line.find(": "); colon != std::string::npos)
                return line.substr(colon + 2);
    return "processor";
}

}  // namespace

DeviceInfo cpu_info() {
    DeviceInfo info;
    info.kind = DeviceKind::cpu;
    info.name = processor_name();
    info.type = "CPU";
    info.driver = std::string("SIMD ") + simd_targets().front();
    info.memory_bytes = machine_memory_bytes();
    info.limits = {{"threads", static_cast<std::uint64_t>(available_threads())}};
    return info;
}

std::unique_ptr<Device> make_cpu_device() {
    return std::make_unique<CpuDevice>();
}

}  // namespace octavo
