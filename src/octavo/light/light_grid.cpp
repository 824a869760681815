// SPDX-License-Identifier: MIT
#include "octavo/light/light_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace octavo {
namespace {

/// Smallest cluster: a 64th of what is lit over the number of clusters along a side.
constexpr int kShells = 6;
/// More than this in all lists together (64 MiB): most lights reach most clusters, and lists of
/// them would save little.
constexpr std::size_t kMostListed = std::size_t{1} << 24;

struct Reach {
    dvec3 middle{0.0};
    double radius = 0.0;
};

double brightest(const vec3& c) {
    return static_cast<double>(std::max({c.r, c.g, c.b}));
}

/// A ball outside of which the light is below `least`, for lights that are somewhere.
Reach reach_of(const Light& light, float least) {
    const double bright = brightest(light.intensity) / static_cast<double>(least);
    Reach reach{light.position, 0.0};
    double area = 1.0;  // that shines, in its own direction
    double size = 0.0;
    switch (light.kind) {
        case Light::Kind::sun:
            return {dvec3(0.0), std::numeric_limits<double>::infinity()};
        case Light::Kind::point:
        case Light::Kind::spot:
            size = light.size;
            break;
        case Light::Kind::disc:
            area = std::numbers::pi * light.size * light.size;
            size = light.size;
            break;
        case Light::Kind::rectangle:
            area = 4.0 * glm::length(glm::cross(light.half_u, light.half_v));
            size = glm::length(light.half_u) + glm::length(light.half_v);
            break;
        case Light::Kind::mesh: {
            Box box;
            area = 0.0;
            for (const auto& t : light.triangles) {
                for (const dvec3& corner : t) box.extend(corner);
                area += 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
            }
            if (box.empty()) return reach;
            reach.middle = box.centre();
            size = 0.5 * glm::length(box.size());
            break;
        }
    }
    // A white surface that faces an intensity I at distance d sends back I / (pi d^2).
    reach.radius = size + std::sqrt(bright * area / std::numbers::pi);
    return reach;
}

double distance_to(const Box& box, const dvec3& point) {
    const dvec3 nearest = glm::clamp(point, box.low, box.high);
    return glm::length(nearest - point);
}

}  // namespace

double light_reach(const Light& light, float least) {
    return reach_of(light, least).radius;
}

LightGrid::LightGrid(std::span<const Light> lights, const Box& lit, const dvec3& centre,
                     float least) {
    all_.resize(lights.size());
    std::iota(all_.begin(), all_.end(), 0u);
    if (lights.empty() || lit.empty()) return;
    std::vector<Reach> reaches;
    for (const Light& light : lights) reaches.push_back(reach_of(light, least));
    // The outermost shell holds all that is lit, wherever the centre is.
    double half = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        half = std::max({half, lit.high[axis] - centre[axis], centre[axis] - lit.low[axis]});
    half *= 1.001;
    if (!(half > 0.0) || !std::isfinite(half)) return;
    begins_.push_back(0);
    for (int shell = 0; shell < kShells; ++shell) {
        const double side = std::ldexp(2.0 * half, shell - kShells + 1);
        shells_.push_back({centre - 0.5 * side, side / kSide});
        for (int z = 0; z < kSide; ++z)
            for (int y = 0; y < kSide; ++y)
                for (int x = 0; x < kSide; ++x) {
                    const dvec3 low = shells_.back().low + shells_.back().cluster * dvec3(x, y, z);
                    const Box box{low, low + shells_.back().cluster};
                    for (std::uint32_t i = 0; i < reaches.size(); ++i)
                        if (distance_to(box, reaches[i].middle) <= reaches[i].radius)
                            lists_.push_back(i);
                    begins_.push_back(static_cast<std::uint32_t>(lists_.size()));
                    if (lists_.size() <= kMostListed) continue;
                    shells_.clear();
                    begins_.clear();
                    lists_ = {};
                    return;
                }
    }
}

std::span<const std::uint32_t> LightGrid::near(const dvec3& point) const {
    for (std::size_t s = 0; s < shells_.size(); ++s) {
        const dvec3 at = (point - shells_[s].low) / shells_[s].cluster;
        if (!(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < kSide && at.y < kSide && at.z < kSide))
            continue;
        const auto cell = uvec3(at);
        const std::size_t cluster = ((s * kSide + cell.z) * kSide + cell.y) * kSide + cell.x;
        return std::span(lists_).subspan(begins_[cluster], begins_[cluster + 1] - begins_[cluster]);
    }
    return all_;
}

}  // namespace octavo
