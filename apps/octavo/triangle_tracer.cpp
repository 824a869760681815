// SPDX-License-Identifier: MIT
#include "triangle_tracer.h"

#include "octavo/core/error.h"

#if OCTAVO_HAS_EMBREE

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "octavo/mesh/hole_maps.h"

namespace octavo::cli {
namespace {

/// A triangle with holes, and where its corners are in the texture, in pixels.
struct HoledTriangle {
    const OpacityMap* map;  // none: all of it is hole
    std::array<glm::dvec2, 3> corners;

    /// @param u, v  weights of the second and the third corner
    [[nodiscard]] bool is_hole(float u, float v) const {
        if (!map) return true;
        const glm::dvec2 place = corners[0] + static_cast<double>(u) * (corners[1] - corners[0]) +
                                 static_cast<double>(v) * (corners[2] - corners[0]);
        // As for voxels: coordinates that are no number, or too far out to count, say nothing.
        constexpr double kFarthest = 1e15;
        if (!(std::max(std::abs(place.x), std::abs(place.y)) < kFarthest)) return false;
        const OpacityMap::Pixel pixel = {static_cast<std::int64_t>(std::floor(place.x)),
                                         static_cast<std::int64_t>(std::floor(place.y))};
        return map->find(pixel, pixel).hole;
    }
};

/// Embree asks this of each hit on a geometry of holed triangles.
void leave_out_holes(const RTCFilterFunctionNArguments* hits) {
    const auto* triangles = static_cast<const HoledTriangle*>(hits->geometryUserPtr);
    for (unsigned i = 0; i < hits->N; ++i)
        if (hits->valid[i] != 0 &&
            triangles[RTCHitN_primID(hits->hit, hits->N, i)].is_hole(
                RTCHitN_u(hits->hit, hits->N, i), RTCHitN_v(hits->hit, hits->N, i)))
            hits->valid[i] = 0;
}

HoledTriangle holed_triangle(const Scene& scene, std::size_t triangle, const OpacityMap* map) {
    HoledTriangle holed{map, {}};
    if (!map) return holed;
    const uvec3& t = scene.triangles[triangle];
    const glm::dvec2 size(map->width(), map->height());
    for (int i = 0; i < 3; ++i)
        holed.corners[static_cast<unsigned>(i)] =
            glm::dvec2(scene.texture_coordinates[t[i]]) * size;
    return holed;
}

}  // namespace

struct TriangleTracer::Impl {
    explicit Impl(const Scene& of) : holes(of) {
        if (device == nullptr) throw Error(Errc::unsupported, "Embree does not start here");
        // Embree reads 16 bytes at each position.
        RTCBuffer positions =
            rtcNewBuffer(device, of.positions.size() * sizeof(vec3) + 16 - sizeof(vec3));
        if (positions == nullptr) refuse();
        std::ranges::transform(of.positions, static_cast<vec3*>(rtcGetBufferData(positions)),
                               [](const dvec3& p) { return vec3(p); });
        std::vector<uvec3> solid, with_holes;
        for (std::size_t i = 0; i < of.triangles.size(); ++i) {
            const HoleMaps::Holes of_this = holes.of(i);
            (of_this.any ? with_holes : solid).push_back(of.triangles[i]);
            if (of_this.any) holed.push_back(holed_triangle(of, i, of_this.map));
        }
        // Apart, since all hits of a geometry are asked about.
        attach(positions, of.positions.size(), solid);
        attach(positions, of.positions.size(), with_holes, holed.data());
        rtcReleaseBuffer(positions);
        rtcCommitScene(scene);
    }
    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    void attach(RTCBuffer positions, std::size_t position_count, const std::vector<uvec3>& some,
                HoledTriangle* holed_triangles = nullptr) const {
        if (some.empty()) return;
        RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions, 0,
                             sizeof(vec3), position_count);
        auto* triangles = static_cast<uvec3*>(rtcSetNewGeometryBuffer(
            mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(uvec3), some.size()));
        if (triangles == nullptr) refuse();
        std::ranges::copy(some, triangles);
        if (holed_triangles != nullptr) {
            rtcSetGeometryUserData(mesh, holed_triangles);
            rtcSetGeometryIntersectFilterFunction(mesh, leave_out_holes);
            rtcSetGeometryOccludedFilterFunction(mesh, leave_out_holes);
        }
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(scene, mesh);
        rtcReleaseGeometry(mesh);
    }
    [[noreturn]] static void refuse() {
        throw Error(Errc::limit, "Embree has no room for the triangles");
    }

    HoleMaps holes;
    std::vector<HoledTriangle> holed;
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = device == nullptr ? nullptr : rtcNewScene(device);
};

namespace {

RTCIntersectContext context(bool coherent) {
    RTCIntersectContext c;
    rtcInitIntersectContext(&c);
    if (coherent) c.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return c;
}

void set_ray(RTCRay& to, const TriangleRay& ray) {
    to = {};
    to.org_x = ray.origin.x;
    to.org_y = ray.origin.y;
    to.org_z = ray.origin.z;
    to.dir_x = ray.direction.x;
    to.dir_y = ray.direction.y;
    to.dir_z = ray.direction.z;
    to.tfar = ray.t_max;
    to.mask = ~0u;
}

void set_ray(RTCRay16& to, int lane, const TriangleRay& ray) {
    to.org_x[lane] = ray.origin.x;
    to.org_y[lane] = ray.origin.y;
    to.org_z[lane] = ray.origin.z;
    to.dir_x[lane] = ray.direction.x;
    to.dir_y[lane] = ray.direction.y;
    to.dir_z[lane] = ray.direction.z;
    to.tnear[lane] = 0.0f;
    to.tfar[lane] = ray.t_max;
    to.time[lane] = 0.0f;
    to.mask[lane] = ~0u;
    to.flags[lane] = 0;
    to.id[lane] = 0;
}

/// Calls visit(first, count, valid) for each 16 rays; the last may be fewer.
template <class Visit>
void for_each_packet(std::size_t count, const Visit& visit) {
    alignas(64) int valid[16];
    for (std::size_t first = 0; first < count; first += 16) {
        const std::size_t some = std::min<std::size_t>(16, count - first);
        for (std::size_t i = 0; i < 16; ++i) valid[i] = i < some ? -1 : 0;
        visit(first, static_cast<int>(some), valid);
    }
}

}  // namespace

TriangleTracer::TriangleTracer(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}

TriangleTracer::~TriangleTracer() = default;

void TriangleTracer::closest(std::span<const TriangleRay> rays, Width width, bool coherent,
                             std::span<TriangleHit> hits) const {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    RTCIntersectContext c = context(coherent);
    if (width == Width::one) {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            RTCRayHit hit;
            set_ray(hit.ray, rays[i]);
            hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(impl_->scene, &c, &hit);
            const bool found = hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
            hits[i] = {found ? hit.ray.tfar : kInf, {hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z}};
        }
        return;
    }
    for_each_packet(rays.size(), [&](std::size_t first, int count, const int* valid) {
        RTCRayHit16 hit;
        for (int i = 0; i < count; ++i) {
            set_ray(hit.ray, i, rays[first + static_cast<std::size_t>(i)]);
            hit.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            hit.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, impl_->scene, &c, &hit);
        for (int i = 0; i < count; ++i) {
            const bool found = hit.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
            hits[first + static_cast<std::size_t>(i)] = {
                found ? hit.ray.tfar[i] : kInf,
                {hit.hit.Ng_x[i], hit.hit.Ng_y[i], hit.hit.Ng_z[i]}};
        }
    });
}

void TriangleTracer::any(std::span<const TriangleRay> rays, Width width, bool coherent,
                         std::span<std::uint8_t> occluded) const {
    RTCIntersectContext c = context(coherent);
    if (width == Width::one) {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            RTCRay ray;
            set_ray(ray, rays[i]);
            rtcOccluded1(impl_->scene, &c, &ray);
            occluded[i] = ray.tfar < 0.0f;
        }
        return;
    }
    for_each_packet(rays.size(), [&](std::size_t first, int count, const int* valid) {
        RTCRay16 packet;
        for (int i = 0; i < count; ++i)
            set_ray(packet, i, rays[first + static_cast<std::size_t>(i)]);
        rtcOccluded16(valid, impl_->scene, &c, &packet);
        for (int i = 0; i < count; ++i)
            occluded[first + static_cast<std::size_t>(i)] = packet.tfar[i] < 0.0f;
    });
}

}  // namespace octavo::cli

#else

namespace octavo::cli {

struct TriangleTracer::Impl {};

TriangleTracer::TriangleTracer(const Scene&) {
    throw Error(Errc::unsupported,
                "this program was built without Embree: install libembree-dev and build again");
}
TriangleTracer::~TriangleTracer() = default;
void TriangleTracer::closest(std::span<const TriangleRay>, Width, bool,
                             std::span<TriangleHit>) const {}
void TriangleTracer::any(std::span<const TriangleRay>, Width, bool, std::span<std::uint8_t>) const {
}

}  // namespace octavo::cli

#endif
