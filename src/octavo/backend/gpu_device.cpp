// SPDX-License-Identifier: MIT
#include "octavo/backend/gpu_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>

#include "octavo/backend/device.h"
#include "octavo/backend/gpu_visibility.h"
#include "octavo/core/error.h"
#include "octavo/render/render_lit.h"
#include "octavo/render/settings.h"

namespace octavo {
namespace {

constexpr int kTile = 8;
constexpr std::uint64_t kTilePixels = 64;

/// Rays of a list that are on the device at once.
constexpr std::uint64_t kRaysAtOnce = 1 << 20;

/// Tiles of a picture that are on the device at once: half a million pixels, which fill any GPU and
/// take some 75 MB.
constexpr int kTilesAtOnce = 8192;

class GpuDag final : public DeviceDag {
public:
    GpuDag(PassQueue& queue, const Dag& dag, const Attributes& attributes, const CellLight& light)
        : host(dag), model(queue, dag, attributes, light), view(model.dag) {}

    Dag host;
    GpuModel model;
    shared::DagView view;
};

/// The arrays of a band of pixels, and the job that knows them.
struct Band {
    Band(PassQueue& queue, std::uint64_t pixels, bool colored)
        : starts(queue, pixels / kTilePixels),
          hits(queue, pixels),
          depths(queue, pixels),
          points(queue, pixels),
          sky_seen(queue, pixels),
          lamp_times(queue, pixels),
          lamp_seen(queue, pixels),
          light(queue, pixels),
          colors(queue, pixels),
          albedos(queue, colored ? pixels : 0),
          emissions(queue, colored ? pixels : 0) {
        job.starts = starts.get();
        job.hits = hits.get();
        job.depths = depths.get();
        job.points = points.get();
        job.sky_seen = sky_seen.get();
        job.lamp_times = lamp_times.get();
        job.lamp_seen = lamp_seen.get();
        job.light = light.get();
        job.colors = colors.get();
        job.albedos = albedos.get();
        job.emissions = emissions.get();
    }

    DeviceArray<shared::FloatArray> starts;
    DeviceArray<shared::HitArray> hits;
    DeviceArray<shared::FloatArray> depths;
    DeviceArray<shared::PointArray> points;
    DeviceArray<shared::UintArray> sky_seen;
    DeviceArray<shared::LightArray> lamp_times;
    DeviceArray<shared::LightArray> lamp_seen;
    DeviceArray<shared::ColorArray> light;
    DeviceArray<shared::ColorArray> colors;
    DeviceArray<shared::ColorArray> albedos;
    DeviceArray<shared::ColorArray> emissions;
    shared::PixelJob job{};
    std::uint64_t in_use = 0;  // pixels
};

/// A sky whose picture, if it is one, is on the device.
struct GpuSky {
    GpuSky(PassQueue& queue, const Sky& sky) : pixels(queue, sky.pixels()), view(sky.view()) {
        view.pixels.at = pixels.get().at;
    }

    DeviceArray<shared::ColorArray> pixels;
    shared::SkyView view;
};

class GpuDevice final : public Device {
public:
    explicit GpuDevice(std::unique_ptr<PassQueue> queue) : queue_(std::move(queue)) {}

    [[nodiscard]] const DeviceInfo& info() const override { return queue_->info(); }

    [[nodiscard]] std::unique_ptr<DeviceDag> upload(const Dag& dag, const Attributes& attributes,
                                                    const CellLight& light) override {
        return std::make_unique<GpuDag>(*queue_, dag, attributes, light);
    }

    double trace_closest(const DeviceDag& dag, std::span<const shared::GridRay> rays,
                         const shared::Stop& stop, std::span<shared::GridHit> hits) override {
        return trace(
            Pass::closest, dag, rays, stop, [&](std::size_t first, const shared::RayJob& job) {
                const std::size_t some = std::min<std::size_t>(kRaysAtOnce, rays.size() - first);
                read(job.hits.at, hits.subspan(first, some));
            });
    }
    double trace_any(const DeviceDag& dag, std::span<const shared::GridRay> rays,
                     const shared::Stop& stop, std::span<std::uint32_t> occluded) override {
        return trace(Pass::any, dag, rays, stop, [&](std::size_t first, const shared::RayJob& job) {
            const std::size_t some = std::min<std::size_t>(kRaysAtOnce, rays.size() - first);
            read(job.occluded.at, occluded.subspan(first, some));
        });
    }

    [[nodiscard]] Image render(const DeviceDag& dag, const Grid& grid,
                               const RenderOptions& options) override {
        const auto& gpu_dag = static_cast<const GpuDag&>(dag);
        if (const std::string what = only_on_cpu(options); !what.empty())
            throw Error(Errc::unsupported, "a GPU draws no picture with " + what);
        if (options.attributes != nullptr && !gpu_dag.model.has_looks && !gpu_dag.host.empty())
            throw Error(Errc::bad_argument, "the DAG was uploaded without attributes");
        const RenderSettings settings = settle(gpu_dag.host, grid, options);
        std::vector<GpuLamp> lamps;
        for (const Light& light : settings.lights) lamps.emplace_back(*queue_, light, grid);
        const bool colored = options.attributes != nullptr && gpu_dag.model.has_looks;
        return draw(gpu_dag, grid, options, settings.rays, colored, [&](Band& band, bool begins) {
            shared::PixelJob& job = band.job;
            if (begins) {
                job.stop = settings.primary_stop;
                job.up = settings.up;
                job.sky_radius = settings.ao_radius;
                job.sky_stop = settings.ao_stop;
            } else {
                add_sample(band, options, lamps);
            }
        });
    }

    [[nodiscard]] Image render_cached(const DeviceDag& dag, const Grid& grid,
                                      const RenderOptions& options) override {
        const auto& gpu_dag = static_cast<const GpuDag&>(dag);
        check(options);
        if (!gpu_dag.model.has_light && !gpu_dag.host.empty())
            throw Error(Errc::bad_argument, "an object has no stored light");
        RenderOptions lit = options;
        if (!lit.sky) lit.sky = Sky::clear(options.up);
        const PixelRays rays(picture_camera(options, framed_box(gpu_dag.host, grid)), grid,
                             options.width, options.height);
        return draw(gpu_dag, grid, lit, rays, false, [&](Band& band, bool begins) {
            if (begins) {
                band.job.looks = gpu_dag.model.looks;
                band.job.cell_light = gpu_dag.model.light;
            } else {
                queue_->run(Pass::cached, band.job, band.in_use);
            }
        });
    }

    void looks(const DeviceDag& dag, const Grid& grid, std::span<const vec3> positions,
               std::span<const vec3> normals, const PointLooks& out) override {
        check(positions.size(), normals.size(), out);
        const DeviceArray<shared::FloatArray> p(*queue_, flat(positions));
        const DeviceArray<shared::FloatArray> n(*queue_, flat(normals));
        const DeviceArray<shared::FloatArray> albedo(*queue_, 3 * out.albedo.size());
        const DeviceArray<shared::FloatArray> emission(*queue_, 3 * out.emission.size());
        const DeviceArray<shared::FloatArray> light(*queue_, 3 * out.light.size());
        const auto wanted = [](const DeviceArray<shared::FloatArray>& array) {
            return array.size() == 0 ? nullptr : array.get().at;
        };
        queue_looks(*queue_, static_cast<const GpuDag&>(dag).model, grid,
                    {p.get().at, n.get().at, 3, 3, positions.size()},
                    {wanted(albedo), wanted(emission), wanted(light)});
        const auto take = [](const DeviceArray<shared::FloatArray>& from, std::span<vec3> to) {
            if (!to.empty())
                from.read(std::span(reinterpret_cast<float*>(to.data()), 3 * to.size()));
        };
        take(albedo, out.albedo);
        take(emission, out.emission);
        take(light, out.light);
    }

    void visibility(const DeviceDag& dag, const Grid& grid, std::span<const vec3> positions,
                    std::span<const vec3> normals, const VisibilityOptions& options,
                    std::span<float> shadow, std::span<float> ambient) override {
        check(options, positions.size(), normals.size(), shadow.size(), ambient.size());
        const bool sky = options.ao_samples > 0 && !ambient.empty();
        const bool lit = options.light && !shadow.empty();
        const DeviceArray<shared::FloatArray> p(*queue_, flat(positions));
        const DeviceArray<shared::FloatArray> n(*queue_, flat(normals));
        const DeviceArray<shared::FloatArray> shadow_out(*queue_, lit ? shadow.size() : 0);
        const DeviceArray<shared::FloatArray> sky_out(*queue_, sky ? ambient.size() : 0);
        const GpuLamp lamp(*queue_, options.light.value_or(Light{}), grid);
        queue_visibility(*queue_, static_cast<const GpuDag&>(dag).view, grid,
                         {p.get().at, n.get().at, 3, 3, positions.size()}, lit ? &lamp : nullptr,
                         options, lit ? shadow_out.get().at : nullptr,
                         sky ? sky_out.get().at : nullptr);
        if (lit) shadow_out.read(shadow);
        if (sky) sky_out.read(ambient);
    }

private:
    template <typename T>
    void read(const T* address, std::span<T> values) {
        queue_->read(reinterpret_cast<std::uint64_t>(address), std::as_writable_bytes(values));
    }

    template <typename Take>
    double trace(Pass pass, const DeviceDag& dag, std::span<const shared::GridRay> rays,
                 const shared::Stop& stop, const Take& take) {
        const std::uint64_t most = std::min<std::uint64_t>(kRaysAtOnce, rays.size());
        const DeviceArray<shared::RayArray> on_device(*queue_, most);
        const DeviceArray<shared::HitArray> hits(*queue_, pass == Pass::closest ? most : 0);
        const DeviceArray<shared::UintArray> occluded(*queue_, pass == Pass::any ? most : 0);
        const shared::RayJob job{static_cast<const GpuDag&>(dag).view, on_device.get(), hits.get(),
                                 occluded.get(), stop};
        double seconds = 0.0;
        for (std::size_t first = 0; first < rays.size(); first += kRaysAtOnce) {
            const auto some = rays.subspan(first, std::min<std::size_t>(most, rays.size() - first));
            queue_->write(reinterpret_cast<std::uint64_t>(job.rays.at), std::as_bytes(some));
            queue_->finish();
            const auto start = std::chrono::steady_clock::now();
            queue_->run(pass, job, some.size());
            queue_->finish();
            seconds +=
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            take(first, job);
        }
        return seconds;
    }

    static void set_lamp(shared::PixelJob& job, const GpuLamp& lamp, int number, Shadows shadows) {
        job.lamp = lamp.placed;
        job.lamp_number = number;
        job.intensity = lamp.lamp.light().intensity;
        job.shadows = shadows == Shadows::none ? 0 : 1;
        job.hard = shadows == Shadows::soft ? 0 : 1;
    }

    [[nodiscard]] static std::span<const float> flat(std::span<const vec3> v) {
        return {reinterpret_cast<const float*>(v.data()), 3 * v.size()};
    }

    /// Draws a picture band by band.
    /// @param step  step(band, true) sets what its job needs beside camera, sizes and sky; then
    ///              step(band, false) asks for the passes that follow primary_pass()
    template <typename Step>
    [[nodiscard]] Image draw(const GpuDag& dag, const Grid& grid, const RenderOptions& options,
                             const PixelRays& rays, bool colored, const Step& step) {
        Image image(options.width, options.height);
        const int columns = (options.width + kTile - 1) / kTile;
        const int rows = (options.height + kTile - 1) / kTile;
        const int tiles = columns * rows;
        Band band(*queue_, static_cast<std::uint64_t>(std::min(tiles, kTilesAtOnce)) * kTilePixels,
                  colored);
        const GpuSky sky(*queue_, options.sky.value_or(Sky{}));
        shared::PixelJob& job = band.job;
        job.dag = rays.sees_nothing() ? shared::DagView{} : dag.view;
        job.camera = rays.view();
        job.size = {options.width, options.height};
        job.tile_columns = columns;
        job.beams = options.beam && rays.t_before() == 0.0f ? 1 : 0;
        job.samples = options.samples;
        job.smoothed = options.smooth_normals ? 1 : 0;
        job.frame = options.frame;
        job.looks = dag.model.looks;
        job.colored = colored ? 1 : 0;
        job.sky = sky.view;
        job.own_sky = options.sky ? 1 : 0;
        step(band, true);
        for (int first = 0; first < tiles; first += kTilesAtOnce) {
            const int some = std::min(kTilesAtOnce, tiles - first);
            job.first_tile = first;
            band.in_use = static_cast<std::uint64_t>(some) * kTilePixels;
            if (job.beams != 0) queue_->run(Pass::beam, job, static_cast<std::uint64_t>(some));
            for (int i = 0; i < options.samples; ++i) {
                job.sample_number = i;
                queue_->run(Pass::primary, job, band.in_use);
                step(band, false);
                queue_->cut();
            }
            copy_band(band, some, grid, options, image);
            report(options.progress, {"render",
                                      static_cast<std::uint64_t>(first + some) *
                                          image.color.size() / static_cast<std::uint64_t>(tiles),
                                      image.color.size()});
        }
        return image;
    }

    /// The passes of octavo::render() behind the primary one.
    void add_sample(Band& band, const RenderOptions& options, const std::vector<GpuLamp>& lamps) {
        shared::PixelJob& job = band.job;
        const int i = job.sample_number;
        queue_->run(Pass::surface, job, band.in_use);
        if (job.colored != 0) queue_->run(Pass::looks, job, band.in_use);
        const ivec2 sky = share(options.ao_samples, options.samples, i);
        job.sky_rays = sky.y - sky.x;
        in_parts(job, sky, [&] {
            queue_->run(Pass::sky, job, band.in_use);
            queue_->cut();
        });
        for (std::size_t n = 0; n < lamps.size(); ++n) {
            set_lamp(job, lamps[n], static_cast<int>(n), options.shadows);
            const ivec2 rays = options.shadows == Shadows::soft
                                   ? share(options.shadow_samples, options.samples, i)
                                   : ivec2(i, i + 1);
            queue_lamp(*queue_, job, rays, options.beam && job.shadows != 0, band.in_use);
            queue_->run(Pass::light, job, band.in_use);
        }
        queue_->run(Pass::shade, job, band.in_use);
    }

    /// From the order of tiles to that of rows.
    static void for_each_pixel(const shared::PixelJob& job, int tiles, const auto& take) {
        for (int t = 0; t < tiles; ++t)
            for (int i = 0; i < kTile * kTile; ++i) {
                const int x = (job.first_tile + t) % job.tile_columns * kTile + i % kTile;
                const int y = (job.first_tile + t) / job.tile_columns * kTile + i / kTile;
                if (x < job.size.x && y < job.size.y)
                    take(static_cast<std::size_t>(t) * kTilePixels + static_cast<std::size_t>(i), x,
                         y);
            }
    }

    static void copy_band(const Band& band, int tiles, const Grid& grid,
                          const RenderOptions& options, Image& image) {
        std::vector<vec3> colors(static_cast<std::size_t>(tiles) * kTilePixels);
        std::vector<float> depths(colors.size());
        band.colors.read(colors);
        band.depths.read(depths);
        for_each_pixel(band.job, tiles, [&](std::size_t from, int x, int y) {
            const std::size_t to = image.index(x, y);
            image.color[to] = colors[from] / static_cast<float>(options.samples);
            const float depth = depths[from];
            image.depth[to] = depth < 0.0f ? std::numeric_limits<float>::infinity()
                                           : static_cast<float>(depth * grid.voxel_size);
        });
    }

    std::unique_ptr<PassQueue> queue_;
};

}  // namespace

std::unique_ptr<Device> make_gpu_device(std::unique_ptr<PassQueue> queue) {
    return std::make_unique<GpuDevice>(std::move(queue));
}

}  // namespace octavo
