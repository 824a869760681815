// SPDX-License-Identifier: MIT
//
// What would a picture look like if the triangles themselves were lit?
//
//     trace_triangles SCENE FILE.octv OUT.exr WIDTHxHEIGHT SAMPLES EYE AT FOV
//
// Path-traces the triangles of SCENE with Embree 3, under the lamps and the sky that FILE.octv was
// lit by: what `octavo render --reference` does with the voxels. Surfaces are matt on both sides in
// the colour of their textures, cut-outs are holes. EYE and AT are X,Y,Z, FOV is vertical in
// degrees.
//
// Kajiya, "The Rendering Equation", SIGGRAPH 1986: a ray further and one to each kind of light from
// each point of a path, Russian roulette from the fourth on.
#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "octavo/attributes/surface_sampler.h"
#include "octavo/core/error.h"
#include "octavo/io/octv.h"
#include "octavo/light/point_text.h"
#include "octavo/light/sky.h"
#include "octavo/mesh/decode_textures.h"
#include "octavo/mesh/load.h"
#include "octavo/render/image.h"
#include "octavo/render/render.h"

namespace {

using namespace octavo;

constexpr int kCertainBounces = 3;
constexpr float kMostSurvival = 0.95f;
constexpr int kMostHoles = 64;  // that a ray goes through

[[noreturn]] void refuse(const std::string& what) {
    throw Error(Errc::bad_argument, what);
}

dvec3 parse_point(const char* text) {
    dvec3 point(0.0);
    if (std::sscanf(text, "%lf,%lf,%lf", &point.x, &point.y, &point.z) != 3)
        refuse(std::string("'") + text + "' is not X,Y,Z");
    return point;
}

/// One path's random numbers: a sequence for each of its choices.
class Chances {
public:
    Chances(std::uint32_t pixel, std::uint32_t sample) : pixel_(pixel), sample_(sample) {}
    float one() { return shared::sample_1d(sample_, next()); }
    vec2 two() { return shared::sample_2d(sample_, next()); }

private:
    std::uint32_t next() { return shared::mix_bits(pixel_ + 0x9e3779b9u * ++choice_); }
    std::uint32_t pixel_, sample_, choice_ = 0;
};

struct Surface {
    dvec3 position;
    vec3 normal;  // unit length, towards where it is seen from
    vec3 albedo, emission;
};

class Triangles {
public:
    explicit Triangles(const Scene& scene)
        : scene_(scene),
          sampler_(scene),
          size_(glm::length(scene.bounds().size())),
          device_(rtcNewDevice(nullptr)) {
        if (device_ == nullptr) throw Error(Errc::unsupported, "Embree does not start here");
        embree_ = rtcNewScene(device_);
        rtcSetSceneFlags(embree_, RTC_SCENE_FLAG_ROBUST);
        RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* positions = static_cast<vec3*>(
            rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    sizeof(vec3), scene.positions.size()));
        auto* triangles = static_cast<uvec3*>(
            rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(uvec3),
                                    scene.triangles.size()));
        if (positions == nullptr || triangles == nullptr)
            throw Error(Errc::limit, "Embree has no room for the triangles");
        std::ranges::transform(scene.positions, positions, [](const dvec3& p) { return vec3(p); });
        std::ranges::copy(scene.triangles, triangles);
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(embree_, mesh);
        rtcReleaseGeometry(mesh);
        rtcCommitScene(embree_);
        find_shining();
    }
    ~Triangles() {
        rtcReleaseScene(embree_);
        rtcReleaseDevice(device_);
    }
    Triangles(const Triangles&) = delete;
    Triangles& operator=(const Triangles&) = delete;

    /// How far above a surface a ray starts.
    [[nodiscard]] double lift() const { return 1e-5 * size_; }

    /// The first surface along a ray that is no hole, nearer than `t_max` lengths of the direction.
    [[nodiscard]] std::optional<Surface> hit(dvec3 from, const vec3& direction,
                                             double t_max) const {
        for (int holes = 0; holes < kMostHoles; ++holes) {
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            RTCRayHit ray{};
            ray.ray.org_x = static_cast<float>(from.x);
            ray.ray.org_y = static_cast<float>(from.y);
            ray.ray.org_z = static_cast<float>(from.z);
            ray.ray.dir_x = direction.x;
            ray.ray.dir_y = direction.y;
            ray.ray.dir_z = direction.z;
            ray.ray.tfar = static_cast<float>(t_max);
            ray.ray.mask = ~0u;
            ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(embree_, &context, &ray);
            if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
            Surface surface;
            surface.position = from + dvec3(direction) * static_cast<double>(ray.ray.tfar);
            surface.normal = glm::normalize(vec3(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z));
            if (glm::dot(surface.normal, direction) > 0.0f) surface.normal = -surface.normal;
            const SurfaceSample sample = look(ray.hit.primID, surface.position);
            if (sample.tint.opacity >= 32768) {
                surface.albedo =
                    vec3(sample.tint.color[0], sample.tint.color[1], sample.tint.color[2]) /
                    65535.0f;
                surface.emission = emission(sample);
                return surface;
            }
            const double past = lift() / static_cast<double>(glm::length(direction));
            from = surface.position + past * dvec3(direction);
            t_max -= static_cast<double>(ray.ray.tfar) + past;
            if (!(t_max > 0.0)) return std::nullopt;
        }
        return std::nullopt;
    }

    /// What shining triangles bring to a point, for an albedo of 1, by one ray.
    [[nodiscard]] vec3 from_shining(const dvec3& from, const vec3& normal, Chances& chances) const {
        if (areas_.empty()) return vec3(0.0f);
        const double place = static_cast<double>(chances.one()) * areas_.back();
        const auto at =
            static_cast<std::size_t>(std::ranges::upper_bound(areas_, place) - areas_.begin());
        const std::uint32_t triangle = shining_[std::min(at, shining_.size() - 1)];
        const auto corners = scene_.corners(triangle);
        const vec2 square = chances.two();
        const double root = std::sqrt(static_cast<double>(square.x));
        const double b = root * static_cast<double>(square.y), a = 1.0 - root;
        const dvec3 to = corners[0] + a * (corners[1] - corners[0]) + b * (corners[2] - corners[0]);
        const dvec3 way = to - from;
        const double distance2 = glm::dot(way, way);
        const dvec3 towards = way / std::sqrt(distance2);
        const dvec3 lamp =
            glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
        const double cosines = glm::dot(towards, dvec3(normal)) * std::abs(glm::dot(towards, lamp));
        if (!(cosines > 0.0) || !(distance2 > 0.0)) return vec3(0.0f);
        const double end = 1.0 - 4.0 * lift() / std::sqrt(distance2);
        if (end > 0.0 && hit(from, vec3(way), end)) return vec3(0.0f);
        return emission(look(triangle, to)) *
               static_cast<float>(cosines / distance2 * areas_.back() / std::numbers::pi);
    }

private:
    [[nodiscard]] SurfaceSample look(std::uint32_t triangle, const dvec3& at) const {
        return sampler_.prepare(triangle, scene_.corners(triangle), 1e-5 * size_).at(at);
    }
    [[nodiscard]] vec3 emission(const SurfaceSample& sample) const {
        return vec3(sample.emission[0], sample.emission[1], sample.emission[2]) *
               (sampler_.greatest_emission() / 1048576.0f);
    }
    void find_shining() {
        double sum = 0.0;
        for (std::uint32_t i = 0; i < scene_.triangles.size(); ++i) {
            const auto c = scene_.corners(i);
            const double area = 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
            if (!(area > 0.0) || !std::isfinite(area)) continue;
            if (!sampler_.prepare(i, c, 1e-5 * size_).emits()) continue;
            shining_.push_back(i);
            areas_.push_back(sum += area);
        }
    }

    const Scene& scene_;
    SurfaceSampler sampler_;
    double size_;
    std::vector<std::uint32_t> shining_;
    std::vector<double> areas_;  // of the shining triangles up to each
    RTCDevice device_;
    RTCScene embree_ = nullptr;
};

/// What lamps bring to a point, for an albedo of 1, by one ray to each. Of their kinds the sun, the
/// point and the spot's middle are known here.
vec3 from_lamps(const Triangles& triangles, std::span<const Light> lamps, const dvec3& from,
                const vec3& normal, Chances& chances) {
    vec3 sum(0.0f);
    for (const Light& lamp : lamps) {
        vec3 way = -vec3(lamp.direction);
        float light = std::numbers::inv_pi_v<float>;
        double end = 1e30;
        if (lamp.kind == Light::Kind::sun) {
            const shared::LampPatch disc =
                shared::facing_disc(way, static_cast<float>(lamp.size), 1e30f);
            way = glm::normalize(shared::patch_direction(disc, chances.two()));
        } else if (lamp.kind == Light::Kind::point) {
            const shared::LampPatch disc = shared::facing_disc(vec3(lamp.position - from),
                                                               static_cast<float>(lamp.size), 1.0f);
            way = shared::patch_direction(disc, chances.two());
            light /= glm::dot(way, way);
            end = 1.0;
        } else {
            refuse("only suns, points and what shines itself is traced here");
        }
        const float cosine = glm::dot(glm::normalize(way), normal);
        if (cosine > 0.0f && !triangles.hit(from, way, end)) sum += light * cosine * lamp.intensity;
    }
    return sum;
}

vec3 path(const Triangles& triangles, std::span<const Light> lamps, const Sky& sky,
          const dvec3& eye, vec3 direction, Chances& chances) {
    vec3 light(0.0f), carried(1.0f);
    dvec3 from = eye;
    for (int bounce = 0;; ++bounce) {
        const auto surface = triangles.hit(from, direction, 1e30);
        if (!surface) return light + carried * sky.radiance(direction);
        // Beyond the first surface rays are sent to what shines.
        if (bounce == 0) light += surface->emission;
        carried *= surface->albedo;
        from = surface->position + triangles.lift() * dvec3(surface->normal);
        light += carried * (from_lamps(triangles, lamps, from, surface->normal, chances) +
                            triangles.from_shining(from, surface->normal, chances));
        if (bounce >= kCertainBounces) {
            const float survival =
                std::min(std::max({carried.r, carried.g, carried.b}), kMostSurvival);
            if (!(chances.one() < survival)) return light;
            carried /= survival;
        }
        direction = shared::cosine_direction(surface->normal, chances.two());
    }
}

Sky sky_of(const std::string& name) {
    if (name == "none") return {};
    if (name == "clear") return Sky::clear({0, 1, 0});
    refuse("the sky '" + name + "' is not clear or none");
}

void run(char** argv) {
    Scene scene = load_scene(argv[1]);
    decode_textures(scene, WantedTextures::all);
    const Model model = read_octv(argv[2]);
    if (!model.metadata.light) refuse(std::string(argv[2]) + " has no light: run octavo light");
    const Sky sky = sky_of(model.metadata.light->sky);
    const std::vector<Light>& lamps = model.metadata.light->lights;
    int width = 0, height = 0;
    if (std::sscanf(argv[4], "%dx%d", &width, &height) != 2 || width < 1 || height < 1)
        refuse(std::string("'") + argv[4] + "' is not WIDTHxHEIGHT");
    const int samples = std::atoi(argv[5]);
    if (samples < 1) refuse(std::string("'") + argv[5] + "' is not a number of samples");
    const Camera camera = look_at(parse_point(argv[6]), parse_point(argv[7]), {0, 1, 0},
                                  std::atof(argv[8]) * std::numbers::pi / 180.0);
    const dvec3 right = glm::cross(camera.forward, camera.up);
    const double half = std::tan(0.5 * camera.vertical_fov);

    const Triangles triangles(scene);
    Image image(width, height);
    tbb::parallel_for(0, width * height, [&](int at) {
        const int x = at % width, y = at / width;
        const std::uint32_t seed =
            shared::pixel_seed(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0);
        vec3 sum(0.0f);
        for (int i = 0; i < samples; ++i) {
            Chances chances(seed, static_cast<std::uint32_t>(i));
            const glm::dvec2 inside(chances.two());
            const double across = (2.0 * (x + inside.x) - width) / height * half;
            const double upwards = (height - 2.0 * (y + inside.y)) / height * half;
            const vec3 direction(
                glm::normalize(camera.forward + across * right + upwards * camera.up));
            sum += path(triangles, lamps, sky, camera.eye, direction, chances);
        }
        image.color[image.index(x, y)] = sum / static_cast<float>(samples);
    });
    write_image(argv[3], image, 0.0);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 9) {
        std::fprintf(stderr,
                     "usage: trace_triangles SCENE FILE.octv OUT.exr WIDTHxHEIGHT SAMPLES "
                     "EYE AT FOV\n");
        return 2;
    }
    try {
        run(argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "trace_triangles: %s\n", error.what());
        return 3;
    }
    return 0;
}
