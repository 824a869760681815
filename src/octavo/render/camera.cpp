// SPDX-License-Identifier: MIT
#include "octavo/render/camera.h"

#include <algorithm>
#include <cmath>

#include "octavo/core/error.h"
#include "octavo/render/render.h"

namespace octavo {
namespace {

/// Voxels from the grid's centre up to which a float tells neighbouring voxels' planes well apart.
constexpr double kNear = 1 << 20;
/// Beyond this a cell's number may leave 32 bits.
constexpr double kFarthest = 1 << 29;

constexpr double kTenDegrees = 0.17453292519943295;

/// Four times that of the real sun: its penumbra shows from some metres on, as on a hazy day.
constexpr double kSunRadius = 0.02;

bool finite(const dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Some unit vector at right angles to a unit vector.
dvec3 any_perpendicular(const dvec3& v) {
    const dvec3 axis = std::abs(v.z) < 0.7 ? dvec3(0, 0, 1) : dvec3(0, 1, 0);
    return glm::normalize(axis - v * glm::dot(axis, v));
}

dvec3 checked_up(const dvec3& up) {
    const double length = glm::length(up);
    if (!finite(up) || length == 0.0)
        throw Error(Errc::bad_argument, "the up direction is zero or not finite");
    return up / length;
}

}  // namespace

PixelRays::PixelRays(const Camera& camera, const Grid& grid, int width, int height)
    : forward_(glm::normalize(camera.forward)),
      right_(glm::normalize(glm::cross(forward_, camera.up))),
      up_(glm::cross(right_, forward_)),
      eye_(grid.to_grid(camera.eye)),
      pitch_(2.0 * std::tan(0.5 * camera.vertical_fov) / height),
      half_width_(0.5 * width * pitch_),
      half_height_(0.5 * height * pitch_) {
    const double side = grid.resolution();
    const dvec3 to_centre = 0.5 * side - eye_;
    if (glm::length(to_centre) <= kNear) return;
    t_before_ = std::max(0.0, glm::dot(forward_, to_centre) - side);
    const double last = glm::length(eye_ + t_before_ * direction(0, 0) - 0.5 * side);
    sees_nothing_ = !(last < kFarthest);
}

shared::GridRay PixelRays::ray(double x, double y) const {
    const dvec3 dir = direction(x, y);
    const dvec3 origin = eye_ + t_before_ * dir;
    const dvec3 cell = glm::floor(origin);
    return {ivec3(cell), vec3(origin - cell), vec3(dir), 0.0f, 1e30f};
}

std::optional<shared::Bundle> PixelRays::bundle(int x0, int y0, int x1, int y1) const {
    if (t_before_ > 0.0) return std::nullopt;
    const shared::GridRay corner = ray(x0, y0);
    shared::Bundle beam{corner.cell, corner.frac, corner.dir, corner.dir, 0.0f, 1e30f, 0.0f};
    const ivec2 others[] = {{x1, y0}, {x0, y1}, {x1, y1}};
    for (const ivec2& at : others) {
        const vec3 dir(direction(at.x, at.y));
        beam.dir_low = glm::min(beam.dir_low, dir);
        beam.dir_high = glm::max(beam.dir_high, dir);
    }
    // Rounding may carry a ray between the corners past them by a little.
    beam.dir_low -= 1e-6f;
    beam.dir_high += 1e-6f;
    beam.spread = static_cast<float>(pitch_ * std::max(x1 - x0, y1 - y0));
    return beam;
}

Camera look_at(const dvec3& eye, const dvec3& target, const dvec3& up, double vertical_fov) {
    if (!finite(eye) || !finite(target))
        throw Error(Errc::bad_argument, "the camera's position or target is not finite");
    if (eye == target) throw Error(Errc::bad_argument, "the camera stands where it looks at");
    if (!(vertical_fov > 0.0 && vertical_fov < 3.14159))
        throw Error(Errc::bad_argument, "the field of view is not in 0 to 180 degrees");
    Camera camera;
    camera.eye = eye;
    camera.forward = glm::normalize(target - eye);
    const dvec3 right = glm::cross(camera.forward, checked_up(up));
    if (glm::length(right) < 1e-9)
        throw Error(Errc::bad_argument, "the camera's up direction is parallel to its view");
    camera.up = glm::normalize(glm::cross(right, camera.forward));
    camera.vertical_fov = vertical_fov;
    return camera;
}

Camera default_camera(const Box& box, const dvec3& up, double aspect) {
    const dvec3 y = checked_up(up);
    const dvec3 z = any_perpendicular(y);
    const dvec3 x = glm::cross(y, z);
    const dvec3 towards_eye = glm::normalize(1.0 * x + 0.6 * y + 1.4 * z);
    const double fov = 4.0 * kTenDegrees;
    const double slope = std::tan(0.5 * fov);
    Camera camera = look_at(box.centre() + towards_eye, box.centre(), y, fov);
    const dvec3 right = glm::cross(camera.forward, camera.up);
    double distance = 1e-12;
    for (int i = 0; i < 8; ++i) {
        const dvec3 to_corner = (dvec3(i & 1, i >> 1 & 1, i >> 2) - 0.5) * box.size();
        const double height = std::abs(glm::dot(to_corner, camera.up)) / slope;
        const double width = std::abs(glm::dot(to_corner, right)) / (slope * aspect);
        distance =
            std::max(distance, std::max(height, width) - glm::dot(to_corner, camera.forward));
    }
    camera.eye = box.centre() + 1.04 * distance * towards_eye;
    return camera;
}

Light sun_at(double azimuth, double elevation, const dvec3& up) {
    if (!std::isfinite(azimuth) || !std::isfinite(elevation))
        throw Error(Errc::bad_argument, "the sun's azimuth or elevation is not finite");
    const dvec3 y = checked_up(up);
    const dvec3 z = any_perpendicular(y);
    const dvec3 x = glm::cross(y, z);
    Light sun;
    sun.name = "sun";
    sun.direction = -(std::cos(elevation) * (std::sin(azimuth) * x + std::cos(azimuth) * z) +
                      std::sin(elevation) * y);
    sun.intensity = vec3(1.0f, 0.88f, 0.72f) * 2.2f;
    sun.size = kSunRadius;
    return sun;
}

Light default_sun(const Camera& camera, const dvec3& up) {
    const dvec3 y = checked_up(up);
    const dvec3 z = any_perpendicular(y);
    const dvec3 x = glm::cross(y, z);
    const double behind = std::atan2(-glm::dot(camera.forward, x), -glm::dot(camera.forward, z));
    return sun_at(behind - 5.5 * kTenDegrees, 4.2 * kTenDegrees, up);
}

}  // namespace octavo
