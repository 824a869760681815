// SPDX-License-Identifier: MIT
#include "octavo/mesh/architecture.h"

#include <vector>

namespace octavo::architecture {
namespace {

constexpr int kColumnSides = 22;
constexpr int kArchSegments = 26;
constexpr double kBalusterSpacing = 0.36;
constexpr double kTileWidth = 0.34;

}  // namespace

void column(ShapeBuilder& shapes, const dvec3& foot, double height, double radius) {
    const double r = radius, h = height;
    const double plinth = 0.55 * r, abacus = 0.5 * r, shaft_top = h - 1.9 * r;
    shapes.box(foot - dvec3(1.45 * r, 0, 1.45 * r), foot + dvec3(1.45 * r, plinth, 1.45 * r));

    std::vector<dvec2> profile{{1.38 * r, plinth}};
    const auto torus = [&](double centre_y, double centre_r, double size) {
        constexpr int kSteps = 5;
        for (int i = 0; i <= kSteps; ++i) {
            const double angle = exact::kPi * (static_cast<double>(i) / kSteps - 0.5);
            profile.emplace_back(centre_r + size * exact::cosine(angle),
                                 centre_y + size * exact::sine(angle));
        }
    };
    torus(plinth + 0.20 * r, 1.15 * r, 0.20 * r);
    torus(plinth + 0.55 * r, 1.03 * r, 0.10 * r);
    // The shaft narrows towards its top, slowly at first.
    constexpr int kShaftSteps = 7;
    const double shaft_foot = plinth + 0.75 * r;
    for (int i = 0; i <= kShaftSteps; ++i) {
        const double t = static_cast<double>(i) / kShaftSteps;
        profile.emplace_back(r * (1.0 - 0.16 * t * t), shaft_foot + (shaft_top - shaft_foot) * t);
    }
    torus(shaft_top + 0.10 * r, 0.86 * r, 0.09 * r);
    constexpr int kBellSteps = 5;
    for (int i = 0; i <= kBellSteps; ++i) {
        const double t = static_cast<double>(i) / kBellSteps;
        profile.emplace_back(r * (0.86 + 0.5 * t * t), shaft_top + r * (0.22 + 1.18 * t));
    }
    shapes.lathe(foot, profile, kColumnSides);
    shapes.box(foot + dvec3(-1.5 * r, h - abacus, -1.5 * r), foot + dvec3(1.5 * r, h, 1.5 * r));
}

void arch(ShapeBuilder& shapes, const Arch& a) {
    const double middle = 0.5 * a.span, front = 0.5 * a.thickness;
    const int segments = shapes.segments(kArchSegments, 4);
    const auto on_arc = [&](double radius, double t) {
        const double angle = exact::kPi * (1.0 - t);
        return dvec2(middle + radius * exact::cosine(angle),
                     a.spring + radius * exact::sine(angle));
    };
    // The wall's lower edge: along the left capital, over the arch, along the right capital.
    std::vector<dvec2> edge{{0.0, a.spring}};
    for (int i = 0; i <= segments; ++i)
        edge.push_back(on_arc(a.radius, static_cast<double>(i) / segments));
    edge.emplace_back(a.span, a.spring);
    const int steps = static_cast<int>(edge.size()) - 1;
    const auto at = [&](double u) {
        return edge[static_cast<std::size_t>(std::lround(u * steps))];
    };

    for (const double z : {-front, front})
        shapes.surface(steps, 2, [&](double u, double v) {
            const dvec2 p = at(u);
            return dvec3(p.x, p.y + (a.top - p.y) * v, z);
        });
    shapes.surface(steps, 1,
                   [&](double u, double v) { return dvec3(at(u), front * (2.0 * v - 1.0)); });

    // A band of two steps around the arch, on both faces.
    const double width = std::min(0.26, 0.9 * (middle - a.radius));
    const dvec2 band[] = {{0, 0}, {0, 0.05}, {0.4, 0.05}, {0.45, 0.09}, {0.9, 0.09}, {1, 0}};
    constexpr int kBandSteps = static_cast<int>(std::size(band)) - 1;
    for (const double side : {-1.0, 1.0})
        shapes.surface(segments, kBandSteps, [&](double u, double v) {
            const dvec2& p = band[std::lround(v * kBandSteps)];
            return dvec3(on_arc(a.radius + width * p.x, u), side * (front + p.y));
        });
    shapes.box({middle - 0.11, a.spring + a.radius - 0.06, -front - 0.14},
               {middle + 0.11, a.spring + a.radius + width + 0.08, front + 0.14});
}

void balustrade(ShapeBuilder& shapes, double length, double floor) {
    constexpr double kHeight = 0.95, kRail = 0.12;
    shapes.box({0, floor, -0.13}, {length, floor + kRail, 0.13});
    shapes.box({0, floor + kHeight - kRail, -0.15}, {length, floor + kHeight, 0.15});
    constexpr dvec2 kProfile[] = {{0.085, 0.00}, {0.085, 0.06}, {0.045, 0.09}, {0.06, 0.16},
                                  {0.088, 0.25}, {0.075, 0.34}, {0.042, 0.47}, {0.04, 0.57},
                                  {0.075, 0.62}, {0.075, 0.71}};
    const int count = std::max(1, static_cast<int>(length / kBalusterSpacing));
    for (int i = 0; i < count; ++i)
        shapes.lathe({length * (i + 0.5) / count, floor + kRail, 0}, kProfile, 11);
}

void tiled_slope(ShapeBuilder& shapes, const Slope& s) {
    const int across = shapes.segments(static_cast<int>(3 * s.length / kTileWidth), 4);
    // Each row has a lower and an upper edge; a row's upper edge lies under the next one's lower.
    const int lines = 2 * s.rows - 1;
    constexpr double kRowStep = 0.05, kCurve = 0.055;
    shapes.surface(across, lines, [&](double u, double v) {
        const int line = static_cast<int>(std::lround(v * lines));
        const int row = (line + 1) / 2;
        const double t = static_cast<double>(row) / s.rows;
        const double z = -s.out + (s.out + s.depth) * t;
        const double x = s.mitre * z + u * (s.length - 2.0 * s.mitre * z);
        const double curve = kCurve * exact::cosine(2.0 * exact::kPi * x / kTileWidth);
        return dvec3(x, s.low + (s.high - s.low) * t + curve + (line % 2 == 0 ? kRowStep : 0.0), z);
    });
}

}  // namespace octavo::architecture
