// SPDX-License-Identifier: MIT
#include "triangle_tracer.h"

#include "octavo/core/error.h"

#if OCTAVO_HAS_EMBREE

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>

namespace octavo::cli {

struct TriangleTracer::Impl {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
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

TriangleTracer::TriangleTracer(const Scene& scene) : impl_(std::make_unique<Impl>()) {
    impl_->device = rtcNewDevice(nullptr);
    if (impl_->device == nullptr) throw Error(Errc::unsupported, "Embree does not start here");
    impl_->scene = rtcNewScene(impl_->device);
    RTCGeometry mesh = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<vec3*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3), scene.positions.size()));
    auto* triangles = static_cast<uvec3*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(uvec3), scene.triangles.size()));
    if (positions == nullptr || triangles == nullptr)
        throw Error(Errc::limit, "Embree has no room for the triangles");
    std::ranges::transform(scene.positions, positions, [](const dvec3& p) { return vec3(p); });
    std::ranges::copy(scene.triangles, triangles);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(impl_->scene, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(impl_->scene);
}

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
