// SPDX-License-Identifier: MIT
#include "octavo/render/camera.h"

#include <algorithm>
#include <cmath>

#include "octavo/core/error.h"

namespace octavo {
namespace {

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

dvec3 unit(const dvec3& direction, const char* name) {
    const double longest =
        std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (!finite(direction) || longest == 0.0)
        throw Error(Errc::bad_argument, std::string(name) + " is zero or not finite");
    return glm::normalize(direction / longest);  // whose square is in range
}

dvec3 unit_up(const dvec3& up) {
    return unit(up, "the up direction");
}

}  // namespace

Camera look_along(const dvec3& eye, const dvec3& forward, const dvec3& up, double vertical_fov) {
    if (!finite(eye)) throw Error(Errc::bad_argument, "the camera's position is not finite");
    if (!(vertical_fov > 0.0 && vertical_fov < 3.14159))
        throw Error(Errc::bad_argument, "the field of view is not in 0 to 180 degrees");
    Camera camera;
    camera.eye = eye;
    camera.forward = unit(forward, "the camera's direction");
    const dvec3 right = glm::cross(camera.forward, unit_up(up));
    if (glm::length(right) < 1e-9)
        throw Error(Errc::bad_argument, "the camera's up direction is parallel to its view");
    camera.up = glm::normalize(glm::cross(right, camera.forward));
    camera.vertical_fov = vertical_fov;
    return camera;
}

Camera look_at(const dvec3& eye, const dvec3& target, const dvec3& up, double vertical_fov) {
    if (eye == target) throw Error(Errc::bad_argument, "the camera stands where it looks at");
    return look_along(eye, target - eye, up, vertical_fov);
}

Camera default_camera(const Box& box, const dvec3& up, double aspect) {
    const dvec3 y = unit_up(up);
    const dvec3 z = any_perpendicular(y);
    const dvec3 x = glm::cross(y, z);
    const dvec3 towards_eye = glm::normalize(1.0 * x + 0.6 * y + 1.4 * z);
    const double fov = 4.0 * kTenDegrees;
    const double slope = std::tan(0.5 * fov);
    Camera camera = look_along({}, -towards_eye, y, fov);
    const dvec3 right = glm::cross(camera.forward, camera.up);
    double distance = 0.0;
    for (int i = 0; i < 8; ++i) {
        const dvec3 to_corner = (dvec3(i & 1, i >> 1 & 1, i >> 2) - 0.5) * box.size();
        const double height = std::abs(glm::dot(to_corner, camera.up)) / slope;
        const double width = std::abs(glm::dot(to_corner, right)) / (slope * aspect);
        distance =
            std::max(distance, std::max(height, width) - glm::dot(to_corner, camera.forward));
    }
    if (distance == 0.0) distance = 1.0;  // a point, whose grid has that side
    camera.eye = box.centre() + 1.04 * distance * towards_eye;
    return camera;
}

Light sun_at(double azimuth, double elevation, const dvec3& up) {
    if (!std::isfinite(azimuth) || !std::isfinite(elevation))
        throw Error(Errc::bad_argument, "the sun's azimuth or elevation is not finite");
    const dvec3 y = unit_up(up);
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
    const dvec3 y = unit_up(up);
    const dvec3 z = any_perpendicular(y);
    const dvec3 x = glm::cross(y, z);
    const double behind = std::atan2(-glm::dot(camera.forward, x), -glm::dot(camera.forward, z));
    return sun_at(behind - 5.5 * kTenDegrees, 4.2 * kTenDegrees, up);
}

}  // namespace octavo
