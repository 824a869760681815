// SPDX-License-Identifier: MIT
#include "octavo/render/render_lit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "octavo/core/error.h"
#include "octavo/light/cell_views.h"
#include "octavo/light/gather.h"
#include "octavo/render/effects.h"
#include "octavo/render/settings.h"
#include "octavo/render/tiles.h"

namespace octavo {
namespace {

/// From this bounce on, a path goes on with the probability of what it still carries.
constexpr int kCertainBounces = 3;
constexpr float kMostSurvival = 0.95f;

/// All that the pixels of one picture have in common.
class LitPicture {
public:
    LitPicture(const LitScene& scene, Lighting lighting, const RenderOptions& options)
        : lighting_(lighting),
          options_(options),
          camera_(picture_camera(
              options, framed_box(scene.objects.front().dag, scene.objects.front().grid))),
          world_(scene, camera_.eye, options.wide ? WideWalk::by_size : WideWalk::one_by_one),
          rays_(camera_, world_.instances().grid(), options.width, options.height) {
        counts_ = {options.shadow_samples, std::max(1, options.ao_samples),
                   std::max(1, options.ao_samples / 4), options.shadows == Shadows::hard};
        if (lighting == Lighting::reference)
            counts_ = {options.samples, options.samples, options.samples, counts_.hard};
    }

    void draw_tile(const PictureTile& tile, NormalCaches& normals, Image& image) const {
        std::vector<Pixel> pixels;
        for (int y = tile.low.y; y < tile.high.y; ++y)
            for (int x = tile.low.x; x < tile.high.x; ++x)
                pixels.push_back({{x, y},
                                  shared::pixel_seed(static_cast<std::uint32_t>(x),
                                                     static_cast<std::uint32_t>(y), options_.frame),
                                  vec3(0.0f)});
        std::vector<shared::GridRay> rays(pixels.size());
        std::vector<InstanceHit> hits(pixels.size());
        for (int i = 0; i < options_.samples; ++i) {
            for (std::size_t k = 0; k < pixels.size(); ++k) {
                vec2 at(0.5f);
                if (options_.samples > 1)
                    at = shared::sample_2d(static_cast<std::uint32_t>(i),
                                           pixels[k].seed ^ 0x2545f491u);
                rays[k] = shared::camera_ray(rays_.view(), pixels[k].at, at);
            }
            if (rays_.sees_nothing())
                for (std::size_t k = 0; k < rays.size(); ++k)
                    hits[k] = {0, rays[k], shared::make_miss(1e30f, 0)};
            else
                world_.instances().trace_closest(rays, shared::stop_at_voxels(), hits);
            if (i == 0) write_depths(pixels, hits, image);
            for (std::size_t k = 0; k < pixels.size(); ++k)
                pixels[k].sum +=
                    hits[k] ? world_.emission(world_.side(hits[k])) : world_.sky(rays[k].dir);
            if (lighting_ == Lighting::cached)
                add_cached(pixels, hits, normals);
            else if (lighting_ == Lighting::gathered)
                add_gathered(pixels, hits, i, normals);
            else
                add_paths(pixels, hits, i, normals);
        }
        for (const Pixel& pixel : pixels)
            image.color[image.index(pixel.at.x, pixel.at.y)] =
                pixel.sum / static_cast<float>(options_.samples);
    }

private:
    struct Pixel {
        ivec2 at;
        std::uint32_t seed;
        vec3 sum;
    };

    void write_depths(const std::vector<Pixel>& pixels, const std::vector<InstanceHit>& hits,
                      Image& image) const {
        const double voxel = world_.instances().grid().voxel_size;
        for (std::size_t k = 0; k < pixels.size(); ++k)
            image.depth[image.index(pixels[k].at.x, pixels[k].at.y)] =
                hits[k] ? static_cast<float>((rays_.t_before() + hits[k].hit.t) * voxel)
                        : std::numeric_limits<float>::infinity();
    }

    /// What comes back from the hit, by the light of the cells around it.
    void add_cached(std::vector<Pixel>& pixels, const std::vector<InstanceHit>& hits,
                    NormalCaches& normals) const {
        for (std::size_t k = 0; k < pixels.size(); ++k) {
            const InstanceHit& hit = hits[k];
            if (!hit) continue;
            const LitObject& object = world_.scene().objects[hit.object];
            const shared::DagView dag = shared::view(object.dag);
            const shared::GridHit open = move_to_open_face(dag, hit.ray, hit.hit);
            shared::SurfacePoint before = flat_point(hit.ray, open, 0);
            const shared::GridRay surface = surface_ray(before);
            if (options_.smooth_normals)
                before = smoothed_point(dag, hit.ray, open,
                                        normals[hit.object].get(dag, hit.ray, open), 0);
            const vec3 light = cached_light(dag, shared::view(object.attributes.cells()),
                                            shared::view(object.light), surface, before, open.face);
            pixels[k].sum += world_.albedo(world_.side(hit)) * light;
        }
    }

    void add_gathered(std::vector<Pixel>& pixels, const std::vector<InstanceHit>& hits, int i,
                      NormalCaches& normals) const {
        Gatherer gatherer(world_, LightFrom::lamps | LightFrom::sources | LightFrom::cells, counts_,
                          options_.samples);
        for (std::size_t k = 0; k < pixels.size(); ++k) {
            gatherer.begin();
            if (hits[k])
                gatherer.add(world_.point(hits[k], options_.smooth_normals, normals), i,
                             pixels[k].seed);
        }
        gatherer.trace();
        // A sum holds one sample's share of all light.
        for (std::size_t k = 0; k < pixels.size(); ++k)
            if (hits[k])
                pixels[k].sum += static_cast<float>(options_.samples) *
                                 world_.albedo(world_.side(hits[k])) * gatherer.light(k);
    }

    /// One path from each pixel: at each point the light that comes straight from lamps, sky and
    /// shining cells, and one ray further.
    void add_paths(std::vector<Pixel>& pixels, const std::vector<InstanceHit>& hits, int i,
                   NormalCaches& normals) const {
        struct Path {
            std::size_t pixel;
            InstanceHit hit;
            vec3 carried;  // of the light that is found, what arrives at the eye
        };
        std::vector<Path> paths;
        for (std::size_t k = 0; k < pixels.size(); ++k)
            if (hits[k]) paths.push_back({k, hits[k], vec3(1.0f)});
        Gatherer gatherer(world_, LightFrom::lamps | LightFrom::sources, counts_, options_.samples);
        gatherer.keep_hits();
        std::vector<Path> next;
        for (std::uint32_t bounce = 0; !paths.empty(); ++bounce) {
            gatherer.clear();
            for (Path& path : paths) {
                gatherer.begin();
                gatherer.add(world_.point(path.hit, options_.smooth_normals, normals), i,
                             shared::mix_bits(pixels[path.pixel].seed + bounce * 0x9e3779b9u));
                path.carried *= world_.albedo(world_.side(path.hit));
            }
            gatherer.trace();
            next.clear();
            for (std::size_t k = 0; k < paths.size(); ++k) {
                Path path = paths[k];
                Pixel& pixel = pixels[path.pixel];
                pixel.sum +=
                    static_cast<float>(options_.samples) * path.carried * gatherer.light(k);
                path.hit = gatherer.hit(k);
                if (!path.hit) continue;
                if (bounce >= kCertainBounces) {
                    const float most = std::max({path.carried.r, path.carried.g, path.carried.b});
                    const float survival = std::min(most, kMostSurvival);
                    const float chance = shared::sample_1d(
                        static_cast<std::uint32_t>(i),
                        shared::mix_bits(pixel.seed + bounce * 0x9e3779b9u) ^ 0x1b56c4e9u);
                    if (!(chance < survival)) continue;
                    path.carried /= survival;
                }
                next.push_back(path);
            }
            paths.swap(next);
        }
    }

    Lighting lighting_;
    const RenderOptions& options_;
    Camera camera_;
    LitWorld world_;
    PixelRays rays_;
    GatherRays counts_;
};

void check(const LitScene& scene, Lighting lighting, const RenderOptions& options) {
    const auto refuse = [](const std::string& what) { throw Error(Errc::bad_argument, what); };
    if (scene.objects.empty()) refuse("a scene has 1 to 2^20 objects");
    check(options);
    for (const LitObject& object : scene.objects)
        if (lighting == Lighting::cached && !object.dag.empty() && object.light.empty())
            refuse("an object has no stored light");
}

}  // namespace

Image render_lit(const LitScene& scene, Lighting lighting, const RenderOptions& options) {
    check(scene, lighting, options);
    const LitPicture picture(scene, lighting, options);
    // Paths take long: every tile is told of, so that the work can be stopped at once.
    const auto every =
        static_cast<std::uint64_t>(options.width) * static_cast<std::uint64_t>(options.height);
    return draw_tiles<NormalCaches>(
        options, every, [&](const PictureTile& tile, NormalCaches& normals, Image& image) {
            picture.draw_tile(tile, normals, image);
        });
}

}  // namespace octavo
