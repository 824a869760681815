// SPDX-License-Identifier: MIT
//
// One pixel: primary rays, a lamp with shadow, and the sky with ambient occlusion, as in [K13]
// section 4, on neutral clay.
#include "octavo/render/render.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>
#include <vector>

#include "octavo/core/parallel.h"
#include "octavo/render/camera.h"
#include "octavo/render/effects.h"
#include "octavo/render/lamp.h"
#include "octavo/render/normal.h"
#include "octavo/render/ray_queue.h"

namespace octavo {
namespace {

constexpr int kTile = 8;  // pixels; [K13] uses beams of 8x8

/// The smoothed normals of the cells that a thread has met: close to a surface many pixels share
/// one. A slot holds the last normal that fell on it, which depends on the cell and face alone, so
/// the picture does not depend on what is found here.
class NormalCache {
public:
    vec3 get(const shared::DagView& dag, const shared::GridRay& ray, const shared::GridHit& hit) {
        const std::uint32_t key = shared::mix_bits(
            hit.path.x + shared::mix_bits(hit.path.y + shared::mix_bits(hit.path.z)));
        Entry& entry = entries_[key % entries_.size()];
        if (entry.face != hit.face || entry.height != hit.height || entry.path != hit.path ||
            hit.face == shared::kFaceInside)
            entry = {hit.path, hit.height, hit.face, smooth_normal(dag, ray, hit)};
        return entry.normal;
    }

private:
    struct Entry {
        uvec3 path{0};
        int height = 0;
        int face = shared::kFaceNone;
        vec3 normal{0.0f};
    };
    std::vector<Entry> entries_ = std::vector<Entry>(4096);
};

const vec3 kClay(0.78f, 0.76f, 0.72f);
const vec3 kZenith(0.30f, 0.47f, 0.78f);
const vec3 kHorizon(0.80f, 0.86f, 0.93f);
const vec3 kGround(0.42f, 0.39f, 0.35f);
/// The sky's light on a surface that sees all of it, for an albedo of one.
const vec3 kSkyLight(0.40f, 0.47f, 0.60f);
const vec3 kGroundLight(0.22f, 0.19f, 0.16f);

/// How far secondary rays of a smoothed surface start above it, in cells: the steps of a slanted
/// plane are up to one cell high, and its shading must not see them.
constexpr float kLift = 1.5f;

void check(const RenderOptions& o) {
    const auto refuse = [](const std::string& what) { throw Error(Errc::bad_argument, what); };
    if (o.width < 1 || o.height < 1 || o.width > 65536 || o.height > 65536)
        refuse("a picture's sides are 1 to 65536 pixels");
    if (o.samples < 1 || o.samples > 65536) refuse("samples per pixel are 1 to 65536");
    if (o.ao_samples < 0 || o.ao_samples > 65536) refuse("ambient samples are 0 to 65536");
    if (o.shadow_samples < 1 || o.shadow_samples > 65536) refuse("shadow samples are 1 to 65536");
    if (!(o.ao_radius >= 0.0) || !std::isfinite(o.ao_radius))
        refuse("the ambient radius is negative or not finite");
    if (!(o.ao_cone >= 0.0) || !std::isfinite(o.ao_cone))
        refuse("the ambient cone is negative or not finite");
    if (!(o.light_size >= 0.0) || !std::isfinite(o.light_size))
        refuse("the light's size is negative or not finite");
}

/// All that the pixels of one picture have in common.
class Picture {
public:
    Picture(const Dag& dag, const Grid& grid, const RenderOptions& options)
        : whole_dag_(dag),
          dag_(shared::view(dag)),
          grid_(grid),
          options_(options),
          up_(glm::normalize(options.up)),
          rays_(checked_camera(dag, grid, options), grid, options.width, options.height),
          light_(options.light ? *options.light
                               : default_sun(checked_camera(dag, grid, options), options.up)) {
        const Box bounds = content_bounds(dag, grid);
        const double diagonal = bounds.empty() ? 1.0 : glm::length(bounds.size());
        const double radius = options.ao_radius > 0.0 ? options.ao_radius : 0.06 * diagonal;
        ao_radius_ = static_cast<float>(radius / grid.voxel_size);
        ao_stop_.cone = static_cast<float>(options.ao_cone);
        primary_stop_.cone = options.level_of_detail ? rays_.pixel_pitch() : 0.0f;
        primary_stop_.time_before = rays_.t_before();
    }

    void draw_tile(int x0, int y0, NormalCache& normals, Image& image) const {
        const int x1 = std::min(x0 + kTile, options_.width);
        const int y1 = std::min(y0 + kTile, options_.height);
        float start = 0.0f;
        if (options_.beam)
            if (const auto beam = rays_.bundle(x0, y0, x1, y1))
                start = beam_start(dag_, *beam, primary_stop_);
        Tile tile(*this, normals, x0, y0, x1, y1);
        for (int i = 0; i < options_.samples; ++i) {
            trace_primary(tile, i, start);
            if (i == 0) write_depths(tile, image);
            add_samples(tile, i);
        }
        for (std::size_t k = 0; k < tile.pixels.size(); ++k)
            image.color[image.index(tile.pixels[k].x, tile.pixels[k].y)] =
                tile.sums[k] / static_cast<float>(options_.samples);
    }

private:
    static Camera checked_camera(const Dag& dag, const Grid& grid, const RenderOptions& options) {
        if (!options.camera) {
            const Box content = content_bounds(dag, grid);
            return default_camera(content.empty() ? grid.bounds() : content, options.up,
                                  static_cast<double>(options.width) / options.height);
        }
        const Camera& c = *options.camera;
        return look_at(c.eye, c.eye + c.forward, c.up, c.vertical_fov);
    }

    /// A primary hit whose secondary rays are on their way.
    struct Waiting {
        std::size_t pixel;
        vec3 normal;
        vec3 lamp;  // its light, where nothing is in the way
        vec3 albedo;
        vec3 emission;
        std::size_t sky_group;
        std::size_t lamp_group;
        int sky_rays = 0;
        int lamp_rays = 0;
    };

    /// What the pixels of a tile share, for one sample of each at a time.
    struct Tile {
        Tile(const Picture& p, NormalCache& thread_normals, int x0, int y0, int x1, int y1)
            : normals(thread_normals),
              sky_queue(p.whole_dag_, p.ao_stop_),
              lamp_queue(p.whole_dag_, {0, 0.0f, 0.0f}) {
            for (int y = y0; y < y1; ++y)
                for (int x = x0; x < x1; ++x) {
                    pixels.emplace_back(x, y);
                    seeds.push_back(shared::pixel_seed(static_cast<std::uint32_t>(x),
                                                       static_cast<std::uint32_t>(y),
                                                       p.options_.frame));
                }
            sums.resize(pixels.size(), vec3(0.0f));
            directions.resize(pixels.size());
            rays.resize(pixels.size());
            hits.resize(pixels.size());
        }

        NormalCache& normals;
        std::vector<ivec2> pixels;
        std::vector<std::uint32_t> seeds;
        std::vector<vec3> sums;
        std::vector<dvec3> directions;
        std::vector<shared::GridRay> rays;
        std::vector<shared::GridHit> hits;
        std::vector<Waiting> waiting;
        RayQueue sky_queue;
        RayQueue lamp_queue;
    };

    void trace_primary(Tile& tile, int i, float start) const {
        for (std::size_t k = 0; k < tile.pixels.size(); ++k) {
            vec2 at(0.5f);
            if (options_.samples > 1)
                at = shared::sample_2d(static_cast<std::uint32_t>(i), tile.seeds[k] ^ 0x2545f491u);
            const double x = tile.pixels[k].x + static_cast<double>(at.x);
            const double y = tile.pixels[k].y + static_cast<double>(at.y);
            tile.directions[k] = rays_.direction(x, y);
            tile.rays[k] = rays_.ray(x, y);
            tile.rays[k].t_min = start;
            tile.hits[k] = shared::make_miss(tile.rays[k].t_max, 0);
        }
        if (!rays_.sees_nothing() && start < tile.rays[0].t_max)
            trace_closest_wide(whole_dag_, tile.rays, primary_stop_, tile.hits);
    }

    void write_depths(const Tile& tile, Image& image) const {
        for (std::size_t k = 0; k < tile.pixels.size(); ++k) {
            const bool found = tile.hits[k].face != shared::kFaceNone;
            image.depth[image.index(tile.pixels[k].x, tile.pixels[k].y)] =
                found ? static_cast<float>((rays_.t_before() + tile.hits[k].t) * grid_.voxel_size)
                      : std::numeric_limits<float>::infinity();
        }
    }

    /// Shades sample i of each pixel: first all secondary rays, then the light that they leave.
    void add_samples(Tile& tile, int i) const {
        tile.waiting.clear();
        tile.sky_queue.clear();
        tile.lamp_queue.clear();
        for (std::size_t k = 0; k < tile.pixels.size(); ++k) {
            if (tile.hits[k].face == shared::kFaceNone)
                tile.sums[k] += sky(tile.directions[k]);
            else
                send_rays(tile, k, i);
        }
        tile.sky_queue.trace();
        tile.lamp_queue.trace();
        for (const Waiting& w : tile.waiting) tile.sums[w.pixel] += shade(w, tile);
    }

    [[nodiscard]] vec3 sky(const dvec3& direction) const {
        const float height = static_cast<float>(glm::dot(glm::normalize(direction), up_));
        if (height < 0.0f) return glm::mix(kHorizon, kGround, std::min(1.0f, std::sqrt(-height)));
        return glm::mix(kHorizon, kZenith, std::min(1.0f, std::pow(height, 0.6f)));
    }

    /// The part of `count` rays for the pixel that sample i shoots: [first, end).
    [[nodiscard]] ivec2 share(int count, int i) const {
        const int each = (count + options_.samples - 1) / options_.samples;
        return {i * each, (i + 1) * each};
    }

    /// Queues the rays that say how much light sample i of pixel k gets.
    void send_rays(Tile& tile, std::size_t k, int i) const {
        const shared::GridRay& ray = tile.rays[k];
        const shared::GridHit hit = move_to_open_face(dag_, ray, tile.hits[k]);
        const std::uint32_t seed = tile.seeds[k];
        vec3 normal = face_normal(ray, hit);
        shared::GridRay start = leave_hit(ray, hit, normal);
        int face = hit.face;
        if (options_.smooth_normals) {
            normal = tile.normals.get(dag_, ray, hit);
            if (lift(start, kLift * static_cast<float>(1 << hit.height) * normal))
                face = shared::kFaceNone;
        }

        Waiting w{k,
                  normal,
                  vec3(0.0f),
                  kClay,
                  vec3(0.0f),
                  tile.sky_queue.begin_group(),
                  tile.lamp_queue.begin_group()};
        if (options_.attributes) {
            const Attributes& looks = *options_.attributes;
            const int level = whole_dag_.depth() - hit.height;
            if (const auto color = looks.color(hit.path, level, -ray.dir))
                w.albedo = linear_from_srgb8(*color);
            w.emission = looks.emission(hit.path, level, -ray.dir).value_or(vec3(0.0f));
        }
        if (options_.ao_samples > 0) {
            const ivec2 some = share(options_.ao_samples, i);
            w.sky_rays = some.y - some.x;
            for (int n = some.x; n < some.y; ++n)
                tile.sky_queue.add(sky_ray(start, face, normal, ao_radius_, n, seed ^ 0x68bc21ebu));
        }
        SeenLamp lamp =
            see_lamp(light_, options_.light_size, grid_, dvec3(start.cell) + dvec3(start.frac));
        const float cosine = glm::dot(normal, glm::normalize(lamp.disc.to_centre));
        if (cosine > 0.0f && lamp.strength > 0.0f) {
            w.lamp = light_.intensity * (cosine * lamp.strength * 0.31830989f);
            if (options_.shadows != Shadows::none) {
                ivec2 some = share(options_.shadow_samples, i);
                if (options_.shadows == Shadows::hard) {
                    lamp.disc.radius = 0.0f;
                    some = {i, i + 1};
                }
                w.lamp_rays = some.y - some.x;
                queue_lamp_rays(dag_, start, face, lamp.disc, some.x, some.y, seed ^ 0x02e5be93u,
                                options_.beam, tile.lamp_queue);
            }
        }
        tile.waiting.push_back(w);
    }

    [[nodiscard]] vec3 shade(const Waiting& w, const Tile& tile) const {
        const auto part = [](int seen, int rays) {
            return rays == 0 ? 1.0f : static_cast<float>(seen) / static_cast<float>(rays);
        };
        const float facing_up = 0.5f + 0.5f * glm::dot(w.normal, vec3(up_));
        const vec3 ambient = part(tile.sky_queue.seen(w.sky_group), w.sky_rays) *
                             glm::mix(kGroundLight, kSkyLight, facing_up);
        const vec3 direct = part(tile.lamp_queue.seen(w.lamp_group), w.lamp_rays) * w.lamp;
        return w.albedo * (ambient + direct) + w.emission;
    }

    /// Moves the start of a ray off its face, as far as it can without ending inside a voxel: in a
    /// crevice, where the point would be black. False where it cannot.
    [[nodiscard]] bool lift(shared::GridRay& start, const vec3& way) const {
        for (const float part : {1.0f, 0.6f, 0.3f}) {
            shared::GridRay lifted = start;
            const vec3 frac = start.frac + part * way;
            lifted.cell += ivec3(glm::floor(frac));
            lifted.frac = frac - glm::floor(frac);
            lifted.t_max = 1e-4f;
            if (trace_any(dag_, lifted, {0, 0.0f, 0.0f})) continue;
            start = lifted;
            return true;
        }
        return false;
    }

    const Dag& whole_dag_;
    shared::DagView dag_;
    const Grid& grid_;
    const RenderOptions& options_;
    dvec3 up_;
    PixelRays rays_;
    Light light_;
    float ao_radius_ = 0.0f;
    shared::Stop ao_stop_{0, 0.0f, 0.0f};
    shared::Stop primary_stop_{0, 0.0f, 0.0f};
};

/// Counts finished pixels and tells about them, one thread at a time.
class Reporter {
public:
    Reporter(const ProgressFunction& function, std::uint64_t total)
        : function_(function), total_(total) {}

    void add(std::uint64_t pixels) {
        if (!function_) return;
        const std::lock_guard lock(mutex_);
        done_ += pixels;
        if (done_ < next_ && done_ < total_) return;
        next_ = done_ + total_ / 200;
        report(function_, {"render", done_, total_});
    }

private:
    const ProgressFunction& function_;
    std::mutex mutex_;
    std::uint64_t done_ = 0;
    std::uint64_t next_ = 0;
    std::uint64_t total_;
};

}  // namespace

Image render(const Dag& dag, const Grid& grid, const RenderOptions& options) {
    check(options);
    const Picture picture(dag, grid, options);
    Image image(options.width, options.height);
    tbb::enumerable_thread_specific<NormalCache> normals;
    Reporter reporter(options.progress, image.color.size());
    const int columns = (options.width + kTile - 1) / kTile;
    const int rows = (options.height + kTile - 1) / kTile;
    with_threads(options.threads, [&] {
        tbb::parallel_for(
            tbb::blocked_range<int>(0, columns * rows, 4),
            [&](const tbb::blocked_range<int>& tiles) {
                for (int t = tiles.begin(); t != tiles.end(); ++t) {
                    const int x = t % columns * kTile;
                    const int y = t / columns * kTile;
                    picture.draw_tile(x, y, normals.local(), image);
                    reporter.add(static_cast<std::uint64_t>(std::min(kTile, options.width - x) *
                                                            std::min(kTile, options.height - y)));
                }
            });
    });
    return image;
}

}  // namespace octavo
