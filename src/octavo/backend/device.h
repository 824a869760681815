// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "octavo/attributes/attributes.h"
#include "octavo/attributes/cell_light.h"
#include "octavo/construct/reduce.h"
#include "octavo/core/grid.h"
#include "octavo/dag/dag.h"
#include "octavo/render/image.h"
#include "octavo/render/render.h"
#include "octavo/render/visibility.h"
#include "octavo/trace/dag_view.h"

/// Who runs the rays: this machine's processor, or a GPU through CUDA or Vulkan. All give the same
/// voxels, because all compile the one text of trace/ and render/.
namespace octavo {

enum class DeviceKind { cpu, cuda, vulkan };

/// "cpu", "cuda", "vulkan"
[[nodiscard]] const char* device_kind_name(DeviceKind kind);

struct DeviceInfo {
    DeviceKind kind = DeviceKind::cpu;
    int index = 0;       // among the devices of its kind
    std::string name;    // as its driver tells it
    std::string type;    // "discrete GPU", "integrated GPU", "virtual GPU", "CPU"
    std::string driver;  // its name and version
    std::uint64_t memory_bytes = 0;
    std::vector<std::pair<std::string, std::uint64_t>> limits;
    std::string unusable;  // why it cannot be opened; empty where it can

    /// "vulkan:0"
    [[nodiscard]] std::string id() const;
};

struct DeviceList {
    std::vector<DeviceInfo> devices;  // the CPU, then CUDA's, then Vulkan's
    /// Why a kind has none: {"cuda", "no CUDA driver is installed"}.
    std::vector<std::pair<std::string, std::string>> missing;
};

/// Everything that rays can run on here. Never throws for a driver that is missing or broken.
[[nodiscard]] DeviceList list_devices();

/// A DAG in the memory of one device, which must outlive it; with what its cells look like and
/// their light, where they were uploaded too.
class DeviceDag {
public:
    virtual ~DeviceDag() = default;
};

/// Where Device::looks() writes: each empty, or as long as the positions. Linear light. Zero where
/// the point is not on a cell, or not finite.
struct PointLooks {
    std::span<vec3> albedo;    // of the cell at the point, on the side of its normal
    std::span<vec3> emission;  // radiance
    std::span<vec3> light;     // stored in the cells around: times the albedo, what is sent back
};

/// @throws Error  bad_argument where Device::looks() does for the lengths of the arrays
void check(std::size_t points, std::size_t normals, const PointLooks& out);

/// One device. Calls wait for their result; one thread at a time.
///
/// All functions throw Error: limit where the device's memory does not hold what was asked for,
/// io where the device fails or is lost, bad_argument as the functions of render/ do.
class Device {
public:
    virtual ~Device() = default;

    [[nodiscard]] virtual const DeviceInfo& info() const = 0;

    /// Copies a DAG to the device; on the CPU the words are shared.
    ///
    /// @param attributes  of this DAG; none: it is of clay
    /// @param light       of the attributes' cells; none: nothing is stored
    /// @throws Error      unsupported on a GPU where there are 2^32 cells or more
    [[nodiscard]] virtual std::unique_ptr<DeviceDag> upload(const Dag& dag,
                                                            const Attributes& attributes = {},
                                                            const CellLight& light = {}) = 0;

    /// Traces rays in grid space, see trace/traverse.h. `hits` and `occluded` are as long as
    /// `rays`; occluded is 1 where the ray hits something, else 0.
    ///
    /// @return  seconds that the tracing took, without copies to and from the device
    virtual double trace_closest(const DeviceDag& dag, std::span<const shared::GridRay> rays,
                                 const shared::Stop& stop, std::span<shared::GridHit> hits) = 0;
    virtual double trace_any(const DeviceDag& dag, std::span<const shared::GridRay> rays,
                             const shared::Stop& stop, std::span<std::uint32_t> occluded) = 0;

    /// The picture of octavo::render(): the same voxels in every pixel, but for rays that graze one
    /// within rounding; colours within rounding.
    /// options.attributes says whether to show those that were uploaded.
    /// @throws Error  unsupported on a GPU where only_on_cpu() names something; bad_argument where
    ///                options.attributes is there and none were uploaded
    [[nodiscard]] virtual Image render(const DeviceDag& dag, const Grid& grid,
                                       const RenderOptions& options) = 0;

    /// The picture of octavo::render_lit() with Lighting::cached, of one object in its own space:
    /// the uploaded light of the cells and no other. The sky is options.sky, or the clear one;
    /// lamps, ambient occlusion and the level of detail have no meaning.
    /// @throws Error  bad_argument where no light was uploaded
    [[nodiscard]] virtual Image render_cached(const DeviceDag& dag, const Grid& grid,
                                              const RenderOptions& options) = 0;

    /// octavo::visibility() for a G-buffer in host memory, positions in float. For one that is on
    /// the device already, see backend/cuda/effects.h and docs/embedding.md.
    virtual void visibility(const DeviceDag& dag, const Grid& grid, std::span<const vec3> positions,
                            std::span<const vec3> normals, const VisibilityOptions& options,
                            std::span<float> shadow, std::span<float> ambient) = 0;

    /// What the uploaded cells say of points of triangles, see PointLooks.
    /// @param normals  as long as positions, unit length
    /// @throws Error   bad_argument where an array has another length, or what is asked for was not
    ///                 uploaded
    virtual void looks(const DeviceDag& dag, const Grid& grid, std::span<const vec3> positions,
                       std::span<const vec3> normals, const PointLooks& out) = 0;
};

/// What of these options only the CPU draws; empty where a GPU draws all.
[[nodiscard]] std::string only_on_cpu(const RenderOptions& options);

/// Seconds that a GPU took for each of its passes, by name: "beam", "primary", "surface", "sky",
/// "lamp", "shade" and so on, see backend/passes.h.
using PassTimes = std::map<std::string, double>;

/// Opens a device by name: "cpu"; "cuda" or "vulkan", the best of its kind; "vulkan:1", one by its
/// number; or "auto", the best GPU, or the CPU where there is none.
///
/// @throws Error  bad_argument where the name is none of these; unsupported, saying why, where
/// there is no such device
/// @param times  where a GPU adds what its passes take; outlives the device, which then waits for
///               each pass, so that the whole is slower. The CPU has no passes.
[[nodiscard]] std::unique_ptr<Device> open_device(const std::string& name,
                                                  PassTimes* times = nullptr);

/// What reduces a build's tiles (BuildOptions::reduce) on a device: "cpu", "cuda" or "cuda:1".
/// @throws Error  as open_device()
[[nodiscard]] ReduceFunction reducer_on(const std::string& name);

}  // namespace octavo
