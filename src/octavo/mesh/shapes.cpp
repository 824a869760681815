// SPDX-License-Identifier: MIT
#include "octavo/mesh/shapes.h"

namespace octavo {

std::uint32_t ShapeBuilder::add_material(const std::string& name, const vec3& color,
                                         const vec3& emission) {
    Material& added = scene.materials.emplace_back();
    added.name = name;
    added.base_color = vec4(color, 1.0f);
    added.emission = emission;
    return static_cast<std::uint32_t>(scene.materials.size()) - 1;
}

std::uint32_t ShapeBuilder::point(const dvec3& p) {
    const dvec3 placed_point(placement * dvec4(p.x, p.y, p.z, 1.0));
    scene.positions.push_back(exact::rounded_to_float(placed_point));
    const std::uint8_t level = unit_to_byte(tint);
    scene.colors.push_back({level, level, level, 255});
    return static_cast<std::uint32_t>(scene.positions.size()) - 1;
}

void ShapeBuilder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    scene.triangles.emplace_back(a, b, c);
    scene.triangle_materials.push_back(material);
}

void ShapeBuilder::quad(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
    const std::uint32_t first = point(a);
    point(b);
    point(c);
    point(d);
    triangle(first, first + 1, first + 2);
    triangle(first, first + 2, first + 3);
}

void ShapeBuilder::box(const dvec3& low, const dvec3& high) {
    std::uint32_t corner[8];
    for (int i = 0; i < 8; ++i)
        corner[i] =
            point({(i & 1) ? high.x : low.x, (i & 2) ? high.y : low.y, (i & 4) ? high.z : low.z});
    constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : kFaces) {
        triangle(corner[f[0]], corner[f[1]], corner[f[2]]);
        triangle(corner[f[0]], corner[f[2]], corner[f[3]]);
    }
}

void ShapeBuilder::lathe(const dvec3& foot, std::span<const dvec2> profile, int around) {
    const int steps = static_cast<int>(profile.size()) - 1;
    surface(segments(around), steps, [&](double u, double v) {
        const dvec2& p = profile[static_cast<std::size_t>(std::lround(v * steps))];
        const double angle = 2 * exact::kPi * u;
        return foot + dvec3(p.x * exact::cosine(angle), p.y, p.x * exact::sine(angle));
    });
}

void ShapeBuilder::sphere(const dvec3& centre, double radius, int around) {
    surface(segments(around), segments((around + 1) / 2), [&](double u, double v) {
        const double angle = 2 * exact::kPi * u, tilt = exact::kPi * v;
        const double r = radius * exact::sine(tilt);
        return centre + dvec3(r * exact::cosine(angle), -radius * exact::cosine(tilt),
                              r * exact::sine(angle));
    });
}

void ShapeBuilder::moulding(const dvec2& low, const dvec2& high, std::span<const dvec2> profile) {
    const int steps = static_cast<int>(profile.size()) - 1;
    surface(4, steps, [&](double u, double v) {
        const dvec2& p = profile[static_cast<std::size_t>(std::lround(v * steps))];
        const int corner = static_cast<int>(std::lround(4 * u)) & 3;
        const bool right = corner == 1 || corner == 2, far = corner >= 2;
        return dvec3(right ? high.x + p.x : low.x - p.x, p.y, far ? high.y + p.x : low.y - p.x);
    });
}

dmat4 placed(const dvec3& at, double yaw) {
    const double c = exact::cosine(yaw), s = exact::sine(yaw);
    return {dvec4(c, 0, -s, 0), dvec4(0, 1, 0, 0), dvec4(s, 0, c, 0), dvec4(at.x, at.y, at.z, 1)};
}

Camera look_at(const std::string& name, const dvec3& eye, const dvec3& at, double vertical_fov) {
    Camera camera;
    camera.name = name;
    camera.eye = eye;
    camera.forward = glm::normalize(at - eye);
    const dvec3 right = glm::normalize(glm::cross(camera.forward, dvec3(0.0, 1.0, 0.0)));
    camera.up = glm::cross(right, camera.forward);
    camera.vertical_fov = vertical_fov;
    return camera;
}

Light sun(const dvec3& direction, const vec3& irradiance) {
    Light light;
    light.name = "sun";
    light.kind = Light::Kind::sun;
    light.direction = glm::normalize(direction);
    light.intensity = irradiance;
    return light;
}

}  // namespace octavo
