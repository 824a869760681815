// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "octavo/core/vec.h"
#include "octavo/mesh/color.h"
#include "octavo/mesh/exact_math.h"
#include "octavo/mesh/scene.h"

namespace octavo {

using glm::dvec2;

/// Builds a scene from simple shapes. Points pass through `placement` and are rounded to float, so
/// that files with float coordinates hold the scene exactly; `material` and `tint` go with them.
class ShapeBuilder {
public:
    /// @param detail  multiplies the number of segments of everything that is round
    explicit ShapeBuilder(double detail) : detail_(detail) {}

    Scene scene;
    dmat4 placement{1.0};
    std::uint32_t material = 0;
    double tint = 1.0;  // brightness of what follows, 0 to 1

    std::uint32_t add_material(const std::string& name, const vec3& color,
                               const vec3& emission = vec3(0.0f));

    /// A number of segments, for detail 1, made finer or coarser.
    [[nodiscard]] int segments(int count, int least = 3) const {
        return std::max(least, static_cast<int>(std::lround(count * detail_)));
    }

    std::uint32_t point(const dvec3& p);
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
    void quad(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d);

    /// The surface f(u, v) for u and v from 0 to 1, in so many steps.
    template <class Function>
    void surface(int u_steps, int v_steps, Function&& f) {
        const auto first = static_cast<std::uint32_t>(scene.positions.size());
        for (int j = 0; j <= v_steps; ++j)
            for (int i = 0; i <= u_steps; ++i)
                point(f(static_cast<double>(i) / u_steps, static_cast<double>(j) / v_steps));
        const auto row = static_cast<std::uint32_t>(u_steps + 1);
        for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(v_steps); ++j) {
            for (std::uint32_t i = 0; i + 1 < row; ++i) {
                const std::uint32_t a = first + j * row + i;
                triangle(a, a + 1, a + row + 1);
                triangle(a, a + row + 1, a + row);
            }
        }
    }

    void box(const dvec3& low, const dvec3& high);
    /// A (radius, height) profile turned about the y axis that stands at `foot`.
    void lathe(const dvec3& foot, std::span<const dvec2> profile, int around);
    void sphere(const dvec3& centre, double radius, int around);
    /// An (outwards, height) profile led around a rectangle in the xz plane, mitred at its corners.
    void moulding(const dvec2& low, const dvec2& high, std::span<const dvec2> profile);

private:
    double detail_;
};

/// Turned by an angle about the vertical axis, then moved.
[[nodiscard]] dmat4 placed(const dvec3& at, double yaw = 0.0);

/// A camera at `eye` that looks at a point, y up.
[[nodiscard]] Camera look_at(const std::string& name, const dvec3& eye, const dvec3& at,
                             double vertical_fov);

/// A sun that shines in this direction.
[[nodiscard]] Light sun(const dvec3& direction, const vec3& irradiance);

}  // namespace octavo
