// SPDX-License-Identifier: MIT
//
// Pictures and visibility on every device against those of the CPU.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <utility>

#include "backend/coloured_scenes.h"
#include "backend/test_devices.h"
#include "octavo/backend/timed_queue.h"
#include "octavo/construct/build.h"
#include "octavo/mesh/samples.h"
#include "octavo/render/render_lit.h"

namespace octavo {
namespace {

class Pictures : public test::OnDevice {};
INSTANTIATE_TEST_SUITE_P(All, Pictures, test::kTestDevices, test::device_name);
class GBuffer : public test::OnDevice {};
INSTANTIATE_TEST_SUITE_P(All, GBuffer, test::kTestDevices, test::device_name);

const BuildResult& courtyard() {
    static const BuildResult result = test::build_at(make_sample("courtyard"), 9);
    return result;
}

RenderOptions small_picture() {
    RenderOptions options;
    options.width = 100;  // not whole tiles
    options.height = 60;
    options.samples = 2;
    options.ao_samples = 16;
    options.shadow_samples = 32;
    return options;
}

/// A place that is a tenth of a thousandth of a voxel, or less, from the camera's, and a direction
/// as near: all that a pixel sees through it, and not through the camera, hangs on rounding.
Camera moved(const Camera& camera, const Grid& grid, int number) {
    std::mt19937 random(static_cast<std::uint32_t>(number));
    std::normal_distribution<double> normal;
    const auto some = [&] { return dvec3(normal(random), normal(random), normal(random)); };
    const double size = std::pow(10.0, -4.0 - number % 3);
    Camera near = camera;
    near.eye += size * grid.voxel_size * some();
    near.forward += 1e-3 * size * glm::length(camera.forward) * some();
    return near;
}

using Draw = std::function<Image(const RenderOptions&)>;

/// Compares pictures. Pixels that differ must lie on a tie: within rounding of the camera the CPU
/// itself gives different answers, and the device's colour is one between them.
void expect_same(const std::string& device, const Image& found, const Grid& grid,
                 RenderOptions options, const Draw& on_cpu, const std::string& what,
                 bool sees_much = true) {
    constexpr float kRounding = 2e-4f;
    constexpr int kCameras = 24;
    const Image expected = on_cpu(options);
    ASSERT_EQ(found.color.size(), expected.color.size());
    std::vector<std::size_t> different;
    std::size_t seen = 0;  // pixels with a voxel
    const auto off = [&](const vec3& a, const vec3& b) {
        const vec3 d = glm::abs(a - b) / (1.0f + glm::abs(b));
        return std::max({d.x, d.y, d.z});
    };
    for (std::size_t i = 0; i < expected.color.size(); ++i) {
        seen += std::isfinite(expected.depth[i]);
        if (found.depth[i] != expected.depth[i] ||
            !(off(found.color[i], expected.color[i]) <= kRounding))
            different.push_back(i);
    }
    std::vector<vec3> low, high;
    for (const std::size_t i : different) {
        low.push_back(expected.color[i]);
        high.push_back(expected.color[i]);
    }
    for (int k = 0; k < kCameras && !different.empty(); ++k) {
        RenderOptions near = options;
        near.camera = moved(*options.camera, grid, k);
        const Image image = on_cpu(near);
        for (std::size_t n = 0; n < different.size(); ++n) {
            low[n] = glm::min(low[n], image.color[different[n]]);
            high[n] = glm::max(high[n], image.color[different[n]]);
        }
    }
    std::size_t ties = 0;
    for (std::size_t n = 0; n < different.size(); ++n) {
        const vec3 color = found.color[different[n]];
        const bool between = off(glm::clamp(color, low[n], high[n]), color) <= kRounding;
        ties += between;
        EXPECT_TRUE(between) << what << ": pixel "
                             << different[n] % static_cast<std::size_t>(options.width) << ", "
                             << different[n] / static_cast<std::size_t>(options.width) << ": "
                             << color.x << " " << color.y << " " << color.z << " beside "
                             << low[n].x << " " << low[n].y << " " << low[n].z << " to "
                             << high[n].x << " " << high[n].y << " " << high[n].z;
    }
    std::printf("%s: %s: %zu pixels, %zu differ, %zu of them at ties\n", device.c_str(),
                what.c_str(), expected.color.size(), different.size(), ties);
    if (sees_much) {
        EXPECT_GT(seen, expected.color.size() / 20) << what;
    }
    EXPECT_LE(different.size(), expected.color.size() / 50) << what;
}

RenderOptions with_camera(RenderOptions options, const Dag& dag, const Grid& grid) {
    if (!options.camera)
        options.camera = default_camera(framed_box(dag, grid), options.up,
                                        static_cast<double>(options.width) / options.height);
    return options;
}

void expect_same(Device& device, const RenderOptions& asked, const std::string& what) {
    const BuildResult& scene = courtyard();
    const RenderOptions options = with_camera(asked, scene.dag, scene.grid);
    const auto uploaded = device.upload(scene.dag);
    expect_same(
        device.info().name, device.render(*uploaded, scene.grid, options), scene.grid, options,
        [&](const RenderOptions& o) { return render(scene.dag, scene.grid, o); }, what,
        what != "away");
}

const std::vector<test::ColouredScene>& coloured_scenes() {
    static const std::vector<test::ColouredScene> scenes = {
        test::random_colours(test::dust(6, 0.5, 4), 6, 1),
        test::random_colours(test::dust(6, 0.6, 5), 5, 2),
        test::random_colours(test::slanted_wall(8, {3, -5, 7}, 384), 4, 3),
        test::random_colours(test::dust(2, 0.7, 9), 2, 4), test::lit_sample("courtyard", 7, 6)};
    return scenes;
}

void expect_same_colours(Device& device, const test::ColouredScene& scene,
                         const RenderOptions& asked, const std::string& what) {
    RenderOptions options = with_camera(asked, scene.dag, scene.grid);
    options.attributes = &scene.attributes;
    const auto uploaded = device.upload(scene.dag, scene.attributes, scene.light);
    expect_same(
        device.info().name, device.render(*uploaded, scene.grid, options), scene.grid, options,
        [&](const RenderOptions& o) { return render(scene.dag, scene.grid, o); },
        scene.name + ", " + what);
}

TEST_P(Pictures, AreThoseOfTheCpu) {
    expect_same(device(), small_picture(), "soft");
}

TEST_P(Pictures, WithHardShadowsFlatFacesAndSolidAnglesAreThoseOfTheCpu) {
    RenderOptions options = small_picture();
    options.shadows = Shadows::hard;
    options.smooth_normals = false;
    options.ao_cone = 0.05;
    options.beam = false;
    expect_same(device(), options, "hard");
    options.shadows = Shadows::none;
    options.ao_samples = 0;
    options.samples = 1;
    expect_same(device(), options, "none");
}

TEST_P(Pictures, WithEveryKindOfLampAreThoseOfTheCpu) {
    const dvec3 middle = courtyard().grid.bounds().centre();
    RenderOptions options = small_picture();
    options.least_light = 0.0f;  // as GPUs
    std::vector<Light> lights(5);
    for (Light& light : lights) {
        light.position = middle + dvec3(0.5, 3.0, 0.2);
        light.intensity = vec3(5.0f);
        light.size = 0.3;
    }
    lights[0].kind = Light::Kind::point;
    lights[1].kind = Light::Kind::spot;
    lights[2].kind = Light::Kind::disc;
    lights[3].kind = Light::Kind::rectangle;
    lights[3].half_u = {0.5, 0, 0};
    lights[3].half_v = {0, 0, 0.25};
    lights[4].kind = Light::Kind::mesh;
    for (int i = 0; i < 3; ++i) {
        const dvec3 at = middle + dvec3(i - 1.0, 3.0, 0.0);
        lights[4].triangles.push_back({at, at + dvec3(0.3, 0.1, 0), at + dvec3(0, 0, 0.4)});
    }
    for (const Light& light : lights) {
        options.lights = std::vector{light};
        expect_same(device(), options, "lamp " + std::to_string(static_cast<int>(light.kind)));
    }
    options.lights = lights;
    expect_same(device(), options, "all lamps");
}

TEST_P(Pictures, FromFarAwayAreThoseOfTheCpu) {
    const Box bounds = courtyard().grid.bounds();
    RenderOptions options = small_picture();
    const dvec3 way = glm::normalize(dvec3(1.0, 0.7, 0.4));
    options.camera = look_at(bounds.centre() + 1e5 * glm::length(bounds.size()) * way,
                             bounds.centre(), {0, 1, 0}, 1.2e-5);
    expect_same(device(), options, "far");
    options.camera =
        look_at(bounds.centre() + 1e12 * way, bounds.centre() + 2e12 * way, {0, 1, 0}, 0.5);
    expect_same(device(), options, "away");
}

TEST_P(Pictures, WithColoursAndEmissionAreThoseOfTheCpu) {
    for (const test::ColouredScene& scene : coloured_scenes()) {
        RenderOptions options = small_picture();
        options.width = 64;
        options.height = 40;
        options.ao_samples = 8;
        options.shadow_samples = 8;
        expect_same_colours(device(), scene, options, "coloured");
        options.level_of_detail = false;
        options.smooth_normals = false;
        options.samples = 1;
        expect_same_colours(device(), scene, options, "coloured voxels");
    }
}

/// Cells far below a pixel's size: the mean of those that a large one holds.
TEST_P(Pictures, OfLargeCellsHaveTheMeanOfTheirColours) {
    for (const std::size_t i : {0u, 2u, 4u}) {
        const test::ColouredScene& scene = coloured_scenes()[i];
        RenderOptions options = small_picture();
        options.width = 40;
        options.height = 24;
        options.ao_samples = 0;
        options.shadows = Shadows::none;
        options.samples = 1;
        const Box box = scene.grid.bounds();
        const dvec3 way = glm::normalize(dvec3(1.0, 0.7, 0.4));
        for (const double far : {4.0, 12.0, 40.0}) {
            options.camera = look_at(box.centre() + far * glm::length(box.size()) * way,
                                     box.centre(), {0, 1, 0}, 0.8);
            RenderOptions close = with_camera(options, scene.dag, scene.grid);
            close.attributes = &scene.attributes;
            const auto uploaded = device().upload(scene.dag, scene.attributes);
            expect_same(
                device().info().name, device().render(*uploaded, scene.grid, close), scene.grid,
                close, [&](const RenderOptions& o) { return render(scene.dag, scene.grid, o); },
                scene.name + " from " + std::to_string(static_cast<int>(far)), false);
        }
    }
}

TEST_P(Pictures, OfStoredLightAreThoseOfTheCpu) {
    for (const test::ColouredScene& scene : coloured_scenes())
        for (const bool smooth : {true, false}) {
            RenderOptions options = small_picture();
            options.width = 64;
            options.height = 40;
            options.smooth_normals = smooth;
            options = with_camera(options, scene.dag, scene.grid);
            LitScene lit;
            lit.objects.push_back({.dag = scene.dag,
                                   .grid = scene.grid,
                                   .attributes = scene.attributes,
                                   .light = scene.light});
            lit.sky = Sky::clear({0.0, 1.0, 0.0});
            const auto uploaded = device().upload(scene.dag, scene.attributes, scene.light);
            expect_same(
                device().info().name, device().render_cached(*uploaded, scene.grid, options),
                scene.grid, options,
                [&](const RenderOptions& o) { return render_lit(lit, Lighting::cached, o); },
                scene.name + (smooth ? ", stored light" : ", stored light, flat"));
        }
}

TEST_P(Pictures, UnderAnySkyAreThoseOfTheCpu) {
    SkyImage image{16, 8, {}};
    std::mt19937 random(3);
    for (int i = 0; i < 128; ++i)
        image.color.emplace_back(static_cast<float>(random() % 100) / 50.0f,
                                 static_cast<float>(random() % 100) / 80.0f, random() % 9);
    const test::ColouredScene& scene = coloured_scenes().back();
    RenderOptions options = small_picture();
    options.width = 64;
    options.height = 40;
    options.ao_samples = 4;
    options.shadow_samples = 4;
    const std::pair<const char*, Sky> skies[] = {
        {"no sky", Sky()},
        {"constant sky", Sky::constant({0.3f, 0.5f, 0.7f})},
        {"gradient",
         Sky::gradient({0.1f, 0.2f, 0.9f}, {1.0f, 0.9f, 0.8f}, {0.2f, 0.1f, 0.0f}, {0.1, 1.0, 0.3})
             .scaled(1.7f)},
        {"picture", Sky::image(image, {0.2, 1.0, 0.1}, 0.7).scaled(0.6f)}};
    for (const auto& [name, sky] : skies) {
        options.sky = sky;
        expect_same_colours(device(), scene, options, name);
    }
}

TEST_P(Pictures, AreTheSameWhenTheirPassesAreTimed) {
    if (std::string(GetParam()) != "host") GTEST_SKIP() << "one device is enough";
    const BuildResult& scene = courtyard();
    PassTimes times;
    const auto timed =
        make_gpu_device(make_timed_queue(std::make_unique<test::HostQueue>(), times));
    const RenderOptions options = small_picture();
    const Image expected = device().render(*device().upload(scene.dag), scene.grid, options);
    const Image found = timed->render(*timed->upload(scene.dag), scene.grid, options);
    EXPECT_TRUE(found.color == expected.color);
    for (const char* pass :
         {"beam", "primary", "surface", "sky", "lamp beam", "lamp", "light", "shade"})
        EXPECT_GT(times[pass], 0.0) << pass;
    EXPECT_EQ(times.size(), 8u);
    EXPECT_GT(times["sky"], times["shade"]);  // sixteen rays against none
}

TEST_P(Pictures, SayWhatWasNotUploaded) {
    const test::ColouredScene& scene = coloured_scenes().front();
    const auto bare = device().upload(scene.dag);
    RenderOptions options = small_picture();
    options.attributes = &scene.attributes;
    EXPECT_THROW((void)device().render(*bare, scene.grid, options), Error);
    EXPECT_THROW((void)device().render_cached(*bare, scene.grid, options), Error);
    const std::vector<vec3> points(3, vec3(0.0f));
    std::vector<vec3> out(3);
    EXPECT_THROW(device().looks(*bare, scene.grid, points, points, {out, {}, {}}), Error);
}

/// The middles of every n-th triangle, as a rasteriser gives them, and a point that is none.
void add_points_of_the_courtyard(std::size_t most, std::size_t step, std::vector<vec3>& positions,
                                 std::vector<vec3>& normals) {
    const Scene mesh = make_sample("courtyard");
    for (std::size_t i = 0; i < mesh.triangles.size() && positions.size() < most; i += step) {
        const auto corners = mesh.corners(i);
        const dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        if (!(glm::length(normal) > 1e-9)) continue;
        positions.emplace_back((corners[0] + corners[1] + corners[2]) / 3.0);
        normals.emplace_back(glm::normalize(normal));
    }
    positions.push_back(vec3(NAN));
    normals.push_back(vec3(0, 1, 0));
}

/// What a number of a point comes to on the CPU, when the point is moved by a thousandth of a voxel
/// or less: positions in float are that far off.
class Ties {
public:
    /// @param numbers  of each point, as the CPU has them where they are
    explicit Ties(std::vector<vec3> numbers) : low_(numbers), high_(std::move(numbers)) {}

    /// @param ask  ask(offset of all points, in voxels) gives the numbers there
    template <typename Ask>
    void look_around(const Ask& ask) {
        std::mt19937 random(5);
        std::normal_distribution<double> normal;
        for (int k = 0; k < 48; ++k) {
            const dvec3 some(normal(random), normal(random), normal(random));
            const std::vector<vec3> there = ask(std::pow(10.0, -3.0 - k % 3) * some);
            for (std::size_t i = 0; i < there.size(); ++i) {
                low_[i] = glm::min(low_[i], there[i]);
                high_[i] = glm::max(high_[i], there[i]);
            }
        }
    }
    /// @param slack  how far beyond what was seen it may be
    [[nodiscard]] bool holds(std::size_t point, const vec3& found, float slack) const {
        return glm::all(glm::greaterThanEqual(found, low_[point] - slack)) &&
               glm::all(glm::lessThanEqual(found, high_[point] + slack));
    }

private:
    std::vector<vec3> low_, high_;
};

std::vector<vec3> moved(const std::vector<vec3>& positions, const dvec3& offset) {
    std::vector<vec3> there;
    for (const vec3& p : positions) there.emplace_back(dvec3(p) + offset);
    return there;
}

TEST_P(GBuffer, IsGivenTheLooksAndTheLightOfItsCells) {
    const test::ColouredScene& scene = coloured_scenes().back();
    std::vector<vec3> positions, normals;
    add_points_of_the_courtyard(2000, 5, positions, normals);
    const std::size_t count = positions.size();
    std::vector<vec3> found[3], expected[3];
    for (auto* all : {&found, &expected})
        for (auto& array : *all) array.resize(count);
    const auto ask = [&](Device& device, std::vector<vec3>(&out)[3]) {
        const auto uploaded = device.upload(scene.dag, scene.attributes, scene.light);
        device.looks(*uploaded, scene.grid, positions, normals, {out[0], out[1], out[2]});
    };
    ask(device(), found);
    ask(*open_device("cpu"), expected);
    std::size_t coloured = 0, lit = 0, different = 0;
    for (int n = 0; n < 3; ++n) {
        Ties ties(expected[n]);
        ties.look_around([&](const dvec3& offset) {
            std::vector<vec3> there[3];
            for (auto& array : there) array.resize(count);
            const std::vector<vec3> at = moved(positions, scene.grid.voxel_size * offset);
            const auto cpu = open_device("cpu");
            const auto uploaded = cpu->upload(scene.dag, scene.attributes, scene.light);
            cpu->looks(*uploaded, scene.grid, at, normals, {there[0], there[1], there[2]});
            return there[n];
        });
        for (std::size_t i = 0; i < count; ++i)
            EXPECT_TRUE(ties.holds(i, found[n][i], 1e-3f))
                << n << ": point " << i << ": " << glm::length(found[n][i] - expected[n][i])
                << " off of " << glm::length(expected[n][i]);
    }
    for (std::size_t i = 0; i < count; ++i) {
        coloured += expected[0][i] != vec3(0.0f);
        lit += expected[2][i] != vec3(0.0f);
        // Positions in float choose another cell at its border.
        different += glm::length(found[0][i] - expected[0][i]) > 1e-4f ||
                     glm::length(found[1][i] - expected[1][i]) > 1e-4f ||
                     glm::length(found[2][i] - expected[2][i]) > 1e-3f;
    }
    std::printf("%s: looks of %zu points, %zu with colour, %zu lit, %zu differ\n", GetParam(),
                count, coloured, lit, different);
    EXPECT_EQ(coloured, count - 1);
    EXPECT_GT(lit, count / 10);  // many triangles lie inside walls
    EXPECT_LT(different, count / 50);
    EXPECT_EQ(found[0].back(), vec3(0.0f));
}

TEST_P(GBuffer, IsGivenTheVisibilityOfTheCpu) {
    const BuildResult& scene = courtyard();
    std::vector<vec3> positions, normals;
    add_points_of_the_courtyard(3000, 7, positions, normals);
    positions.push_back(positions[0]);
    normals.push_back(vec3(0.0f));

    VisibilityOptions options;
    options.light = sun_at(0.6, 0.8);
    options.shadow_samples = 16;
    options.ao_samples = 80;  // more than one pass takes
    options.ao_radius = 1.0;
    std::vector<float> shadow(positions.size()), sky(positions.size());
    std::vector<float> expected_shadow(positions.size()), expected_sky(positions.size());
    const auto uploaded = device().upload(scene.dag);
    device().visibility(*uploaded, scene.grid, positions, normals, options, shadow, sky);
    const std::vector<dvec3> in_double(positions.begin(), positions.end());
    visibility(scene.dag, scene.grid, in_double, normals, options, expected_shadow, expected_sky);
    const auto pairs = [](const std::vector<float>& a, const std::vector<float>& b) {
        std::vector<vec3> both;
        for (std::size_t i = 0; i < a.size(); ++i) both.emplace_back(a[i], b[i], 0.0f);
        return both;
    };
    Ties ties(pairs(expected_shadow, expected_sky));
    ties.look_around([&](const dvec3& offset) {
        std::vector<dvec3> there;
        for (const dvec3& p : in_double) there.push_back(p + scene.grid.voxel_size * offset);
        std::vector<float> shadow_there(there.size()), sky_there(there.size());
        visibility(scene.dag, scene.grid, there, normals, options, shadow_there, sky_there);
        return pairs(shadow_there, sky_there);
    });
    // Of its many rays one may graze a voxel where none of the places around does.
    const std::vector<vec3> both = pairs(shadow, sky);
    for (std::size_t i = 0; i < both.size(); ++i)
        EXPECT_TRUE(ties.holds(i, both[i], 1.01f / 16))
            << "point " << i << ": " << shadow[i] << " " << sky[i] << " beside "
            << expected_shadow[i] << " " << expected_sky[i];
    std::size_t different = 0;
    double off = 0.0;
    for (std::size_t i = 0; i < sky.size(); ++i) {
        different += sky[i] != expected_sky[i] || shadow[i] != expected_shadow[i];
        off += std::abs(static_cast<double>(sky[i] - expected_sky[i])) +
               std::abs(static_cast<double>(shadow[i] - expected_shadow[i]));
    }
    std::printf("%s: G-buffer: %zu points, %zu differ, mean by %.5f\n", GetParam(), sky.size(),
                different, off / static_cast<double>(sky.size()));
    EXPECT_GT(std::ranges::count(expected_shadow, 0.0f), 100);
    EXPECT_GT(std::ranges::count(expected_shadow, 1.0f), 5);
    EXPECT_LT(different, sky.size() / 20);
    EXPECT_LT(off / static_cast<double>(sky.size()), 0.002);
    for (std::size_t i = sky.size() - 2; i < sky.size(); ++i) {
        EXPECT_EQ(sky[i], 1.0f);
        EXPECT_EQ(shadow[i], 1.0f);
    }
}

}  // namespace
}  // namespace octavo
