// SPDX-License-Identifier: MIT
//
// One pixel: primary rays, a lamp with shadow, and the sky with ambient occlusion, as in [K13]
// section 4, on neutral clay.
#include "octavo/render/render.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>

#include "octavo/core/parallel.h"
#include "octavo/render/camera.h"
#include "octavo/render/effects.h"
#include "octavo/render/normal.h"

namespace octavo {
namespace {

constexpr int kTile = 8;  // pixels; [K13] uses beams of 8x8

/// The smoothed normals of the cells that a tile has met: close to a surface many pixels share one.
/// A slot holds the last normal that fell on it, which depends on the cell and face alone, so the
/// picture does not depend on what is found here.
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
    std::array<Entry, 64> entries_;
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
        : dag_(shared::view(dag)),
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

    void draw_tile(int x0, int y0, Image& image) const {
        const int x1 = std::min(x0 + kTile, options_.width);
        const int y1 = std::min(y0 + kTile, options_.height);
        float start = 0.0f;
        if (options_.beam)
            if (const auto beam = rays_.bundle(x0, y0, x1, y1))
                start = beam_start(dag_, *beam, primary_stop_);
        NormalCache normals;
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) draw_pixel(x, y, start, normals, image);
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

    void draw_pixel(int x, int y, float start, NormalCache& normals, Image& image) const {
        const std::uint32_t seed = shared::pixel_seed(
            static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), options_.frame);
        vec3 sum(0.0f);
        float depth = 0.0f;
        for (int i = 0; i < options_.samples; ++i) {
            vec2 at(0.5f);
            if (options_.samples > 1)
                at = shared::sample_2d(static_cast<std::uint32_t>(i), seed ^ 0x2545f491u);
            const dvec3 dir = rays_.direction(x + at.x, y + at.y);
            shared::GridRay ray = rays_.ray(x + at.x, y + at.y);
            ray.t_min = start;
            shared::GridHit hit = shared::make_miss(ray.t_max, 0);
            if (!rays_.sees_nothing() && start < ray.t_max)
                hit = trace_closest(dag_, ray, primary_stop_);
            const bool found = hit.face != shared::kFaceNone;
            sum +=
                found ? shade(ray, move_to_open_face(dag_, ray, hit), i, seed, normals) : sky(dir);
            if (i == 0)
                depth = found ? static_cast<float>((rays_.t_before() + hit.t) * grid_.voxel_size)
                              : std::numeric_limits<float>::infinity();
        }
        const std::size_t index = image.index(x, y);
        image.color[index] = sum / static_cast<float>(options_.samples);
        image.depth[index] = depth;
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

    [[nodiscard]] vec3 shade(const shared::GridRay& ray, const shared::GridHit& hit, int i,
                             std::uint32_t seed, NormalCache& normals) const {
        vec3 normal = face_normal(ray, hit);
        shared::GridRay start = leave_hit(ray, hit, normal);
        int face = hit.face;
        if (options_.smooth_normals) {
            normal = normals.get(dag_, ray, hit);
            if (lift(start, kLift * static_cast<float>(1 << hit.height) * normal))
                face = shared::kFaceNone;
        }

        float open = 1.0f;
        if (options_.ao_samples > 0) {
            const ivec2 some = share(options_.ao_samples, i);
            const int seen = sky_samples_seen(dag_, start, face, normal, ao_radius_, ao_stop_,
                                              some.x, some.y, seed ^ 0x68bc21ebu);
            open = static_cast<float>(seen) / static_cast<float>(some.y - some.x);
        }
        const float facing_up = 0.5f + 0.5f * glm::dot(normal, vec3(up_));
        const vec3 ambient = open * glm::mix(kGroundLight, kSkyLight, facing_up);
        return kClay * (ambient + direct_light(start, face, normal, i, seed));
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

    /// Irradiance of the lamp, over pi.
    [[nodiscard]] vec3 direct_light(const shared::GridRay& start, int face, const vec3& normal,
                                    int i, std::uint32_t seed) const {
        shared::LampDisc lamp{-vec3(light_.direction), static_cast<float>(options_.light_size),
                              1e30f};
        float strength = 1.0f;
        if (light_.kind != Light::Kind::sun) {
            const dvec3 way =
                grid_.to_grid(light_.position) - dvec3(start.cell) - dvec3(start.frac);
            lamp = {vec3(way), static_cast<float>(options_.light_size / grid_.voxel_size), 1.0f};
            const double distance = glm::length(way) * grid_.voxel_size;
            strength = static_cast<float>(1.0 / std::max(distance * distance, 1e-30));
            if (light_.kind == Light::Kind::spot) strength *= spot_falloff(-glm::normalize(way));
        }
        const float cosine = glm::dot(normal, glm::normalize(lamp.to_centre));
        if (!(cosine > 0.0f) || strength == 0.0f) return vec3(0.0f);

        float seen = 1.0f;
        if (options_.shadows != Shadows::none) {
            ivec2 some = share(options_.shadow_samples, i);
            if (options_.shadows == Shadows::hard) {
                lamp.radius = 0.0f;
                some = {i, i + 1};
            }
            const int rays_seen = lamp_samples_seen(dag_, start, face, lamp, {0, 0.0f, 0.0f},
                                                    some.x, some.y, seed ^ 0x02e5be93u);
            seen = static_cast<float>(rays_seen) / static_cast<float>(some.y - some.x);
        }
        return light_.intensity * (seen * cosine * strength * 0.31830989f);
    }

    [[nodiscard]] float spot_falloff(const dvec3& from_light) const {
        const double cosine = glm::dot(from_light, light_.direction);
        const double outer = std::cos(light_.outer_angle);
        const double inner = std::max(std::cos(light_.inner_angle), outer + 1e-9);
        return static_cast<float>(glm::smoothstep(outer, inner, cosine));
    }

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
                    picture.draw_tile(x, y, image);
                    reporter.add(static_cast<std::uint64_t>(std::min(kTile, options.width - x) *
                                                            std::min(kTile, options.height - y)));
                }
            });
    });
    return image;
}

}  // namespace octavo
