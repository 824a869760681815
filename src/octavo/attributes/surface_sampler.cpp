// SPDX-License-Identifier: MIT
#include "octavo/attributes/surface_sampler.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <set>
#include <type_traits>

#include "octavo/mesh/alpha.h"
#include "octavo/mesh/decode_textures.h"

namespace octavo {
namespace {

// A texel that is as wide as the cell, with the tent that is between texels, would blur more than
// the cell does: of equal variance is one sqrt(3) narrower. log2 of that.
constexpr double kTentBias = -0.79;
constexpr int kMostSamples = 8;

float finite_or_zero(float x) {
    return std::isfinite(x) ? x : 0.0f;
}

std::uint32_t part_of(float x, float whole) {
    return static_cast<std::uint32_t>(std::clamp(x, 0.0f, 1.0f) * whole + 0.5f);
}

/// The weights of corners 1 and 2 at a point p of the triangle's plane: dot(w, (p, 1)).
std::array<dvec4, 2> barycentric_weights(const std::array<dvec3, 3>& c) {
    const dvec3 a = c[1] - c[0], b = c[2] - c[0];
    const dvec3 normal = glm::cross(a, b);
    const double square = glm::dot(normal, normal);
    if (!(square > 0.0)) return {};
    const dvec3 first = glm::cross(b, normal) / square;   // is 1 along a and 0 along b
    const dvec3 second = glm::cross(normal, a) / square;  // and the other way around
    return {dvec4(first, -glm::dot(first, c[0])), dvec4(second, -glm::dot(second, c[0]))};
}

}  // namespace

SurfaceSampler::SurfaceSampler(const Scene& scene, const std::filesystem::path& scratch)
    : scene_(&scene),
      materials_(scene.materials),
      has_coordinates_(!scene.texture_coordinates.empty()),
      has_colors_(!scene.colors.empty()),
      look_words_(scene.emission_coordinates.empty() ? kLookWords : kLookWordsWithEmission) {
    for (const Material& m : materials_)
        for (int i = 0; i < 3; ++i)
            greatest_emission_ = std::max(greatest_emission_, finite_or_zero(m.emission[i]));
    if (has_coordinates_) make_textures(scene, scratch);
    if (!scratch.empty()) write_looks(scene, scratch);
}

/// What is asked for is known beforehand, so that later everything is read only.
void SurfaceSampler::make_textures(const Scene& scene, const std::filesystem::path& scratch) {
    const auto known = [&](int texture) {
        return texture >= 0 && static_cast<std::size_t>(texture) < scene.textures.size();
    };
    std::set<std::pair<int, int>> wanted;
    std::pair<int, int> last(-1, 0);  // mostly that of the next triangle too
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        const Material& m = material_of(scene, t);
        if (known(m.base_color_texture))
            if (const std::pair key(m.base_color_texture, std::min(255, least_alpha(scene, t)));
                key != last)
                wanted.insert(last = key);
        if (known(m.emission_texture) && m.emission != vec3(0.0f))
            wanted.emplace(m.emission_texture, 0);
    }
    const std::vector<std::pair<int, int>> keys(wanted.begin(), wanted.end());
    std::vector<std::optional<MipTexture>> made(keys.size());
    std::vector<std::string> warnings(keys.size());
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, keys.size(), 1),
        [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const auto [index, holes] = keys[i];
                const auto picture = decoded_picture(scene, index, warnings[i]);
                if (!picture) continue;
                const Texture& texture = scene.textures[static_cast<std::size_t>(index)];
                made[i].emplace(picture, MipTexture::Wraps{texture.wrap_u, texture.wrap_v}, holes,
                                scratch);
            }
        },
        tbb::simple_partitioner());
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (made[i]) textures_.emplace(keys[i], std::move(*made[i]));
        if (!warnings[i].empty() && (warnings_.empty() || warnings_.back() != warnings[i]))
            warnings_.push_back(warnings[i]);
    }
}

void SurfaceSampler::write_looks(const Scene& scene, const std::filesystem::path& scratch) {
    static_assert(offsetof(Look, of_emission) == kLookWords * sizeof(std::uint32_t));
    static_assert(sizeof(Look) == kLookWordsWithEmission * sizeof(std::uint32_t));
    static_assert(std::is_trivially_copyable_v<Look>);
    constexpr std::size_t kAtOnce = 4096;
    const std::size_t count = scene.triangles.size();
    const std::size_t bytes_each = look_words_ * sizeof(std::uint32_t);
    SpillFile file(scratch / "looks", SpillFile::Kind::temporary);
    std::vector<std::uint32_t> some(kAtOnce * look_words_);
    for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
        const std::size_t end = std::min(count, begin + kAtOnce);
        for (std::size_t t = begin; t < end; ++t) {
            const Look look = look_of(scene, t);
            std::memcpy(&some[(t - begin) * look_words_], &look, bytes_each);
        }
        file.write(begin * bytes_each, some.data(), (end - begin) * bytes_each);
    }
    looks_ = std::make_shared<MappedWords>(file, count * look_words_);
    scene_ = nullptr;
}

SurfaceSampler::Look SurfaceSampler::look_of(const Scene& scene, std::size_t triangle) {
    Look look{Scene::kNoMaterial, {}, {}, {}};
    if (!scene.triangle_materials.empty()) look.material = scene.triangle_materials[triangle];
    for (unsigned i = 0; i < 3; ++i) {
        const std::uint32_t vertex = scene.triangles[triangle][static_cast<int>(i)];
        look.colors[i] = scene.colors.empty() ? std::array<std::uint8_t, 4>{255, 255, 255, 255}
                                              : scene.colors[vertex];
        look.coordinates[i] =
            scene.texture_coordinates.empty() ? vec2(0.0f) : scene.texture_coordinates[vertex];
        look.of_emission[i] = scene.emission_coordinates.empty()
                                  ? look.coordinates[i]
                                  : scene.emission_coordinates[vertex];
    }
    return look;
}

SurfaceSampler::Look SurfaceSampler::look(std::size_t triangle) const {
    if (!looks_) return look_of(*scene_, triangle);
    Look look;
    std::memcpy(&look, looks_->words().data() + look_words_ * triangle,
                look_words_ * sizeof(std::uint32_t));
    if (look_words_ == kLookWords) look.of_emission = look.coordinates;
    return look;
}

void SurfaceSampler::release() const {
    if (looks_) release_pages(looks_->words());
    for (const auto& [key, texture] : textures_) texture.release();
}

const Material& SurfaceSampler::material(std::uint32_t index) const {
    return index < materials_.size() ? materials_[index] : plain_material(has_colors_);
}

const MipTexture* SurfaceSampler::mip_texture(int texture, int least_alpha) const {
    const auto found = textures_.find({texture, least_alpha});
    return found == textures_.end() ? nullptr : &found->second;
}

SurfaceSampler::Triangle SurfaceSampler::prepare(std::size_t triangle,
                                                 const std::array<dvec3, 3>& corners,
                                                 double footprint) const {
    Triangle t;
    const Look look = this->look(triangle);
    const Material& material = this->material(look.material);
    t.weights_ = barycentric_weights(corners);
    for (unsigned i = 0; i < 3; ++i) {
        vec4 color = material.base_color;
        if (has_colors_) {
            const auto& c = look.colors[i];
            color *= vec4(c[0], c[1], c[2], c[3]) / 255.0f;
        }
        t.corner_colors_[i] = color;
    }
    t.one_color_ =
        t.corner_colors_[0] == t.corner_colors_[1] && t.corner_colors_[0] == t.corner_colors_[2];
    if (greatest_emission_ > 0.0f) {
        t.emission_ = material.emission / greatest_emission_;
        t.emits_ = t.emission_ != vec3(0.0f);
    }
    t.plain_ = t.one_color_ && !t.emits_;
    if (textures_.empty()) return t;

    const int holes = std::min(
        255,
        least_alpha(material, std::max({look.colors[0][3], look.colors[1][3], look.colors[2][3]})));
    t.has_holes_ = holes > 0;
    t.base_.texture = mip_texture(material.base_color_texture, holes);
    if (t.emits_) t.glow_.texture = mip_texture(material.emission_texture, 0);
    const auto prepare_filter = [&](Triangle::Filter& filter, const std::array<vec2, 3>& placed) {
        if (!filter.texture) return;
        if (!place(filter, placed, t.weights_)) {
            filter.texture = nullptr;
            return;
        }
        choose_filter(filter, footprint);
        simplify(filter, placed);
    };
    prepare_filter(t.base_, look.coordinates);
    prepare_filter(t.glow_, look.of_emission);
    t.plain_ &= !t.has_holes_ && (!t.base_.texture || t.base_.simple);
    return t;
}

bool SurfaceSampler::place(Triangle::Filter& filter, const std::array<vec2, 3>& corners,
                           const std::array<dvec4, 2>& weights) {
    const glm::dvec2 first(corners[0]);
    const glm::dvec2 a = glm::dvec2(corners[1]) - first, b = glm::dvec2(corners[2]) - first;
    if (!std::isfinite(first.x + first.y + a.x + a.y + b.x + b.y)) return false;
    for (int i = 0; i < 2; ++i)
        filter.coordinates[static_cast<unsigned>(i)] =
            a[i] * weights[0] + b[i] * weights[1] + dvec4(0.0, 0.0, 0.0, first[i]);
    return true;
}

/// The footprint of a piece in the texture is an ellipse: samples as wide as it is narrow, side by
/// side along its length.
void SurfaceSampler::choose_filter(Triangle::Filter& filter, double footprint) {
    const std::array<dvec4, 2>& coordinates = filter.coordinates;
    const glm::dvec2 size(filter.texture->width(), filter.texture->height());
    const dvec3 u = dvec3(coordinates[0]) * size.x * footprint;  // texels along a piece
    const dvec3 v = dvec3(coordinates[1]) * size.y * footprint;
    const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v);
    const double middle = 0.5 * (uu + vv), reach = std::hypot(0.5 * (uu - vv), uv);
    const double length = std::sqrt(middle + reach);
    const double width = std::sqrt(std::max(middle - reach, 0.0));
    if (!(length > 0.0) || !std::isfinite(length)) {
        filter.level = &filter.texture->level(0);
        return;
    }

    // A piece narrower than a texel needs no narrower samples.
    const double ratio = length / std::max({width, 1.0, length / kMostSamples});
    filter.samples = std::clamp(static_cast<int>(std::ceil(ratio - 0.25)), 1, kMostSamples);
    filter.level = &filter.texture->level(static_cast<int>(
        std::clamp(std::round(std::log2(length / filter.samples) + kTentBias), 0.0, 31.0)));
    filter.share = 1.0f / static_cast<float>(filter.samples);
    if (filter.samples == 1) return;
    const glm::dvec2 long_way = std::abs(uv) > 1e-12 * middle
                                    ? glm::normalize(glm::dvec2(uv, middle + reach - uu))
                                : uu >= vv ? glm::dvec2(1.0, 0.0)
                                           : glm::dvec2(0.0, 1.0);
    filter.step = long_way * (length / filter.samples) / size;
}

/// Nearly all textures repeat and have sides of powers of two.
void SurfaceSampler::simplify(Triangle::Filter& filter, const std::array<vec2, 3>& corners) {
    constexpr double kFar = 1e9;  // texels; whole periods are left for what is around a triangle
    const glm::dvec2 size = filter.level->size();
    filter.simple = filter.level->is_simple();
    for (const vec2& corner : corners)
        filter.simple &=
            glm::all(glm::lessThan(glm::abs(glm::dvec2(corner)) * size, glm::dvec2(kFar)));
    const dvec4 u = filter.coordinates[0] * size.x, v = filter.coordinates[1] * size.y;
    for (int i = 0; i < 4; ++i)
        filter.texels[static_cast<unsigned>(i)] = Triangle::TwoDoubles{u[i], v[i]};
    filter.texels[3] += MipTexture::Level::kPeriods - 0.5;
    filter.texel_step = Triangle::TwoDoubles{filter.step.x * size.x, filter.step.y * size.y};
}

vec4 SurfaceSampler::Triangle::sum_of_samples(const Filter& filter, const dvec3& point) const {
    if (filter.simple) {
        const detail::FourFloats sum = filter.sum_of_simple_samples(point);
        return {sum[0], sum[1], sum[2], sum[3]};
    }
    const double first = -0.5 * (filter.samples - 1);
    const dvec4 p(point, 1.0);
    const glm::dvec2 middle(glm::dot(filter.coordinates[0], p), glm::dot(filter.coordinates[1], p));
    vec4 sum(0.0f);
    for (int i = 0; i < filter.samples; ++i)
        sum += filter.level->sample(middle + (i + first) * filter.step);
    return sum;
}

SurfaceSample SurfaceSampler::Triangle::any_at(const dvec3& point) const {
    SurfaceSample sample;
    const dvec4 p(point, 1.0);
    vec4 color = corner_colors_[0];
    if (!one_color_) {
        const auto b = static_cast<float>(std::clamp(glm::dot(weights_[0], p), 0.0, 1.0));
        const auto c = static_cast<float>(std::clamp(glm::dot(weights_[1], p), 0.0, 1.0));
        color = (1.0f - b - c) * color + b * corner_colors_[1] + c * corner_colors_[2];
    }
    vec3 base(color);
    if (base_.texture) {
        const vec4 sum = sum_of_samples(base_, point);
        if (!has_holes_) {
            base *= vec3(sum) * base_.share;
        } else if (sum.a > 1e-5f) {
            base *= vec3(sum) / sum.a;
        } else {
            base *= base_.texture->color_around(
                {glm::dot(base_.coordinates[0], p), glm::dot(base_.coordinates[1], p)});
        }
        if (has_holes_)
            sample.tint.opacity =
                static_cast<std::uint16_t>(part_of(sum.a * base_.share, 65535.0f));
    }
    vec3 glow = emission_;
    if (glow_.texture) {
        glow *= vec3(sum_of_samples(glow_, point)) * glow_.share;
    }
    for (int i = 0; i < 3; ++i) {
        sample.tint.color[static_cast<unsigned>(i)] =
            static_cast<std::uint16_t>(part_of(base[i], 65535.0f));
        if (emits_) sample.emission[static_cast<unsigned>(i)] = part_of(glow[i], 1048576.0f);
    }
    return sample;
}

}  // namespace octavo
