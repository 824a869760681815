// SPDX-License-Identifier: MIT
//
// A town in a plain among hills: three kilometres wide, a few hundred metres high, nearly all air.
#include <array>

#include "octavo/mesh/noise.h"
#include "octavo/mesh/random.h"
#include "octavo/mesh/sample_scenes.h"
#include "octavo/mesh/shapes.h"

namespace octavo {
namespace {

constexpr double kHalfWorld = 1500.0;
constexpr double kBlock = 84.0;        // from street to street
constexpr double kStreet = 14.0;       // width
constexpr double kTownRadius = 640.0;  // at size 1

class City {
public:
    explicit City(double size)
        : shapes_(std::sqrt(size)),
          town_radius_(std::min(kHalfWorld - 200.0, kTownRadius * std::sqrt(size))) {
        grass_ = shapes_.add_material("grass", {0.17f, 0.24f, 0.08f});
        street_ = shapes_.add_material("street", {0.10f, 0.10f, 0.105f});
        kerb_ = shapes_.add_material("pavement", {0.40f, 0.39f, 0.37f});
        walls_ = {shapes_.add_material("brick", {0.36f, 0.14f, 0.09f}),
                  shapes_.add_material("render", {0.62f, 0.56f, 0.45f}),
                  shapes_.add_material("concrete", {0.44f, 0.44f, 0.43f})};
        roof_ = shapes_.add_material("roof", {0.28f, 0.12f, 0.08f});
        glass_ = shapes_.add_material("glass", {0.05f, 0.08f, 0.11f});
        lit_ = shapes_.add_material("lit window", {0.9f, 0.7f, 0.4f}, {3.0f, 2.0f, 0.9f});
        bark_ = shapes_.add_material("bark", {0.14f, 0.09f, 0.05f});
        leaf_ = shapes_.add_material("leaf", {0.07f, 0.17f, 0.05f});
    }

    Scene make() {
        terrain();
        const int reach = static_cast<int>(town_radius_ / kBlock) + 1;
        for (int j = -reach; j < reach; ++j)
            for (int i = -reach; i < reach; ++i) block(i, j);
        shapes_.placement = dmat4(1.0);

        Scene scene = std::move(shapes_.scene);
        scene.cameras = {
            look_at("overview", {-820, 250, 700}, {40, -10, -40}, 0.7),
            look_at("street", {-0.5 * kBlock * 6, 3, 0.6}, {200, 14, 0}, 0.9),
        };
        scene.lights.push_back(sun({0.55, -0.62, -0.45}, {3.4f, 3.2f, 2.8f}));
        return scene;
    }

private:
    /// Flat where the town is, hills around it.
    [[nodiscard]] double height(double x, double z) const {
        const double far = std::sqrt(x * x + z * z);
        const double hills = exact::smooth_step(0.95 * town_radius_, town_radius_ + 650.0, far);
        const double wave = fractal_noise({x / 520.0, 0.5, z / 520.0}, 7, 2);
        return hills * (110.0 + 130.0 * wave) - 0.3;
    }

    void terrain() {
        shapes_.material = grass_;
        const int steps = shapes_.segments(360, 4);
        shapes_.surface(steps, steps, [&](double u, double v) {
            const double x = kHalfWorld * (2.0 * u - 1.0), z = kHalfWorld * (2.0 * v - 1.0);
            return dvec3(x, height(x, z), z);
        });
    }

    void block(int i, int j) {
        const dvec2 low(i * kBlock, j * kBlock);
        const dvec2 middle = low + 0.5 * kBlock;
        const double far = std::sqrt(glm::dot(middle, middle)) / town_radius_;
        if (far > 0.97) return;
        Random random(static_cast<std::uint64_t>((i + 1000) * 4096 + j + 1000));

        shapes_.placement = placed({low.x, 0, low.y});
        shapes_.material = street_;
        shapes_.quad({0, 0, 0}, {0, 0, kBlock}, {kBlock, 0, kBlock}, {kBlock, 0, 0});
        shapes_.material = kerb_;
        constexpr double kEdge = 0.5 * kStreet;
        for (int dash = 0; dash < 9; ++dash) {  // the middle line of two streets
            const double at = kEdge + 2 + dash * 8.0;
            shapes_.quad({at, 0.02, -0.1}, {at, 0.02, 0.1}, {at + 3, 0.02, 0.1},
                         {at + 3, 0.02, -0.1});
            shapes_.quad({-0.1, 0.02, at}, {-0.1, 0.02, at + 3}, {0.1, 0.02, at + 3},
                         {0.1, 0.02, at});
        }
        shapes_.box({kEdge, -0.2, kEdge}, {kBlock - kEdge, 0.15, kBlock - kEdge});

        if (random.chance(0.08 + 0.25 * far)) return park(random);
        // Lots along the block, each with a house; higher towards the middle of the town.
        constexpr int kLots = 3;
        constexpr double kLot = (kBlock - kStreet - 6.0) / kLots;
        for (int lot = 0; lot < kLots * kLots; ++lot) {
            if (lot == 4) continue;  // the yard
            const int column = lot % kLots, row = lot / kLots;
            const dvec2 corner(kEdge + 3.0 + kLot * column, kEdge + 3.0 + kLot * row);
            const dvec2 size(kLot - random.between(0.3, 4.0), kLot - random.between(0.3, 4.0));
            const double rise = (1.0 - far) * (1.0 - far);
            const int floors = 2 + random.below(3) + static_cast<int>(18 * rise * random.real());
            // Some houses stand askew.
            const double yaw = random.chance(0.12) ? random.between(-0.3, 0.3) : 0.0;
            shapes_.placement = placed(
                {low.x + corner.x + 0.5 * size.x, 0.15, low.y + corner.y + 0.5 * size.y}, yaw);
            house(yaw == 0.0 ? size : 0.75 * size, floors, random);
        }
        for (int tree = 0; tree < 8; ++tree) {
            shapes_.placement = placed({low.x, 0.15, low.y});
            this->tree({kEdge + 1.3, 0, kEdge + 4 + 8.0 * tree}, random.between(4, 7), random);
        }
    }

    void park(Random& random) {
        shapes_.material = grass_;
        shapes_.quad({10, 0.2, 10}, {10, 0.2, kBlock - 10}, {kBlock - 10, 0.2, kBlock - 10},
                     {kBlock - 10, 0.2, 10});
        const int trees = 30 + random.below(30);
        for (int i = 0; i < trees; ++i)
            tree({random.between(13, kBlock - 13), 0.2, random.between(13, kBlock - 13)},
                 random.between(5, 12), random);
    }

    void tree(const dvec3& foot, double height, Random& random) {
        shapes_.tint = random.between(0.6, 1.0);
        shapes_.material = bark_;
        const double r = 0.03 * height;
        shapes_.box(foot - dvec3(r, 0, r), foot + dvec3(r, 0.4 * height, r));
        shapes_.material = leaf_;
        const dvec2 crown[] = {{0, 0.25 * height},
                               {0.26 * height, 0.38 * height},
                               {0.30 * height, 0.55 * height},
                               {0.20 * height, 0.8 * height},
                               {0, height}};
        shapes_.lathe(foot, crown, 8);
        shapes_.tint = 1.0;
    }

    /// About the origin of the placement.
    void house(const dvec2& size, int floors, Random& random) {
        constexpr double kFloorHeight = 3.3;
        const double top = floors * kFloorHeight + 0.8;
        const dvec2 half = 0.5 * size;
        wall_ =
            walls_[static_cast<std::size_t>(floors > 9 ? 1 + random.below(2) : random.below(3))];
        shade_ = random.between(0.65, 1.0);
        const dmat4 frame = shapes_.placement;
        for (int side = 0; side < 4; ++side) {
            const double along = side % 2 == 0 ? half.x : half.y,
                         out = side % 2 == 0 ? half.y : half.x;
            shapes_.placement =
                frame * placed({0, 0, 0}, exact::kPi / 2 * side) * placed({-along, 0, out});
            facade(2 * along, top, floors, kFloorHeight, random);
        }
        shapes_.placement = frame;
        shapes_.tint = shade_;
        if (floors > 5 || random.chance(0.3)) {
            flat_roof(half, top, random);
        } else {
            shapes_.material = roof_;
            const double ridge = top + 0.45 * half.y, inset = std::min(half.x, half.y);
            const dvec3 a(-half.x + 0.6 * inset, ridge, 0), b(half.x - 0.6 * inset, ridge, 0);
            const double x = half.x + 0.5, z = half.y + 0.5;
            shapes_.quad({-x, top - 0.2, z}, {x, top - 0.2, z}, b, a);
            shapes_.quad({x, top - 0.2, -z}, {-x, top - 0.2, -z}, a, b);
            shapes_.quad({x, top - 0.2, z}, {x, top - 0.2, -z}, b, b);
            shapes_.quad({-x, top - 0.2, -z}, {-x, top - 0.2, z}, a, a);
            shapes_.material = wall_;
            shapes_.box({0.4 * half.x, top, 0.2}, {0.4 * half.x + 0.8, ridge + 1.0, 1.0});
        }
        shapes_.tint = 1.0;
    }

    void flat_roof(const dvec2& half, double top, Random& random) {
        shapes_.material = kerb_;
        shapes_.quad({-half.x, top - 0.6, half.y}, {half.x, top - 0.6, half.y},
                     {half.x, top - 0.6, -half.y}, {-half.x, top - 0.6, -half.y});
        const dvec2 parapet[] = {
            {-0.3, top - 0.6}, {-0.3, top}, {0.12, top}, {0.12, top - 0.25}, {0, top - 0.3}};
        shapes_.moulding(-half, half, parapet);
        for (int i = random.below(4); i >= 0; --i) {  // stair heads and machines
            const dvec2 at = half * dvec2(random.between(-0.6, 0.5), random.between(-0.6, 0.5));
            const dvec3 low(at.x, top - 0.6, at.y);
            shapes_.box(
                low, low + dvec3(random.between(1, 4), random.between(1, 3), random.between(1, 4)));
        }
    }

    /// A wall in the local xy plane, looking to +z, with its windows set into it.
    void facade(double width, double top, int floors, double floor_height, Random& random) {
        constexpr double kAxis = 2.7, kHalfWindow = 0.6, kDepth = 0.22;
        const int windows = std::max(1, static_cast<int>(width / kAxis));
        const double axis = width / windows;
        shapes_.tint = shade_;
        const auto strip = [&](double x0, double x1, double y0, double y1) {
            shapes_.quad({x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0});
        };
        shapes_.material = wall_;
        strip(0, width, floors * floor_height, top);
        for (int floor = 0; floor < floors; ++floor) {
            const double y = floor * floor_height, sill = y + 0.9, head = y + 2.6;
            shapes_.material = wall_;
            strip(0, width, y, sill);
            strip(0, width, head, y + floor_height);
            double x = 0;
            for (int i = 0; i < windows; ++i) {
                const double left = (i + 0.5) * axis - kHalfWindow, right = left + 2 * kHalfWindow;
                shapes_.material = wall_;
                strip(x, left, sill, head);
                x = right;
                shapes_.quad({left, sill, 0}, {right, sill, 0}, {right, sill, -kDepth},
                             {left, sill, -kDepth});
                shapes_.quad({left, head, -kDepth}, {right, head, -kDepth}, {right, head, 0},
                             {left, head, 0});
                shapes_.quad({left, sill, 0}, {left, sill, -kDepth}, {left, head, -kDepth},
                             {left, head, 0});
                shapes_.quad({right, sill, -kDepth}, {right, sill, 0}, {right, head, 0},
                             {right, head, -kDepth});
                shapes_.material = random.chance(0.06) ? lit_ : glass_;
                shapes_.quad({left, sill, -kDepth}, {right, sill, -kDepth}, {right, head, -kDepth},
                             {left, head, -kDepth});
            }
            shapes_.material = wall_;
            strip(x, width, sill, head);
        }
    }

    ShapeBuilder shapes_;
    double town_radius_;
    double shade_ = 1.0;
    std::uint32_t wall_ = 0;
    std::uint32_t grass_, street_, kerb_, roof_, glass_, lit_, bark_, leaf_;
    std::array<std::uint32_t, 3> walls_;
};

}  // namespace

Scene scenes::city(double size) {
    return City(size).make();
}

}  // namespace octavo
