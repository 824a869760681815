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
#include "octavo/light/cell_views.h"
#include "octavo/render/effects.h"
#include "octavo/render/render_lit.h"
#include "octavo/trace/partitions.h"
#include "octavo/trace/wide.h"
#include "octavo/voxelize/tile_rasterizer.h"

namespace octavo {
namespace {

/// Rays that one task traces.
constexpr std::size_t kRaysPerTask = 1024;

class CpuDag final : public DeviceDag {
public:
    CpuDag(const Dag& dag, const Attributes& looks, const CellLight& cell_light)
        : words(dag), attributes(looks), light(cell_light), partitions(dag) {}
    Dag words;
    Attributes attributes;
    CellLight light;
    mutable Partitions partitions;  // for all calls
};

const CpuDag& own(const DeviceDag& dag) {
    return static_cast<const CpuDag&>(dag);
}
const Dag& words(const DeviceDag& dag) {
    return own(dag).words;
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

    [[nodiscard]] std::unique_ptr<DeviceDag> upload(const Dag& dag, const Attributes& attributes,
                                                    const CellLight& light) override {
        return std::make_unique<CpuDag>(dag, attributes, light);
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
            trace_any_wide(words(dag), rays.subspan(first, count), stop, found,
                           &own(dag).partitions);
            std::ranges::copy(found, occluded.subspan(first, count).begin());
        });
    }

    [[nodiscard]] Image render(const DeviceDag& dag, const Grid& grid,
                               const RenderOptions& options) override {
        RenderOptions own_looks = options;
        if (options.partitions == nullptr) own_looks.partitions = &own(dag).partitions;
        if (options.attributes != nullptr) {
            if (own(dag).attributes.empty() && !words(dag).empty())
                throw Error(Errc::bad_argument, "the DAG was uploaded without attributes");
            own_looks.attributes = &own(dag).attributes;
        }
        return octavo::render(words(dag), grid, own_looks);
    }

    [[nodiscard]] Image render_cached(const DeviceDag& dag, const Grid& grid,
                                      const RenderOptions& options) override {
        LitScene scene;
        scene.objects.push_back({.dag = words(dag),
                                 .grid = grid,
                                 .attributes = own(dag).attributes,
                                 .light = own(dag).light});
        scene.sky = options.sky.value_or(Sky::clear(options.up));
        return render_lit(scene, Lighting::cached, options);
    }

    void visibility(const DeviceDag& dag, const Grid& grid, std::span<const vec3> positions,
                    std::span<const vec3> normals, const VisibilityOptions& options,
                    std::span<float> shadow, std::span<float> ambient) override {
        const std::vector<dvec3> in_double(positions.begin(), positions.end());
        VisibilityOptions kept = options;
        if (options.partitions == nullptr) kept.partitions = &own(dag).partitions;
        octavo::visibility(words(dag), grid, in_double, normals, kept, shadow, ambient);
    }

    void looks(const DeviceDag& dag, const Grid& grid, std::span<const vec3> positions,
               std::span<const vec3> normals, const PointLooks& out) override {
        check(positions.size(), normals.size(), out);
        const Attributes& attributes = own(dag).attributes;
        const CellLight& light = own(dag).light;
        if (attributes.empty())
            throw Error(Errc::bad_argument, "the DAG was uploaded without attributes");
        if (!out.light.empty() && light.empty())
            throw Error(Errc::bad_argument, "the DAG was uploaded without stored light");
        const shared::DagView dag_view = shared::view(words(dag));
        for_each_task(positions.size(), [&](std::size_t first, std::size_t count) {
            for (std::size_t i = first; i < first + count; ++i) {
                vec3 albedo(0.0f), emission(0.0f), sent(0.0f);
                if (const auto before = lifted_start(grid, dvec3(positions[i]), normals[i], 1.0)) {
                    const dvec3 at = grid.to_grid(dvec3(positions[i]));
                    const vec3 normal = glm::normalize(normals[i]);
                    if (const auto cell = attributes.cell_at(at)) {
                        albedo = attributes.has_color()
                                     ? linear_from_srgb8(attributes.color(*cell, normal))
                                     : shared::clay();
                        emission = attributes.emission(*cell, normal);
                    }
                    const dvec3 voxel = glm::floor(at);
                    const shared::GridRay surface{ivec3(voxel), vec3(at - voxel), normal, 0.0f,
                                                  1e30f};
                    if (!out.light.empty())
                        sent = cached_light(
                            dag_view, shared::view(attributes.cells()), shared::view(light),
                            surface, {before->cell, before->frac, normal, shared::kFaceNone, 0, 1},
                            shared::kFaceNone);
                }
                if (!out.albedo.empty()) out.albedo[i] = albedo;
                if (!out.emission.empty()) out.emission[i] = emission;
                if (!out.light.empty()) out.light[i] = sent;
            }
        });
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
