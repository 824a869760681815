// SPDX-License-Identifier: MIT
#include "octavo/attributes/attributes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <string>

#include "octavo/attributes/build_attributes.h"
#include "octavo/construct/build.h"
#include "octavo/light/point_text.h"
#include "octavo/mesh/samples.h"
#include "octavo/render/render.h"
#include "octavo/trace/trace.h"
#include "support/random_scene.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

struct Built {
    Dag dag;
    Grid grid;
    Attributes attributes;
};

Built build_with(const Scene& scene, int depth, const AttributeOptions& options,
                 VoxelRule rule = VoxelRule::conservative) {
    BuildOptions how;
    how.depth = depth;
    how.rule = rule;
    BuildResult built = build(scene, how);
    Attributes attributes = build_attributes(scene, built.dag, built.grid, options);
    return {std::move(built.dag), built.grid, std::move(attributes)};
}

/// Two triangles, with a material of their own.
void add_square(Scene& scene, const dvec3& corner, const dvec3& a, const dvec3& b,
                const Material& material) {
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {corner, corner + a, corner + a + b, corner + b});
    scene.triangles.emplace_back(first, first + 1, first + 2);
    scene.triangles.emplace_back(first, first + 2, first + 3);
    scene.triangle_materials.resize(scene.triangles.size(),
                                    static_cast<std::uint32_t>(scene.materials.size()));
    scene.materials.push_back(material);
}

Material colored(const vec3& color, const vec3& emission = vec3(0.0f)) {
    Material m;
    m.base_color = vec4(color, 1.0f);
    m.emission = emission;
    return m;
}

/// A bumpy floor of many triangles with colours at their corners, all of which face up.
Scene bumpy_floor(std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Scene scene;
    constexpr unsigned n = 13;
    for (unsigned y = 0; y <= n; ++y)
        for (unsigned x = 0; x <= n; ++x) {
            scene.positions.emplace_back(x + 0.3 * unit(random), y + 0.3 * unit(random),
                                         0.4 * unit(random));
            std::array<std::uint8_t, 4> color{};
            for (auto& c : color) c = static_cast<std::uint8_t>(random());
            scene.colors.push_back(color);
        }
    for (unsigned y = 0; y < n; ++y)
        for (unsigned x = 0; x < n; ++x) {
            const unsigned i = y * (n + 1) + x;
            scene.triangles.emplace_back(i, i + 1, i + n + 2);
            scene.triangles.emplace_back(i, i + n + 2, i + n + 1);
        }
    return scene;
}

/// What a cell holds, found by sampling the triangles densely: no clipping.
struct DenseCell {
    double area = 0.0;
    dvec3 color{0.0};
    dvec3 normal{0.0};
};
std::map<std::uint64_t, DenseCell> sample_densely(const Scene& scene, const Grid& grid, int level) {
    std::map<std::uint64_t, DenseCell> cells;
    const double width = grid.voxel_size * (1 << (grid.depth - level));
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        std::array<dvec3, 3> c = scene.corners(t);
        for (dvec3& p : c) p = (p - grid.origin) / width;
        const dvec3 cross = glm::cross(c[1] - c[0], c[2] - c[0]);
        const int n = 2 + static_cast<int>(60.0 * std::sqrt(glm::length(cross)));
        const double area = 0.5 * glm::length(cross) / (static_cast<double>(n) * n);
        // The middles of the n^2 small triangles that n cuts a side make.
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n - i; ++j)
                for (int upper = 0; upper < (j < n - i - 1 ? 2 : 1); ++upper) {
                    const double u = (i + (1 + upper) / 3.0) / n, v = (j + (1 + upper) / 3.0) / n;
                    const dvec3 p = c[0] + u * (c[1] - c[0]) + v * (c[2] - c[0]);
                    DenseCell& cell = cells[morton_encode(uvec3(glm::floor(p)))];
                    dvec3 color(0.0);
                    const double weights[3] = {1.0 - u - v, u, v};
                    for (int k = 0; k < 3; ++k) {
                        const auto& rgba = scene.colors[scene.triangles[t][k]];
                        color += weights[k] * dvec3(rgba[0], rgba[1], rgba[2]) / 255.0;
                    }
                    cell.area += area;
                    cell.color += area * color;
                    cell.normal += area * glm::normalize(cross);
                }
    }
    return cells;
}

double srgb_from_linear(double x) {
    return 255.0 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055);
}

TEST(BuildAttributes, AveragesOverTheAreaOfTheTrianglesInsideACell) {
    for (const int depth : {4, 6}) {
        const Scene scene = bumpy_floor(static_cast<unsigned>(depth));
        const int level = 4;
        const Built b = build_with(scene, depth, {.normal = true, .level = level});
        const auto dense = sample_densely(scene, b.grid, level);
        std::size_t compared = 0;
        b.attributes.cells().for_each(
            {0, b.attributes.cells().count()}, [&](std::uint64_t i, const uvec3& cell) {
                const auto found = dense.find(morton_encode(cell));
                // A few samples say too little of a cell's corner.
                if (found == dense.end() || found->second.area < 0.1) return;
                ++compared;
                const Rgb8 color = b.attributes.color(i, vec3(0.0f));
                const dvec3 mean = found->second.color / found->second.area;
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(color[static_cast<unsigned>(c)], srgb_from_linear(mean[c]), 1.5);
                const dvec3 normal = glm::normalize(found->second.normal);
                EXPECT_GT(glm::dot(dvec3(b.attributes.normal(i, vec3(0.0f))), normal), 0.9995);
                EXPECT_FALSE(b.attributes.two_sided(i));
            });
        EXPECT_GT(compared, 200u);
    }
}

TEST(BuildAttributes, AMeshThatSaysNothingOfColoursIsClay) {
    const auto color_of = [](const Scene& scene) {
        return build_with(scene, 4, {.level = 4}).attributes.color(0, vec3(0.0f));
    };
    Scene scene;
    add_square(scene, dvec3(0.0), dvec3(1.0, 0.0, 0.0), dvec3(0.0, 1.0, 0.0), Material{});
    EXPECT_EQ(color_of(scene), (Rgb8{255, 255, 255})) << "a material without a colour is white";

    scene.triangle_materials.assign(2, Scene::kNoMaterial);
    const vec3 clay = shared::clay();
    for (int pass = 0; pass < 2; ++pass) {
        const Rgb8 color = color_of(scene);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(color[static_cast<unsigned>(c)], srgb_from_linear(clay[c]), 0.6);
        scene.triangle_materials.clear();
        scene.materials.clear();
    }

    scene.colors.assign(4, {255, 255, 255, 255});
    EXPECT_EQ(color_of(scene), (Rgb8{255, 255, 255})) << "colours at corners are what they say";
}

TEST(BuildAttributes, EverySideOfAThinWallKeepsItsColour) {
    // Two skins a tenth of a cell apart, red to the left and green to the right, and in all three
    // directions.
    for (int axis = 0; axis < 3; ++axis) {
        Scene scene;
        dvec3 a(0.0), b(0.0), n(0.0);
        a[(axis + 1) % 3] = 16.0;
        b[(axis + 2) % 3] = 16.0;
        n[axis] = 1.0;
        add_square(scene, 7.45 * n, b, a, colored({1, 0, 0}, {2, 0, 0}));  // faces down the axis
        add_square(scene, 7.55 * n, a, b, colored({0, 1, 0}));
        BuildOptions options;
        options.grid = Grid{.depth = 4};
        const BuildResult built = build(scene, options);
        const Attributes attributes =
            build_attributes(scene, built.dag, built.grid, {.normal = true});
        uvec3 cell(5);
        cell[axis] = 7;
        const auto i = attributes.cells().find(cell);
        ASSERT_TRUE(i);
        EXPECT_TRUE(attributes.two_sided(*i));
        for (const float tilt : {0.0f, 0.6f}) {
            const vec3 aside = tilt * glm::normalize(vec3(a));
            EXPECT_EQ(attributes.color(*i, vec3(-n) + aside), (Rgb8{255, 0, 0}));
            EXPECT_EQ(attributes.color(*i, vec3(n) + aside), (Rgb8{0, 255, 0}));
            EXPECT_EQ(attributes.emission(*i, vec3(-n) + aside), vec3(2, 0, 0));
            EXPECT_EQ(attributes.emission(*i, vec3(n) + aside), vec3(0, 0, 0));
            EXPECT_GT(glm::dot(attributes.normal(*i, vec3(-n)), vec3(-n)), 0.999f);
            EXPECT_GT(glm::dot(attributes.normal(*i, vec3(n)), vec3(n)), 0.999f);
        }
    }
}

TEST(BuildAttributes, APlaneBetweenTwoLayersColoursBoth) {
    Scene scene;
    add_square(scene, {0, 0, 8}, {16, 0, 0}, {0, 16, 0}, colored({0, 0, 1}));
    BuildOptions options;
    options.grid = Grid{.depth = 4};
    const BuildResult built = build(scene, options);
    const Attributes attributes = build_attributes(scene, built.dag, built.grid, {});
    EXPECT_EQ(attributes.cells().count(), 512u);
    for (std::uint64_t i = 0; i < 512; ++i)
        EXPECT_EQ(attributes.color(i, vec3(0.0f)), (Rgb8{0, 0, 255}));
}

TEST(BuildAttributes, EveryOccupiedCellHasAColour) {
    // Points, segments and faces of the grid among them: cells that no triangle has area in.
    Scene scene = test::random_scene(3, 400);
    scene.materials.push_back(colored({0.5f, 0.25f, 0.125f}));
    scene.triangle_materials.assign(scene.triangles.size(), 0);
    for (const VoxelRule rule : {VoxelRule::conservative, VoxelRule::thin})
        for (const int level : {4, 6, 7}) {
            const Built b = build_with(scene, 7, {.level = level}, rule);
            const Rgb8 expected = {188, 137, 99};
            for (std::uint64_t i = 0; i < b.attributes.cells().count(); ++i)
                ASSERT_EQ(b.attributes.color(i, vec3(0.0f)), expected) << i;
        }
}

TEST(BuildAttributes, NeitherOrderNorThreadsChangeAnyBit) {
    Scene scene = test::random_scene(8, 500);
    std::mt19937 random(4);
    for (int i = 0; i < 40; ++i) {
        const auto part = [&] { return static_cast<float>(random() % 1000) / 1000.0f; };
        scene.materials.push_back(colored({part(), part(), part()}, {9 * part(), part(), 0}));
    }
    for (std::size_t i = 0; i < scene.triangles.size(); ++i)
        scene.triangle_materials.push_back(static_cast<std::uint32_t>(random() % 40));

    Scene shuffled = scene;
    std::vector<std::size_t> order(scene.triangles.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    for (std::size_t i = 0; i < order.size(); ++i) {
        shuffled.triangles[i] = scene.triangles[order[i]];
        shuffled.triangle_materials[i] = scene.triangle_materials[order[i]];
    }
    const Built one = build_with(scene, 8, {.normal = true, .level = 7, .threads = 1});
    const Built two = build_with(shuffled, 8, {.normal = true, .level = 7, .threads = 4});
    ASSERT_TRUE(std::ranges::equal(one.dag.words(), two.dag.words()));
    for (std::size_t c = 0; c < Attributes::kChannels; ++c) {
        const auto channel = static_cast<Attributes::Channel>(c);
        EXPECT_TRUE(one.attributes.has(channel)) << c;
        EXPECT_TRUE(std::ranges::equal(one.attributes.channel(channel).words(),
                                       two.attributes.channel(channel).words()))
            << c;
    }
}

TEST(BuildAttributes, EveryPrimaryHitFindsItsColourInAllBuiltInScenes) {
    for (const SampleInfo& info : samples()) {
        const Scene scene = make_sample(info.name, 0.02);
        for (const int level : {8, 6}) {
            const Built b = build_with(scene, 8, {.level = level});
            std::vector<Ray> rays;
            const Camera camera = scene.cameras.front();
            const dvec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
            for (int y = 0; y < 100; ++y)
                for (int x = 0; x < 100; ++x)
                    rays.push_back({camera.eye, camera.forward + 0.01 * (x - 50) * right +
                                                    0.01 * (y - 50) * camera.up});
            std::vector<Hit> hits(rays.size());
            trace_closest(b.dag, b.grid, rays, hits);
            int found = 0;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                if (!hits[i]) continue;
                ++found;
                const auto color =
                    b.attributes.color(hits[i].path, hits[i].level, vec3(-rays[i].direction));
                ASSERT_TRUE(color) << info.name;
                // The point of the hit itself, with the rounding of a place in the world.
                const dvec3 point = rays[i].origin + hits[i].t * rays[i].direction;
                ASSERT_TRUE(b.attributes.color(b.grid.to_grid(point))) << info.name;
            }
            EXPECT_GT(found, 1500) << info.name;
        }
    }
}

TEST(Attributes, ACoarserCellIsTheAverageOfItsCells) {
    Scene scene;
    add_square(scene, {0, 0, 0.5}, {8, 0, 0}, {0, 16, 0}, colored({1, 0, 0}));
    add_square(scene, {8, 0, 0.5}, {8, 0, 0}, {0, 16, 0}, colored({0, 0, 1}));
    BuildOptions options;
    options.grid = Grid{.depth = 4};
    const BuildResult built = build(scene, options);
    const Attributes attributes = build_attributes(scene, built.dag, built.grid, {});
    EXPECT_EQ(attributes.color({0, 0, 0}, 1), (Rgb8{255, 0, 0}));
    EXPECT_EQ(attributes.color({1, 0, 0}, 1), (Rgb8{0, 0, 255}));
    EXPECT_EQ(attributes.color({0, 0, 0}, 0), (Rgb8{188, 0, 188}));
    EXPECT_FALSE(attributes.color({0, 0, 1}, 1));
    EXPECT_EQ(attributes.color({5, 5, 0}, 4), (Rgb8{255, 0, 0}));
}

TEST(Attributes, ManyLookUpsAreTheSameAsOneByOne) {
    const Scene scene = make_sample("courtyard", 0.01);
    const Built b = build_with(scene, 8, {.level = 7});
    std::vector<Attributes::Query> queries;
    std::mt19937 random(6);
    for (int i = 0; i < 20000; ++i) {
        const int level = static_cast<int>(random() % 9);
        const std::uint32_t side = 1u << level;
        queries.push_back({{random() % side, random() % side, random() % side},
                           level,
                           {1, static_cast<float>(i % 3) - 1, 0}});
    }
    std::vector<Rgba8> colors(queries.size());
    b.attributes.colors(queries, colors);
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const auto& q = queries[i];
        const auto one = b.attributes.color(q.path, q.level, q.towards);
        ASSERT_EQ(one.has_value(), colors[i][3] == 255);
        if (one) {
            ASSERT_EQ(*one, (Rgb8{colors[i][0], colors[i][1], colors[i][2]}));
        }
    }
}

/// What is on disk under a cap is the triangles, the textures and the values themselves.
TEST(BuildAttributes, OnDiskTheyAreTheSameToTheBitAndNeedNoScene) {
    const test::TemporaryFolder folder;
    Scene scene = bumpy_floor(9);
    std::mt19937 random(2);
    const auto picture = std::make_shared<Bitmap>();
    *picture = {200, 128, std::vector<std::array<std::uint8_t, 4>>(200 * 128)};
    for (auto& pixel : picture->pixels)
        for (auto& channel : pixel) channel = static_cast<std::uint8_t>(random());
    scene.textures.push_back({.name = "noise", .file = {}, .encoded = {}, .picture = picture});
    Material holes = colored({1, 1, 1}, {3, 2, 1});
    holes.base_color_texture = holes.emission_texture = 0;
    holes.alpha_cutoff = 0.25f;
    scene.materials = {holes, colored({0.5f, 1, 0})};
    for (const dvec3& p : scene.positions) scene.texture_coordinates.emplace_back(p.x, p.y);
    for (std::size_t i = 0; i < scene.triangles.size(); ++i)
        scene.triangle_materials.push_back(i % 3 == 0 ? 1 : 0);

    const Built in_memory = build_with(scene, 9, {.normal = true, .level = 9});
    AttributeOptions capped{.normal = true,
                            .level = 9,
                            .max_memory_bytes = std::uint64_t{4} << 30,
                            .scratch = folder.path()};
    const AttributeSource source(scene, in_memory.grid, capped);
    scene = {};
    const Attributes on_disk = source.average(in_memory.dag);
    EXPECT_EQ(folder.entries(), 0u) << "temporary files have no name";
    for (std::size_t c = 0; c < Attributes::kChannels; ++c) {
        const auto channel = static_cast<Attributes::Channel>(c);
        EXPECT_EQ(on_disk.has(channel), in_memory.attributes.has(channel)) << c;
        const CellValues& values = on_disk.channel(channel);
        values.release(0, values.words().size());
        EXPECT_TRUE(
            std::ranges::equal(values.words(), in_memory.attributes.channel(channel).words()))
            << c;
    }
}

/// Under a cap the cells of a tile are gone over some at a time where triangles are many.
TEST(BuildAttributes, ManyTrianglesInATileAreTheSameToTheBitUnderACap) {
    const test::TemporaryFolder folder;
    const Scene scene = make_sample("hairball", 0.1);
    ASSERT_GT(scene.triangles.size(), 200000u) << "each has a part in one of the tile's cells";
    const Built in_memory = build_with(scene, 6, {.normal = true, .level = 6});
    const Attributes on_disk = build_attributes(scene, in_memory.dag, in_memory.grid,
                                                {.normal = true,
                                                 .level = 6,
                                                 .max_memory_bytes = std::uint64_t{4} << 30,
                                                 .scratch = folder.path()});
    for (std::size_t c = 0; c < Attributes::kChannels; ++c) {
        const auto channel = static_cast<Attributes::Channel>(c);
        EXPECT_TRUE(std::ranges::equal(on_disk.channel(channel).words(),
                                       in_memory.attributes.channel(channel).words()))
            << c;
    }
}

TEST(BuildAttributes, RefusesToPassTheMemoryCap) {
    const Scene scene = make_sample("courtyard", 0.01);
    BuildOptions how;
    how.depth = 8;
    const BuildResult built = build(scene, how);
    EXPECT_THROW(
        (void)build_attributes(scene, built.dag, built.grid, {.max_memory_bytes = 1 << 20}), Error);
}

}  // namespace
}  // namespace octavo
