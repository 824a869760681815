// SPDX-License-Identifier: MIT
//
// The shared text of what cells look like against octavo::Attributes.
#include <gtest/gtest.h>

#include <random>

#include "backend/coloured_scenes.h"
#include "octavo/core/morton.h"
#include "octavo/light/cell_views.h"

namespace octavo {
namespace {

const std::vector<test::ColouredScene>& scenes() {
    static const std::vector<test::ColouredScene> all = {
        test::random_colours(test::dust(5, 0.5, 4), 5, 1),
        test::random_colours(test::dust(5, 0.6, 5), 4, 2),
        test::random_colours(test::dust(5, 0.9, 6), 3, 3),
        test::random_colours(test::dust(2, 0.7, 7), 2, 4)};
    return all;
}

TEST(CellLooks, FindTheCellsInALargerOne) {
    for (const test::ColouredScene& scene : scenes()) {
        const shared::CellView view = shared::view(scene.attributes.cells());
        for (int level = 0; level < view.level; ++level)
            for (std::uint64_t code = 0; code < std::uint64_t{1} << 3 * level; ++code) {
                const uvec3 cell = morton_decode(code);
                const CellRange range = scene.attributes.cells().cells_in(cell, level);
                const uvec2 found = cells_in(shared::view(scene.dag), view, cell, level);
                ASSERT_EQ(found.y - found.x, range.size()) << scene.name << " " << level;
                if (!range.empty()) {
                    ASSERT_EQ(found.x, range.begin);
                }
            }
    }
}

TEST(CellLooks, AreThoseOfTheAttributes) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> number(-1.0f, 1.0f);
    std::size_t behind = 0, means = 0;
    for (const test::ColouredScene& scene : scenes()) {
        const Attributes& attributes = scene.attributes;
        const shared::CellLooks looks = shared::view(attributes);
        for (int i = 0; i < 20000; ++i) {
            const int level = static_cast<int>(random() % (1 + unsigned(scene.dag.depth())));
            const uvec3 path = uvec3(random(), random(), random()) & ((1u << unsigned(level)) - 1u);
            const vec3 towards(number(random), number(random), number(random));
            const auto albedo = attributes.albedo(path, level, towards);
            const auto emission = attributes.emission(path, level, towards);
            const shared::CellLook look =
                cell_look(shared::view(scene.dag), looks, path, level, towards);
            ASSERT_EQ(look.albedo.x >= 0.0f, albedo.has_value());
            if (!albedo) continue;
            ASSERT_LT(glm::length(look.albedo - *albedo), 1e-5f);
            ASSERT_LT(glm::length(look.emission - *emission),
                      1e-4f * glm::length(*emission) + 1e-9f);
            means += level < attributes.level();
            behind += attributes.albedo(path, level, -towards) != albedo;
        }
    }
    EXPECT_GT(means, 1000u);
    EXPECT_GT(behind, 1000u);
}

TEST(CellLooks, FindTheCellAtAPoint) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> number(-0.5, 32.5);
    std::size_t found = 0;
    for (const test::ColouredScene& scene : scenes()) {
        if (scene.dag.depth() != 5) continue;
        for (int i = 0; i < 20000; ++i) {
            dvec3 at(number(random), number(random), number(random));
            // A half of them near a border, in hundredths of what it reaches.
            const auto axis = static_cast<int>(random() % 6);
            if (axis < 3) at[axis] = std::round(at[axis]) + 4e-6 * (number(random) - 16.0);
            const dvec3 voxel = glm::floor(at);
            const auto expected = scene.attributes.cell_at(at);
            const std::uint32_t cell =
                cell_at(shared::view(scene.dag), shared::view(scene.attributes.cells()),
                        ivec3(voxel), vec3(at - voxel));
            ASSERT_EQ(cell, expected ? *expected : shared::kNoCell) << at.x << " " << at.y;
            found += expected.has_value();
        }
    }
    EXPECT_GT(found, 5000u);
}

}  // namespace
}  // namespace octavo
