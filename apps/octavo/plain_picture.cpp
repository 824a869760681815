// SPDX-License-Identifier: MIT
#include "plain_picture.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>

#include "octavo/light/normal.h"
#include "octavo/render/pixel_rays.h"

namespace octavo::cli {
namespace {

class PlainPainter {
public:
    PlainPainter(const Model& model, const PlainOptions& options)
        : model_(model),
          options_(options),
          rays_(options.camera, model.grid(), options.width, options.height),
          dag_(shared::view(model.dag)),
          up_(glm::normalize(options.up)) {
        const int depth = model.grid().depth;
        stop_.height = depth - std::clamp(options.level, 0, depth);
        stop_.cone = static_cast<float>(options.detail) * rays_.pixel_pitch();
        stop_.time_before = rays_.t_before();
    }

    [[nodiscard]] vec3 pixel(int x, int y) const {
        const std::uint32_t seed =
            shared::pixel_seed(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0u);
        vec3 sum(0.0f);
        for (int i = 0; i < options_.samples; ++i) {
            vec2 inside(0.5f);
            if (options_.samples > 1)
                inside = shared::sample_2d(static_cast<std::uint32_t>(i), seed ^ 0x2545f491u);
            const shared::GridRay ray = camera_ray(rays_.view(), {x, y}, inside);
            sum += view(ray, rays_.sees_nothing() ? shared::make_miss(ray.t_max, 0)
                                                  : first_seen(dag_, ray, stop_));
        }
        return sum / static_cast<float>(options_.samples);
    }

private:
    [[nodiscard]] vec3 view(const shared::GridRay& ray, const shared::GridHit& met) const {
        if (options_.mode == PlainMode::steps) return steps_view(met);
        if (met.face == shared::kFaceNone) return shared::empty_view(ray, up_);
        const shared::GridHit hit = move_to_open_face(dag_, ray, met);
        switch (options_.mode) {
            case PlainMode::levels:
                return level_view(dag_, ray, hit, static_cast<float>(dag_.depth));
            case PlainMode::color:
                return shared::color_view(look(ray, hit));
            default:
                return shared::normal_view(options_.smooth ? smooth_normal(dag_, ray, hit)
                                                           : face_normal(ray, hit));
        }
    }

    /// What the cell sends out where it is lit by white from everywhere; clay without a colour.
    [[nodiscard]] vec3 look(const shared::GridRay& ray, const shared::GridHit& hit) const {
        const int level = dag_.depth - hit.height;
        const Attributes& attributes = model_.attributes;
        if (attributes.empty()) return shared::clay();
        return attributes.albedo(hit.path, level, -ray.dir).value_or(shared::clay()) +
               attributes.emission(hit.path, level, -ray.dir).value_or(vec3(0.0f));
    }

    const Model& model_;
    const PlainOptions& options_;
    PixelRays rays_;
    shared::DagView dag_;
    shared::Stop stop_;
    vec3 up_;
};

}  // namespace

std::vector<std::uint8_t> plain_picture(const Model& model, const PlainOptions& options,
                                        const std::function<bool()>& go_on) {
    const PlainPainter painter(model, options);
    const auto width = static_cast<std::size_t>(options.width);
    std::vector<std::uint8_t> bytes(3 * width * static_cast<std::size_t>(options.height));
    std::atomic<bool> stopped = false;
    tbb::parallel_for(tbb::blocked_range<int>(0, options.height, 4), [&](const auto& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) {
            if (stopped || !go_on()) {
                stopped = true;
                return;
            }
            std::uint8_t* out = bytes.data() + 3 * width * static_cast<std::size_t>(y);
            for (int x = 0; x < options.width; ++x) {
                const vec3 color = painter.pixel(x, y);
                for (int i = 0; i < 3; ++i)
                    *out++ = static_cast<std::uint8_t>(
                        std::lround(255.0f * std::clamp(color[i], 0.0f, 1.0f)));
            }
        }
    });
    if (stopped) bytes.clear();
    return bytes;
}

}  // namespace octavo::cli
