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
#include "octavo/render/settings.h"

namespace octavo {
namespace {

constexpr int kTile = 8;
constexpr std::uint64_t kTilePixels = 64;

/// Rays of a list that are on the device at once.
constexpr std::uint64_t kRaysAtOnce = 1 << 20;

/// Tiles of a picture that are on the device at once: half a million pixels, which fill any GPU and
/// take some 70 MB.
constexpr int kTilesAtOnce = 8192;

class GpuDag final : public DeviceDag {
public:
    GpuDag(PassQueue& queue, const Dag& dag)
        : host(dag),
          view(queue.upload(dag.words(), dag.empty() ? 0 : dag.depth())),
          queue_(queue) {}
    ~GpuDag() override { queue_.release(view); }

    Dag host;
    shared::DagView view;

private:
    PassQueue& queue_;
};

/// The arrays of a band of pixels, and the job that knows them.
struct Band {
    Band(PassQueue& queue, std::uint64_t pixels)
        : starts(queue, pixels / kTilePixels),
          hits(queue, pixels),
          depths(queue, pixels),
          points(queue, pixels),
          sky_seen(queue, pixels),
          lamp_seen(queue, pixels),
          light(queue, pixels),
          colors(queue, pixels) {
        job.starts = starts.get();
        job.hits = hits.get();
        job.depths = depths.get();
        job.points = points.get();
        job.sky_seen = sky_seen.get();
        job.lamp_seen = lamp_seen.get();
        job.light = light.get();
        job.colors = colors.get();
    }

    DeviceArray<shared::FloatArray> starts;
    DeviceArray<shared::HitArray> hits;
    DeviceArray<shared::FloatArray> depths;
    DeviceArray<shared::PointArray> points;
    DeviceArray<shared::UintArray> sky_seen;
    DeviceArray<shared::LightArray> lamp_seen;
    DeviceArray<shared::ColorArray> light;
    DeviceArray<shared::ColorArray> colors;
    shared::PixelJob job{};
};

class GpuDevice final : public Device {
public:
    explicit GpuDevice(std::unique_ptr<PassQueue> queue) : queue_(std::move(queue)) {}

    [[nodiscard]] const DeviceInfo& info() const override { return queue_->info(); }

    [[nodiscard]] std::unique_ptr<DeviceDag> upload(const Dag& dag) override {
        return std::make_unique<GpuDag>(*queue_, dag);
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
        const RenderSettings settings = settle(gpu_dag.host, grid, options);
        Image image(options.width, options.height);
        const int columns = (options.width + kTile - 1) / kTile;
        const int rows = (options.height + kTile - 1) / kTile;
        const int tiles = columns * rows;
        Band band(*queue_, static_cast<std::uint64_t>(std::min(tiles, kTilesAtOnce)) * kTilePixels);
        shared::PixelJob& job = band.job;
        job.dag = settings.rays.sees_nothing() ? shared::DagView{} : gpu_dag.view;
        job.camera = settings.rays.view();
        job.stop = settings.primary_stop;
        job.size = {options.width, options.height};
        job.tile_columns = columns;
        job.beams = options.beam && settings.rays.t_before() == 0.0f ? 1 : 0;
        job.samples = options.samples;
        job.smoothed = options.smooth_normals ? 1 : 0;
        job.frame = options.frame;
        job.up = settings.up;
        job.sky_radius = settings.ao_radius;
        job.sky_stop = settings.ao_stop;
        std::vector<GpuLamp> lamps;
        for (const Light& light : settings.lights) lamps.emplace_back(*queue_, light, grid);
        for (int first = 0; first < tiles; first += kTilesAtOnce) {
            const int some = std::min(kTilesAtOnce, tiles - first);
            job.first_tile = first;
            draw_band(band, options, lamps, static_cast<std::uint64_t>(some));
            copy_band(band, some, grid, options, image);
            report(options.progress, {"render",
                                      static_cast<std::uint64_t>(first + some) *
                                          image.color.size() / static_cast<std::uint64_t>(tiles),
                                      image.color.size()});
        }
        return image;
    }

    void visibility(const DeviceDag& dag, const Grid& grid, std::span<const vec3> positions,
                    std::span<const vec3> normals, const VisibilityOptions& options,
                    std::span<float> shadow, std::span<float> ambient) override {
        check(options, positions.size(), normals.size(), shadow.size(), ambient.size());
        const bool sky = options.ao_samples > 0 && !ambient.empty();
        const bool lit = options.light && !shadow.empty();
        const auto flat = [](std::span<const vec3> v) {
            return std::span(reinterpret_cast<const float*>(v.data()), 3 * v.size());
        };
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

    void draw_band(Band& band, const RenderOptions& options, const std::vector<GpuLamp>& lamps,
                   std::uint64_t tiles) {
        shared::PixelJob& job = band.job;
        const std::uint64_t pixels = tiles * kTilePixels;
        if (job.beams != 0) queue_->run(Pass::beam, job, tiles);
        for (int i = 0; i < options.samples; ++i) {
            job.sample_number = i;
            queue_->run(Pass::primary, job, pixels);
            queue_->run(Pass::surface, job, pixels);
            const ivec2 sky = share(options.ao_samples, options.samples, i);
            job.sky_rays = sky.y - sky.x;
            in_parts(job, sky, [&] {
                queue_->run(Pass::sky, job, pixels);
                queue_->cut();
            });
            for (std::size_t n = 0; n < lamps.size(); ++n) {
                set_lamp(job, lamps[n], static_cast<int>(n), options.shadows);
                const ivec2 rays = options.shadows == Shadows::soft
                                       ? share(options.shadow_samples, options.samples, i)
                                       : ivec2(i, i + 1);
                job.lamp_beams = options.beam ? 1 : 0;
                job.lamp_rays = rays.y - rays.x;
                in_parts(job, rays, [&] {
                    queue_->run(Pass::lamp, job, pixels);
                    queue_->cut();
                });
                queue_->run(Pass::light, job, pixels);
            }
            queue_->run(Pass::shade, job, pixels);
            queue_->cut();
        }
    }

    /// From the order of tiles to that of rows.
    static void for_each_pixel(const shared::PixelJob& job, int tiles, const auto& take) {
        for (int t = 0; t < tiles; ++t)
            for (int i = 0; i < kTile * kTile; ++i) {
                const int x = (job.first_tile + t) % job.tile_columns * kTile + i % kTile;
                const int y = (job.first_tile + t) / job.tile_columns * kTile + i / kTile;
                if (x < job.size.x && y < job.size.y)
                    take(static_cast<std::size_t>(t * kTile * kTile + i), x, y);
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
