// SPDX-License-Identifier: MIT
#include "octavo/render/pixel_rays.h"

#include <algorithm>
#include <cmath>

namespace octavo {
namespace {

/// Voxels from the grid's centre up to which a float tells neighbouring voxels' planes well apart.
constexpr double kNear = 1 << 20;
/// Beyond this a cell's number may leave 32 bits.
constexpr double kFarthest = 1 << 29;

}  // namespace

PixelRays::PixelRays(const Camera& camera, const Grid& grid, int width, int height)
    : pitch_(2.0 * std::tan(0.5 * camera.vertical_fov) / height) {
    const dvec3 forward = glm::normalize(camera.forward);
    const dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    const dvec3 up = glm::cross(right, forward);
    dvec3 start = grid.to_grid(camera.eye);

    const double side = grid.resolution();
    double t_before = 0.0;
    const dvec3 to_centre = 0.5 * side - start;
    if (glm::length(to_centre) > kNear) {
        t_before = std::max(0.0, glm::dot(forward, to_centre) - side);
        start += t_before * forward;
        const dvec3 to_corner = 0.5 * pitch_ * (double(height) * up - double(width) * right);
        sees_nothing_ = !(glm::length(start + t_before * to_corner - 0.5 * side) < kFarthest);
    }
    // Whole numbers need not hold where such a camera is, and of its rays only the directions
    // count.
    if (sees_nothing_) {
        start = dvec3(0.0);
        t_before = 0.0;
    }
    const dvec3 cell = glm::floor(start);
    view_.cell = ivec3(cell);
    view_.frac = vec3(start - cell);
    view_.forward = vec3(forward);
    view_.right = vec3(pitch_ * right);
    view_.down = vec3(-pitch_ * up);
    view_.centre = 0.5f * vec2(static_cast<float>(width), static_cast<float>(height));
    view_.t_before = static_cast<float>(t_before);
}

}  // namespace octavo
