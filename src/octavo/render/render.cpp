// SPDX-License-Identifier: MIT
//
// One pixel: primary rays, lamps with shadow, and the sky with ambient occlusion, as in [K13]
// section 4, on neutral clay.
#include "octavo/render/render.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "octavo/light/lamp.h"
#include "octavo/light/light_grid.h"
#include "octavo/light/normal_cache.h"
#include "octavo/render/effects.h"
#include "octavo/render/settings.h"
#include "octavo/render/tiles.h"
#include "octavo/render/visibility.h"
#include "octavo/trace/grid_ray.h"
#include "octavo/trace/partitions.h"
#include "octavo/trace/ray_queue.h"
#include "octavo/trace/wide.h"

namespace octavo {
namespace {

/// All that the pixels of one picture have in common.
class Picture {
public:
    /// @param partitions  none where rays go one by one
    Picture(const Dag& dag, const Grid& grid, const RenderOptions& options, Partitions* partitions)
        : whole_dag_(dag),
          dag_(shared::view(dag)),
          grid_(grid),
          options_(options),
          settings_(settle(dag, grid, options)),
          // Clusters of no box list every lamp.
          lamp_grid_(settings_.lights, options.least_light > 0.0f ? settings_.lit : Box(),
                     settings_.eye, options.least_light),
          partitions_(partitions),
          walk_(options.wide ? WideWalk::by_size : WideWalk::one_by_one) {
        for (const Light& light : settings_.lights) lamps_.emplace_back(light, grid);
    }

    void draw_tile(const PictureTile& at, NormalCache& normals, Image& image) const {
        float start = 0.0f;
        if (options_.beam && !options_.primary)
            if (const auto beam = settings_.rays.bundle(at.low.x, at.low.y, at.high.x, at.high.y))
                start = beam_start_wide(whole_dag_, *beam, settings_.primary_stop, walk_);
        Tile tile(*this, at, normals);
        for (int i = 0; i < options_.samples; ++i) {
            trace_primary(tile, i, start);
            if (options_.primary) ask_for_surface(tile);
            if (i == 0) write_depths(tile, image);
            add_samples(tile, i);
        }
        for (std::size_t k = 0; k < tile.pixels.size(); ++k)
            image.color[image.index(tile.pixels[k].x, tile.pixels[k].y)] =
                tile.sums[k] / static_cast<float>(options_.samples);
    }

private:
    /// A primary hit whose secondary rays are on their way.
    struct Waiting {
        std::size_t pixel;
        vec3 normal;
        vec3 albedo;
        vec3 emission;
        std::size_t sky_group;
        std::size_t first_lamp, end_lamp;  // of Tile::asked
        int sky_rays = 0;
        int lamp_rays = 0;
    };

    /// A lamp whose light on a pixel is on its way.
    struct Asked {
        std::uint32_t lamp;
        std::size_t queue, group;
    };

    /// What the pixels of a tile share, for one sample of each at a time.
    struct Tile {
        Tile(const Picture& p, const PictureTile& at, NormalCache& thread_normals)
            : normals(thread_normals),
              queue_of_lamp(p.lamps_.size(), kNoQueue),
              sky_queue(p.whole_dag_, p.settings_.ao_stop, nullptr, p.walk_) {
            for (int y = at.low.y; y < at.high.y; ++y)
                for (int x = at.low.x; x < at.high.x; ++x) {
                    pixels.emplace_back(x, y);
                    seeds.push_back(shared::pixel_seed(static_cast<std::uint32_t>(x),
                                                       static_cast<std::uint32_t>(y),
                                                       p.options_.frame));
                }
            sums.resize(pixels.size(), vec3(0.0f));
            rays.resize(pixels.size());
            hits.resize(pixels.size());
        }

        NormalCache& normals;
        std::vector<ivec2> pixels;
        std::vector<std::uint32_t> seeds;
        std::vector<vec3> sums;
        std::vector<shared::GridRay> rays;
        std::vector<shared::GridHit> hits;
        std::vector<SurfaceHit> surface;  // with RenderOptions::primary
        std::vector<Waiting> waiting;
        static constexpr std::size_t kNoQueue = ~std::size_t{0};
        std::vector<std::size_t> queue_of_lamp;
        std::vector<Asked> asked;
        RayQueue sky_queue;
        // One for each lamp that is near: its rays run close together.
        std::vector<RayQueue> lamp_queues;
    };

    void trace_primary(Tile& tile, int i, float start) const {
        for (std::size_t k = 0; k < tile.pixels.size(); ++k) {
            vec2 at(0.5f);
            if (options_.samples > 1)
                at = shared::sample_2d(static_cast<std::uint32_t>(i), tile.seeds[k] ^ 0x2545f491u);
            tile.rays[k] = camera_ray(settings_.rays.view(), tile.pixels[k], at);
            tile.rays[k].t_min = start;
            tile.hits[k] = shared::make_miss(tile.rays[k].t_max, 0);
        }
        if (!options_.primary && !settings_.rays.sees_nothing() && start < tile.rays[0].t_max)
            trace_closest_wide(whole_dag_, tile.rays, settings_.primary_stop, tile.hits, walk_);
    }

    /// Has the rays traced by the caller. A hit then says when, and that there is no face.
    void ask_for_surface(Tile& tile) const {
        std::vector<Ray> rays;
        for (const shared::GridRay& ray : tile.rays)
            rays.push_back({grid_.to_world(origin_of(ray)), dvec3(ray.dir) * grid_.voxel_size});
        tile.surface.assign(rays.size(), {});
        options_.primary(rays, tile.surface);
        for (std::size_t k = 0; k < rays.size(); ++k) {
            const SurfaceHit& found = tile.surface[k];
            if (!std::isfinite(found.t) || !(glm::length(found.normal) > 0.0f)) continue;
            tile.hits[k].t = static_cast<float>(found.t);
            tile.hits[k].face = shared::kFaceInside;
        }
    }

    void write_depths(const Tile& tile, Image& image) const {
        for (std::size_t k = 0; k < tile.pixels.size(); ++k) {
            const bool found = tile.hits[k].face != shared::kFaceNone;
            image.depth[image.index(tile.pixels[k].x, tile.pixels[k].y)] =
                found ? static_cast<float>((settings_.rays.t_before() + tile.hits[k].t) *
                                           grid_.voxel_size)
                      : std::numeric_limits<float>::infinity();
        }
    }

    /// Shades sample i of each pixel: first all secondary rays, then the light that they leave.
    void add_samples(Tile& tile, int i) const {
        tile.waiting.clear();
        tile.asked.clear();
        tile.sky_queue.clear();
        for (RayQueue& queue : tile.lamp_queues) queue.clear();
        for (std::size_t k = 0; k < tile.pixels.size(); ++k) {
            if (tile.hits[k].face == shared::kFaceNone)
                tile.sums[k] += options_.sky ? options_.sky->radiance(tile.rays[k].dir)
                                             : shared::sky_color(tile.rays[k].dir, settings_.up);
            else
                send_rays(tile, k, i);
        }
        tile.sky_queue.trace();
        for (RayQueue& queue : tile.lamp_queues) queue.trace();
        for (const Waiting& w : tile.waiting) tile.sums[w.pixel] += shade(w, tile);
    }

    /// Where the secondary rays of pixel k start.
    [[nodiscard]] shared::SurfacePoint surface_point(Tile& tile, std::size_t k) const {
        const shared::GridRay& ray = tile.rays[k];
        if (options_.primary) return lifted_point(ray, tile.surface[k], tile.seeds[k]);
        const shared::GridHit hit = move_to_open_face(dag_, ray, tile.hits[k]);
        return options_.smooth_normals
                   ? smoothed_point(dag_, ray, hit, tile.normals.get(dag_, ray, hit), tile.seeds[k])
                   : flat_point(ray, hit, tile.seeds[k]);
    }

    [[nodiscard]] shared::SurfacePoint lifted_point(const shared::GridRay& ray,
                                                    const SurfaceHit& found,
                                                    std::uint32_t seed) const {
        const dvec3 at = origin_of(ray) + found.t * dvec3(ray.dir);
        vec3 normal = glm::normalize(found.normal);
        if (glm::dot(normal, ray.dir) > 0.0f) normal = -normal;
        const auto start = lifted_start(grid_, grid_.to_world(at), normal, options_.bias);
        if (!start) return {ray.cell, ray.frac, normal, shared::kFaceNone, seed, 1};
        return {start->cell, start->frac, normal, shared::kFaceNone, seed, 1};
    }

    /// Queues the rays that say how much light sample i of pixel k gets.
    void send_rays(Tile& tile, std::size_t k, int i) const {
        const std::uint32_t seed = tile.seeds[k];
        const shared::SurfacePoint point = surface_point(tile, k);
        const vec3 normal = point.normal;
        const shared::GridRay start = surface_ray(point);
        const int face = point.face;

        Waiting w{
            k, normal, shared::clay(), vec3(0.0f), tile.sky_queue.begin_group(), tile.asked.size(),
            0};
        if (options_.attributes) look_at_voxel(tile, k, w);
        if (options_.ao_samples > 0) {
            const ivec2 some = share(options_.ao_samples, options_.samples, i);
            w.sky_rays = some.y - some.x;
            for (int n = some.x; n < some.y; ++n)
                tile.sky_queue.add(sky_ray(start, face, normal, settings_.ao_radius, n,
                                           shared::hemisphere_seed(seed)));
        }
        const bool soft = options_.shadows == Shadows::soft;
        const ivec2 some =
            soft ? share(options_.shadow_samples, options_.samples, i) : ivec2(i, i + 1);
        w.lamp_rays = some.y - some.x;
        for (const std::uint32_t n : lamp_grid_.near(grid_.to_world(origin_of(start)))) {
            RayQueue& queue = queue_of(tile, n);
            tile.asked.push_back({n, tile.queue_of_lamp[n], queue.begin_group()});
            const SeenLamp lamp(lamps_[n], start, face, normal, !soft);
            const std::uint32_t rays_seed = shared::lamp_seed(seed, static_cast<int>(n));
            if (options_.shadows == Shadows::none)
                add_unshadowed(lamp, some, rays_seed, queue);
            else
                queue_lamp_rays(lamp, some.x, some.y, rays_seed, queue);
        }
        w.end_lamp = tile.asked.size();
        tile.waiting.push_back(w);
    }

    RayQueue& queue_of(Tile& tile, std::uint32_t lamp) const {
        std::size_t& queue = tile.queue_of_lamp[lamp];
        if (queue == Tile::kNoQueue) {
            queue = tile.lamp_queues.size();
            tile.lamp_queues.emplace_back(whole_dag_, shared::stop_at_voxels(), partitions_, walk_);
        }
        return tile.lamp_queues[queue];
    }

    /// The colour and the emission of what pixel k sees.
    void look_at_voxel(const Tile& tile, std::size_t k, Waiting& w) const {
        const Attributes& looks = *options_.attributes;
        const shared::GridRay& ray = tile.rays[k];
        if (options_.primary) {
            const dvec3 at =
                origin_of(ray) + static_cast<double>(tile.surface[k].t) * dvec3(ray.dir);
            if (const auto cell = looks.cell_at(at)) {
                if (looks.has_color()) w.albedo = linear_from_srgb8(looks.color(*cell, -ray.dir));
                w.emission = looks.emission(*cell, -ray.dir);
            }
            return;
        }
        const shared::GridHit hit = move_to_open_face(dag_, ray, tile.hits[k]);
        const int level = whole_dag_.depth() - hit.height;
        if (const auto albedo = looks.albedo(hit.path, level, -ray.dir)) w.albedo = *albedo;
        w.emission = looks.emission(hit.path, level, -ray.dir).value_or(vec3(0.0f));
    }

    static void add_unshadowed(const SeenLamp& lamp, const ivec2& some, std::uint32_t seed,
                               RayQueue& queue) {
        for (int i = some.x; i < some.y && !lamp.dark(); ++i)
            queue.add_seen(lamp.ray(i, seed).light);
    }

    [[nodiscard]] vec3 shade(const Waiting& w, const Tile& tile) const {
        constexpr float kPerPi = 0.31830989f;
        const float sky = w.sky_rays == 0
                              ? 1.0f
                              : tile.sky_queue.seen(w.sky_group) / static_cast<float>(w.sky_rays);
        vec3 light = sky * (options_.sky ? options_.sky->diffuse(w.normal)
                                         : shared::sky_light(w.normal, settings_.up));
        for (std::size_t i = w.first_lamp; i < w.end_lamp; ++i) {
            const Asked& asked = tile.asked[i];
            light += lamps_[asked.lamp].light().intensity *
                     (kPerPi * tile.lamp_queues[asked.queue].seen(asked.group) /
                      static_cast<float>(w.lamp_rays));
        }
        return w.albedo * light + w.emission;
    }

    const Dag& whole_dag_;
    shared::DagView dag_;
    const Grid& grid_;
    const RenderOptions& options_;
    RenderSettings settings_;
    std::vector<Lamp> lamps_;
    LightGrid lamp_grid_;
    Partitions* partitions_;
    WideWalk walk_;
};

}  // namespace

Image render(const Dag& dag, const Grid& grid, const RenderOptions& options) {
    std::optional<Partitions> own;
    if (options.wide && options.partitions == nullptr) own.emplace(dag);
    const Picture picture(dag, grid, options,
                          !options.wide ? nullptr
                          : own         ? &*own
                                        : options.partitions);
    return draw_tiles<NormalCache>(
        options, 200, [&](const PictureTile& tile, NormalCache& normals, Image& image) {
            picture.draw_tile(tile, normals, image);
        });
}

}  // namespace octavo
