// SPDX-License-Identifier: MIT
#include "light_arguments.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "arguments.h"
#include "degrees.h"
#include "key_values.h"
#include "octavo/render/render.h"

namespace octavo::cli {
namespace {

constexpr std::array<std::string_view, 5> kKinds = {"sun", "point", "spot", "disc", "rectangle"};
constexpr double kSpotAngle = 30.0 * kRadiansPerDegree;

[[noreturn]] void refuse(const std::string& reason) {
    throw Error(Errc::bad_argument, reason);
}

dvec3 unit(const dvec3& v, const std::string& what) {
    const double length = glm::length(v);
    if (!(length > 0.0)) refuse(what);
    return v / length;
}

/// A rectangle's sides: across, at right angles to `up`, and what is at right angles to both.
void set_sides(Light& light, const std::string& size, const dvec3& up) {
    const std::array<double, 2> sides = parse_sides(size);
    dvec3 across = glm::cross(light.direction, up);
    if (glm::length(across) < 1e-6 * glm::length(up))
        across = std::abs(light.direction.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 0, 1);
    across = glm::normalize(across - glm::dot(across, light.direction) * light.direction);
    light.half_u = 0.5 * sides[0] * across;
    light.half_v = 0.5 * sides[1] * glm::cross(across, light.direction);
}

Light parse_lamp(const std::string& kind, const std::string& place, KeyValues& parts,
                 const dvec3& up) {
    Light light;
    light.position = parse_vec3(place);
    if (kind == "point") {
        light.kind = Light::Kind::point;
    } else {
        const auto to = parts.take("to");
        if (!to) refuse("a " + kind + " needs to=X,Y,Z, the point that it shines at");
        light.direction = unit(parse_vec3(*to) - light.position,
                               "a " + kind + " cannot shine at the point where it is");
    }
    const auto size = parts.take("size");
    if (kind == "rectangle") {
        light.kind = Light::Kind::rectangle;
        if (!size) refuse("a rectangle needs size=WxH");
        set_sides(light, *size, up);
    } else if (size) {
        light.size = parse_positive(*size);
    }
    if (kind == "disc") {
        light.kind = Light::Kind::disc;
        if (!(light.size > 0.0)) refuse("a disc needs size=RADIUS");
    }
    if (kind == "spot") {
        light.kind = Light::Kind::spot;
        const auto angle = parts.take("angle");
        light.outer_angle = angle ? parse_positive(*angle) * kRadiansPerDegree : kSpotAngle;
        if (!(light.outer_angle > 0.0 && light.outer_angle < std::numbers::pi / 2))
            refuse("a spot's angle is between 0 and 90 degrees");
        light.inner_angle = 0.8 * light.outer_angle;
    }
    return light;
}

float brightest(const vec3& color) {
    return std::max({color.r, color.g, color.b});
}

float default_brightness() {
    return brightest(sun_at(0.0, 0.0).intensity);
}

dvec3 middle_of(const Light& light) {
    if (light.kind != Light::Kind::mesh) return light.position;
    dvec3 sum(0.0);
    for (const auto& t : light.triangles) sum += (t[0] + t[1] + t[2]) / 3.0;
    return sum / static_cast<double>(std::max<std::size_t>(1, light.triangles.size()));
}

/// The area that a lamp shows in the direction that it shines in; a mesh is taken for a ball.
double shown_area(const Light& light) {
    if (light.kind == Light::Kind::disc) return std::numbers::pi * light.size * light.size;
    if (light.kind == Light::Kind::rectangle)
        return 4.0 * glm::length(glm::cross(light.half_u, light.half_v));
    if (light.kind != Light::Kind::mesh) return 1.0;
    double area = 0.0;
    for (const auto& t : light.triangles)
        area += 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
    return 0.25 * area;
}

/// What an intensity of 1 gives in the middle of the scene, with nothing in the way.
double reach(const Light& light, const Box& lit) {
    if (light.kind == Light::Kind::sun) return 1.0;
    const double distance =
        std::max(glm::length(middle_of(light) - lit.centre()), 0.25 * glm::length(lit.size()));
    return shown_area(light) / std::max(distance * distance, 1e-30);
}

}  // namespace

Light unit_sun(const std::array<double, 2>& angles, const dvec3& up) {
    Light sun = sun_at(angles[0], angles[1], up);
    sun.intensity /= brightest(sun.intensity);
    return sun;
}

LightArgument parse_light(const std::string& text, const dvec3& up) {
    LightArgument argument;
    if (text == "none") return {LightArgument::From::nowhere, "", {}, 0.0};
    if (text == "scene" || text.starts_with("scene="))
        return {
            LightArgument::From::file, text.substr(std::min<std::size_t>(6, text.size())), {}, 1.0};

    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    if (std::ranges::find(kKinds, kind) == kKinds.end())
        refuse("'" + kind + "' is not sun, point, spot, disc, rectangle, scene or none");
    if (colon == std::string::npos)
        refuse("a " + kind + " needs a place, as in " + kind + ":1,2,3");
    const std::size_t end = std::min(text.find(':', colon + 1), text.size());
    const std::string place = text.substr(colon + 1, end - colon - 1);
    KeyValues parts(std::string_view(text).substr(std::min(end + 1, text.size())));

    const auto color = parts.take("color");
    const auto power = parts.take("power");
    if (kind == "sun") {
        argument.light = unit_sun(parse_angles(place), up);
        if (const auto size = parts.take("size"))
            argument.light.size = parse_positive(*size) * kRadiansPerDegree;
    } else {
        argument.light = parse_lamp(kind, place, parts, up);
    }
    parts.check_all_taken("a " + kind);
    argument.light.name = kind;
    if (color) {
        const vec3 rgb = parse_color(*color);
        if (!(brightest(rgb) > 0.0f)) refuse("'" + *color + "' is black");
        argument.light.intensity = rgb / brightest(rgb);
    }
    if (power) argument.power = parse_positive(*power);
    return argument;
}

std::vector<Light> balanced(std::vector<Light> lights, const Box& lit) {
    float brightest_sun = 0.0f;
    double sum = 0.0;
    for (Light& light : lights) {
        if (light.kind == Light::Kind::sun) {
            brightest_sun = std::max(brightest_sun, brightest(light.intensity));
            if (light.size == 0.0) light.size = sun_at(0.0, 0.0).size;
        }
        sum += static_cast<double>(brightest(light.intensity)) * reach(light, lit);
    }
    const double wanted = static_cast<double>(default_brightness());
    const double found = brightest_sun > 0.0f ? std::max(wanted, double{brightest_sun}) : sum;
    if (!(found > 0.0)) return lights;
    for (Light& light : lights) light.intensity *= static_cast<float>(wanted / found);
    return lights;
}

std::vector<Light> chosen_lights(const std::vector<LightArgument>& arguments,
                                 const std::vector<Light>& of_file, const Box& lit) {
    std::vector<Light> lights;
    const std::vector<Light> stored = balanced(of_file, lit);
    for (const LightArgument& argument : arguments) {
        if (argument.from == LightArgument::From::argument) {
            Light light = argument.light;
            light.intensity *= static_cast<float>(
                argument.power * static_cast<double>(default_brightness()) / reach(light, lit));
            lights.push_back(std::move(light));
        } else if (argument.from == LightArgument::From::file) {
            const std::size_t before = lights.size();
            std::ranges::copy_if(stored, std::back_inserter(lights), [&](const Light& light) {
                return argument.name.empty() || light.name == argument.name;
            });
            if (lights.size() > before) continue;
            std::string names;
            for (const Light& light : stored) names += (names.empty() ? "" : ", ") + light.name;
            refuse("no light '" + argument.name + "'; the file has " +
                   (names.empty() ? "none" : names));
        }
    }
    return lights;
}

}  // namespace octavo::cli
