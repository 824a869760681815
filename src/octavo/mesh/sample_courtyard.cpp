// SPDX-License-Identifier: MIT
//
// A court of 26 x 11 metres in a building of 37 x 23, two arcaded floors around it. The x axis runs
// along the court, its middle is the origin, and the default view looks along +x.
#include <array>
#include <vector>

#include "octavo/mesh/architecture.h"
#include "octavo/mesh/noise.h"
#include "octavo/mesh/random.h"
#include "octavo/mesh/sample_scenes.h"
#include "octavo/mesh/shapes.h"

namespace octavo {
namespace {

using exact::kPi;

constexpr double kHalfLength = 13.0, kHalfWidth = 5.5;  // of the court, to the column axes
constexpr double kWalk = 4.5;                           // from the columns to the wall behind them
constexpr double kWall = 0.8;
constexpr double kStep = 0.15;  // the walk lies a step above the court
constexpr double kFloor = 5.6;  // of the upper storey
constexpr double kEaves = 10.4;

// A joint holds a whole number of voxels plus a bit, and shows or not at the whim of the grid. Just
// under the voxel of 1024^3 (38.0 mm) it shows nowhere there, and everywhere from 2048^3 up.
constexpr double kJoint = 0.0375;
constexpr double kJointDepth = 0.02;

class Courtyard {
public:
    explicit Courtyard(double size) : shapes_(std::sqrt(size)) {
        stone_ = shapes_.add_material("stone", {0.56f, 0.48f, 0.37f});
        plaster_ = shapes_.add_material("plaster", {0.66f, 0.52f, 0.36f});
        paving_ = shapes_.add_material("paving", {0.44f, 0.40f, 0.34f});
        tile_ = shapes_.add_material("roof tile", {0.42f, 0.15f, 0.08f});
        marble_ = shapes_.add_material("marble", {0.78f, 0.76f, 0.72f});
        water_ = shapes_.add_material("water", {0.07f, 0.20f, 0.24f});
        wood_ = shapes_.add_material("wood", {0.16f, 0.08f, 0.04f});
        iron_ = shapes_.add_material("iron", {0.04f, 0.04f, 0.045f});
        clay_ = shapes_.add_material("clay", {0.48f, 0.20f, 0.10f});
        leaf_ = shapes_.add_material("leaf", {0.08f, 0.20f, 0.05f});
        flame_ = shapes_.add_material("lantern light", {1.0f, 0.8f, 0.5f}, {22.0f, 12.0f, 4.5f});
        window_ = shapes_.add_material("lit window", {0.9f, 0.7f, 0.4f}, {2.4f, 1.4f, 0.6f});
        cloth_ = {shapes_.add_material("red cloth", {0.50f, 0.04f, 0.03f}),
                  shapes_.add_material("ochre cloth", {0.62f, 0.33f, 0.05f}),
                  shapes_.add_material("blue cloth", {0.05f, 0.12f, 0.38f})};
    }

    Scene make() {
        shell();
        paving();
        const dvec2 corner(kHalfLength, kHalfWidth);
        side(placed({-corner.x, 0, corner.y}), 10, 2.6);
        side(placed({corner.x, 0, corner.y}, kPi / 2), 4, 2.75);
        side(placed({corner.x, 0, -corner.y}, kPi), 10, 2.6);
        side(placed({-corner.x, 0, -corner.y}, -kPi / 2), 4, 2.75);
        shapes_.placement = dmat4(1.0);
        tower();
        fountain({2.2, 0, 0});
        canopies();
        plants();

        Scene scene = std::move(shapes_.scene);
        scene.cameras = {
            look_at("court", {-14.1, 1.7, 1.8}, {2.0, 3.2, -1.1}, 0.88),
            look_at("gallery", {-10.5, 7.35, -7.6}, {4.0, 3.2, 2.0}, 0.95),
            look_at("fountain", {-3.4, 1.5, 2.9}, {2.6, 2.5, -0.6}, 0.85),
            look_at("above", {-22.0, 36.0, 26.0}, {0.4, 2.6, 0.8}, 0.82),
        };
        scene.lights.push_back(sun({0.12, -1.0, -0.52}, {6.2f, 4.5f, 2.8f}));
        return scene;
    }

private:
    /// A box that reaches around the court: `low` and `high` distances from the column axes.
    void ring(double low, double high, double y_low, double y_high) {
        const double x = kHalfLength, z = kHalfWidth;
        shapes_.box({-x - high, y_low, z + low}, {x + high, y_high, z + high});
        shapes_.box({-x - high, y_low, -z - high}, {x + high, y_high, -z - low});
        shapes_.box({x + low, y_low, -z - low}, {x + high, y_high, z + low});
        shapes_.box({-x - high, y_low, -z - low}, {-x - low, y_high, z + low});
    }

    /// Floors, outer walls and the mouldings that go around the court.
    void shell() {
        shapes_.material = plaster_;
        ring(kWalk, kWalk + kWall, -0.2, kEaves + 1.8);
        shapes_.material = stone_;
        ring(-0.5, kWalk, -0.2, kStep);
        ring(-0.3, kWalk, 5.0, kFloor);
        ring(-0.3, kWalk, 9.9, kEaves);
        const dvec2 corner(kHalfLength, kHalfWidth);
        for (const double base : {5.0, 9.8}) {
            std::vector<dvec2> profile{{-0.3, base - 0.02}, {-0.36, base},
                                       {-0.36, base + 0.1}, {-0.42, base + 0.15},
                                       {-0.5, base + 0.3},  {-0.62, base + 0.38},
                                       {-0.62, base + 0.5}, {-0.66, base + 0.53},
                                       {-0.66, base + 0.6}, {-0.3, base + 0.62}};
            shapes_.moulding(-corner, corner, profile);
        }
        shapes_.material = plaster_;
        shapes_.box({-18.3, -0.3, -10.8}, {18.3, -0.2, 10.8});
    }

    /// Slabs of slightly different shades, in two sizes.
    void paving() {
        Random random(1);
        shapes_.material = paving_;
        shapes_.tint = 0.5;
        shapes_.box({-13, -0.2, -5.5}, {13, -kJointDepth, 5.5});
        const auto slabs = [&](const dvec2& low, const dvec2& high, double side, double top) {
            const auto columns = static_cast<int>(std::lround((high.x - low.x) / side));
            const auto rows = static_cast<int>(std::lround((high.y - low.y) / side));
            const dvec2 cell = (high - low) / dvec2(columns, rows);
            for (int j = 0; j < rows; ++j) {
                for (int i = 0; i < columns; ++i) {
                    const dvec2 p = low + cell * dvec2(i, j);
                    const bool dark = (i + j) % 2 == 0;
                    shapes_.tint = (dark ? 0.62 : 0.9) + random.between(-0.09, 0.09);
                    shapes_.box({p.x + 0.5 * kJoint, top - 0.05, p.y + 0.5 * kJoint},
                                {p.x + cell.x - 0.5 * kJoint, top, p.y + cell.y - 0.5 * kJoint});
                }
            }
        };
        slabs({-12.5, -5.0}, {12.5, 5.0}, 0.72, 0.0);
        slabs({-17.4, -9.9}, {-12.6, 9.9}, 1.1, kStep + kJointDepth);
        slabs({12.6, -9.9}, {17.4, 9.9}, 1.1, kStep + kJointDepth);
        shapes_.tint = 1.0;
    }

    /// One side of the court: columns, arches, rails, roof and what hangs there.
    void side(const dmat4& frame, int bays, double span) {
        shapes_.placement = frame;
        shapes_.material = stone_;
        for (int bay = 0; bay < bays; ++bay) {
            const double x = bay * span;
            shapes_.placement = frame;
            shapes_.material = stone_;
            if (bay == 0) {  // a pier stands in the corner
                shapes_.box({-0.45, kStep, -0.45}, {0.45, 5.0, 0.45});
                shapes_.box({-0.4, kFloor, -0.4}, {0.4, 9.9, 0.4});
                shapes_.box({-0.55, kStep, -0.55}, {0.55, kStep + 0.4, 0.55});
                shapes_.box({-0.52, 3.4, -0.52}, {0.52, 3.6, 0.52});
            } else {
                architecture::column(shapes_, {x, kStep, 0}, 3.6 - kStep, 0.27);
                architecture::column(shapes_, {x, kFloor, 0}, 8.35 - kFloor, 0.19);
            }
            shapes_.placement = frame * placed({x, 0, 0});
            shapes_.tint = 0.95 + 0.05 * noise(dvec3(frame[3]) + 1.7 * x, 3);
            architecture::arch(shapes_, {span, 3.6, 5.0, 0.5 * span - 0.42, 0.56});
            architecture::arch(shapes_, {span, 8.35, 9.9, 0.5 * span - 0.33, 0.44});
            shapes_.tint = 1.0;
            shapes_.placement = frame * placed({x + 0.28, 0, 0});
            shapes_.material = marble_;
            architecture::balustrade(shapes_, span - 0.56, kFloor);
            shapes_.placement = frame * placed({x + 0.5 * span, 0, 0});
            back_wall(bay);
            if (bay % 2 == 1) lantern({0, 3.75, 0}, 0.75);
            if (bays > 4 && bay % 3 == 1) curtains(0.5 * span - 0.42, bay / 3 % 3);
        }
        shapes_.placement = frame;
        shapes_.material = tile_;
        architecture::tiled_slope(
            shapes_, {bays * span, kEaves + 0.12, kEaves + 2.5, 0.85, kWalk + kWall + 0.2, 13, -1});
    }

    /// What a bay has in the wall behind it: a door or a niche below, a window above.
    void back_wall(int bay) {
        const double z = kWalk;
        const auto frame = [&](double half, double low, double high) {
            shapes_.material = marble_;
            shapes_.box({-half - 0.16, low, z - 0.12}, {-half, high, z});
            shapes_.box({half, low, z - 0.12}, {half + 0.16, high, z});
            shapes_.box({-half - 0.26, high, z - 0.18}, {half + 0.26, high + 0.2, z});
        };
        if (bay % 2 == 0) {
            frame(0.6, kStep, 2.5);
            shapes_.material = wood_;
            shapes_.box({-0.6, kStep, z - 0.03}, {0.6, 2.5, z});
            for (int panel = 0; panel < 6; ++panel) {
                const int row = panel / 2;
                const double x = panel % 2 == 0 ? -0.5 : 0.07, y = 0.4 + 0.7 * row;
                shapes_.box({x, y, z - 0.06}, {x + 0.43, y + 0.55, z - 0.03});
            }
        }
        frame(0.5, 6.6, 8.3);
        shapes_.material = bay % 3 == 2 ? window_ : wood_;
        shapes_.box({-0.5, 6.6, z - 0.04}, {0.5, 8.3, z});
        shapes_.material = wood_;
        shapes_.box({-0.03, 6.6, z - 0.08}, {0.03, 8.3, z});
        for (const double y : {7.1, 7.7}) shapes_.box({-0.5, y, z - 0.08}, {0.5, y + 0.05, z});
    }

    /// Hangs on a rod; the light is a ball of glowing glass in an iron cage.
    void lantern(const dvec3& hook, double drop) {
        const dvec3 c = hook - dvec3(0, drop, 0);
        shapes_.material = iron_;
        shapes_.box(c + dvec3(-0.012, 0.25, -0.012), hook + dvec3(0.012, 1.0, 0.012));
        constexpr dvec2 kHat[] = {
            {0.17, 0.17}, {0.19, 0.19}, {0.1, 0.26}, {0.03, 0.3}, {0.02, 0.36}};
        constexpr dvec2 kDish[] = {
            {0.0, -0.24}, {0.05, -0.2}, {0.13, -0.17}, {0.13, -0.14}, {0, -0.14}};
        shapes_.lathe(c, kHat, 6);
        shapes_.lathe(c, kDish, 6);
        for (int i = 0; i < 6; ++i) {
            const double angle = kPi / 3 * i;
            const dvec3 p = c + 0.14 * dvec3(exact::cosine(angle), 0, exact::sine(angle));
            shapes_.box(p - dvec3(0.01, 0.16, 0.01), p + dvec3(0.01, 0.18, 0.01));
        }
        shapes_.material = flame_;
        shapes_.sphere(c, 0.095, 12);
    }

    /// Two curtains in an arch, drawn to the columns and tied at a third of their height.
    void curtains(double half, int color) {
        shapes_.material = cloth_[static_cast<std::size_t>(color)];
        for (const double side : {-1.0, 1.0})
            shapes_.surface(shapes_.segments(42), shapes_.segments(22), [&](double u, double v) {
                const double tie = 1.0 - 0.55 * exact::smooth_step(0.32, 0.05, std::abs(v - 0.36));
                const double width = 0.62 * half * tie * (0.75 + 0.25 * v);
                const double fold = exact::sine(2 * kPi * 6.5 * u + 0.9 * exact::sine(3.0 * v));
                const double x = half - width * u;
                const double arc = std::sqrt(std::max(0.0, 1.0 - x * x / (half * half)));
                const double top = 3.55 + 0.9 * half * arc;
                return dvec3(side * x, kStep + 0.12 + (top - kStep - 0.12) * v,
                             (0.05 + 0.05 * (1.0 - v)) * fold);
            });
    }

    /// A bell tower behind the far end, turned against everything else.
    void tower() {
        constexpr double kHalf = 2.7, kTop = 14.2, kBelfry = 17.0;
        const dmat4 frame = placed({16.2, 0, -4.4}, kPi / 6);
        shapes_.placement = frame;
        shapes_.material = plaster_;
        shapes_.box({-kHalf, kEaves, -kHalf}, {kHalf, kTop, kHalf});
        shapes_.material = stone_;
        const dvec2 corner(kHalf, kHalf);
        for (const double base : {12.6, kTop - 0.2, kBelfry - 0.1}) {
            const dvec2 profile[] = {{0, base - 0.2},    {0.1, base - 0.1}, {0.1, base},
                                     {0.3, base + 0.15}, {0.3, base + 0.3}, {0, base + 0.35}};
            shapes_.moulding(-corner, corner, profile);
        }
        for (int face = 0; face < 4; ++face) {
            shapes_.placement =
                frame * placed({0, 0, 0}, kPi / 2 * face) * placed({-kHalf + 0.3, 0, kHalf - 0.3});
            const double span = kHalf - 0.3;
            for (int bay = 0; bay < 2; ++bay) {
                if (bay == 1) shapes_.placement *= placed({span, 0, 0});
                architecture::column(shapes_, {0, kTop, 0}, 1.5, 0.2);
                architecture::arch(shapes_, {span, kTop + 1.5, kBelfry, 0.5 * span - 0.3, 0.5});
            }
            // The slope rises from the eaves at -z, so its frame looks the other way.
            shapes_.placement =
                frame * placed({0, 0, 0}, kPi / 2 * face) * placed({-kHalf, 0, -kHalf});
            shapes_.material = tile_;
            architecture::tiled_slope(shapes_,
                                      {2 * kHalf, kBelfry + 0.25, kBelfry + 2.2, 0.4, kHalf, 9, 1});
            shapes_.material = stone_;
        }
        shapes_.placement = frame;
        shapes_.material = clay_;
        constexpr dvec2 kBell[] = {{0.75, 0.0}, {0.66, 0.12}, {0.5, 0.4},
                                   {0.42, 0.8}, {0.3, 1.0},   {0, 1.05}};
        shapes_.lathe({0, kTop + 1.1, 0}, kBell, 28);
        shapes_.placement = dmat4(1.0);
    }

    void fountain(const dvec3& foot) {
        shapes_.material = marble_;
        constexpr dvec2 kBasin[] = {{2.45, 0.00}, {2.45, 0.14}, {2.30, 0.18}, {2.30, 0.30},
                                    {2.16, 0.34}, {2.12, 0.56}, {2.20, 0.64}, {2.32, 0.68},
                                    {2.34, 0.76}, {2.28, 0.80}, {2.02, 0.80}, {1.96, 0.74},
                                    {1.94, 0.20}, {0.00, 0.20}};
        constexpr dvec2 kPedestal[] = {{0.80, 0.20}, {0.80, 0.70}, {0.72, 0.78}, {0.60, 0.84},
                                       {0.52, 1.00}, {0.50, 1.50}, {0.56, 1.58}, {0.68, 1.64},
                                       {0.70, 1.74}, {0.00, 1.74}};
        shapes_.lathe(foot, kBasin, 64);
        shapes_.lathe(foot, kPedestal, 40);
        shapes_.material = water_;
        shapes_.surface(shapes_.segments(72), shapes_.segments(24), [&](double u, double v) {
            const double r = 1.95 * v, angle = 2 * kPi * u;
            const double ripple = 0.012 * exact::sine(16.0 * r) * (1.0 - 0.4 * v);
            return foot + dvec3(r * exact::cosine(angle), 0.66 + ripple, r * exact::sine(angle));
        });
        shapes_.material = marble_;
        statue(foot + dvec3(0, 1.74, 0));
    }

    /// A robed figure with one arm raised, all of it smooth: a turned profile that sways and
    /// twists.
    void statue(const dvec3& foot) {
        constexpr double kHeight = 2.5;
        constexpr dvec2 kOutline[] = {{0.00, 0.40},   {0.06, 0.41},   {0.22, 0.33}, {0.40, 0.30},
                                      {0.52, 0.27},   {0.60, 0.20},   {0.68, 0.24}, {0.76, 0.27},
                                      {0.81, 0.23},   {0.845, 0.085}, {0.87, 0.08}, {0.905, 0.125},
                                      {0.945, 0.135}, {0.98, 0.09},   {1.00, 0.0}};
        const auto radius = [&](double v) {
            std::size_t i = 1;
            while (i + 1 < std::size(kOutline) && kOutline[i].x < v) ++i;
            const dvec2 &a = kOutline[i - 1], &b = kOutline[i];
            return a.y + (b.y - a.y) * exact::smooth_step(a.x, b.x, v);
        };
        const auto sway = [](double v) {
            return dvec3(0.09 * exact::sine(2.2 * kPi * v), kHeight * v,
                         0.06 * exact::sine(kPi * v));
        };
        shapes_.surface(shapes_.segments(110), shapes_.segments(150), [&](double u, double v) {
            const double angle = 2 * kPi * u;
            const double robe = exact::smooth_step(0.66, 0.3, v);
            const double folds = 1.0 + robe * (0.10 * exact::sine(9 * angle + 5.0 * v) +
                                               0.05 * exact::sine(17 * angle - 9.0 * v));
            const double sash = 0.02 * exact::sine(40.0 * v + 2 * angle) *
                                exact::smooth_step(0.55, 0.6, v) * exact::smooth_step(0.8, 0.75, v);
            const double r = radius(v) * folds + sash;
            const double turned = angle + 0.9 * v;
            const double depth = v < 0.83 ? 0.72 : 1.0;
            return foot + sway(v) +
                   dvec3(r * exact::cosine(turned), 0, depth * r * exact::sine(turned));
        });
        const dvec3 shoulder = foot + sway(0.78);
        arm(shoulder + dvec3(-0.20, 0, 0.02), {-0.34, 0.16, 0.10}, {-0.40, 0.72, 0.16});
        arm(shoulder + dvec3(0.20, 0, 0.02), {0.20, -0.34, 0.06}, {-0.02, -0.46, 0.24});
        shapes_.material = flame_;
        shapes_.sphere(shoulder + dvec3(-0.60, 0.86, 0.18), 0.14, 20);
        shapes_.material = marble_;
    }

    /// From the shoulder by way of the elbow to the hand, both relative to it.
    void arm(const dvec3& shoulder, const dvec3& elbow, const dvec3& hand) {
        shapes_.surface(shapes_.segments(20), shapes_.segments(30), [&](double u, double v) {
            const dvec3 p = 2.0 * v * (1.0 - v) * 1.25 * elbow + v * v * hand;
            const dvec3 along =
                glm::normalize(2.0 * (1.0 - 2.0 * v) * 1.25 * elbow + 2.0 * v * hand);
            const dvec3 side = glm::normalize(glm::cross(along, dvec3(0.1, 0.2, 1.0)));
            const double angle = 2 * kPi * u;
            const double r = (0.095 - 0.045 * v) * (v > 0.97 ? 0.3 : 1.0);
            return shoulder + p +
                   r * (exact::cosine(angle) * side + exact::sine(angle) * glm::cross(along, side));
        });
    }

    /// Cloth between the eaves across the court.
    void canopies() {
        constexpr double kStarts[] = {-8.6, -1.9, 5.4};
        for (std::size_t k = 0; k < 3; ++k) {
            shapes_.material = cloth_[k];
            const double seed = 10.0 * static_cast<double>(k);
            shapes_.surface(shapes_.segments(26), shapes_.segments(76), [&](double u, double v) {
                const double z = 2.0 * v - 1.0;
                const double sag = 1.5 * (1.0 - z * z) * (1.0 + 0.12 * noise({3 * u, 0, seed}, 5));
                const double wrinkle = 0.07 * noise({9.0 * u, 2.0 * v, seed}, 6) +
                                       0.05 * exact::sine(2 * kPi * 3.5 * u) * (1.0 - 0.6 * z * z);
                const double edge = 0.12 * exact::sine(kPi * v) * (2.0 * u - 1.0);
                return dvec3(kStarts[k] + 2.7 * u - edge, 9.55 - sag + wrinkle, 5.15 * z);
            });
        }
    }

    void plants() {
        Random random(7);
        constexpr dvec3 kSpots[] = {{-11.9, 0, -4.5}, {-11.9, 0, 4.5}, {11.9, 0, -4.5},
                                    {11.9, 0, 4.5},   {-4.6, 0, -4.6}, {-4.6, 0, 4.6},
                                    {5.8, 0, -4.6},   {5.8, 0, 4.6},   {-13.9, kStep, -3.0},
                                    {-1.6, 0, -2.6},  {6.0, 0, -2.6},  {6.0, 0, 2.6}};
        for (const dvec3& spot : kSpots) {
            const double size = random.between(0.8, 1.25);
            shapes_.material = clay_;
            shapes_.tint = random.between(0.8, 1.0);
            const dvec2 pot[] = {{0.20 * size, 0},           {0.30 * size, 0.25 * size},
                                 {0.34 * size, 0.5 * size},  {0.40 * size, 0.52 * size},
                                 {0.40 * size, 0.6 * size},  {0.34 * size, 0.6 * size},
                                 {0.30 * size, 0.52 * size}, {0.0, 0.52 * size}};
            shapes_.lathe(spot, pot, 24);
            bush(spot + dvec3(0, 0.95 * size, 0), 0.62 * size, random);
        }
        shapes_.tint = 1.0;
    }

    void bush(const dvec3& centre, double radius, Random& random) {
        shapes_.material = leaf_;
        const int leaves = shapes_.segments(shapes_.segments(330, 20), 20);
        for (int i = 0; i < leaves; ++i) {
            const dvec3 out = random.direction();
            const dvec3 at =
                centre + out * (radius * random.between(0.55, 1.0)) * dvec3(1, 1.15, 1);
            const dvec3 tip = glm::normalize(out + 0.7 * random.direction() + dvec3(0, 0.3, 0));
            const dvec3 side = glm::normalize(glm::cross(tip, random.direction()));
            const double length = random.between(0.14, 0.24), width = 0.24 * length;
            shapes_.tint = random.between(0.55, 1.0);
            shapes_.quad(at, at + 0.45 * length * tip + width * side, at + length * tip,
                         at + 0.45 * length * tip - width * side);
        }
    }

    ShapeBuilder shapes_;
    std::uint32_t stone_, plaster_, paving_, tile_, marble_, water_, wood_, iron_, clay_, leaf_,
        flame_, window_;
    std::array<std::uint32_t, 3> cloth_;
};

}  // namespace

Scene scenes::courtyard(double size) {
    return Courtyard(size).make();
}

}  // namespace octavo
