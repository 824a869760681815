// SPDX-License-Identifier: MIT
//
// Pictures and visibility on every device against those of the CPU.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "backend/test_devices.h"
#include "octavo/construct/build.h"
#include "octavo/mesh/samples.h"

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

/// A pixel's rays are those of the CPU but for the last bits of a direction, so few may differ; and
/// what one ray of a pixel's `rays` answers otherwise changes it by no more than that ray's share.
void expect_same(Device& device, const RenderOptions& options, const std::string& what) {
    const BuildResult& scene = courtyard();
    const Image expected = render(scene.dag, scene.grid, options);
    const auto uploaded = device.upload(scene.dag);
    const Image found = device.render(*uploaded, scene.grid, options);
    ASSERT_EQ(found.color.size(), expected.color.size());
    std::size_t seen = 0;       // pixels with a voxel
    std::size_t primary = 0;    // another voxel
    std::size_t secondary = 0;  // the same voxel, another number of rays that met something
    float largest = 0.0f;
    for (std::size_t i = 0; i < expected.color.size(); ++i) {
        seen += std::isfinite(expected.depth[i]);
        const bool same_depth = found.depth[i] == expected.depth[i];
        const vec3 off = glm::abs(found.color[i] - expected.color[i]);
        const float worst = std::max({off.x, off.y, off.z});
        if (!same_depth)
            ++primary;
        else if (worst > 1e-4f)
            ++secondary;
        if (same_depth) largest = std::max(largest, worst);
    }
    std::printf(
        "%s: %s: %zu pixels, %zu of another voxel, %zu of other secondary rays, at most %.4f\n",
        device.info().name.c_str(), what.c_str(), expected.color.size(), primary, secondary,
        static_cast<double>(largest));
    if (what != "away") {
        EXPECT_GT(seen, expected.color.size() / 20) << what;
    }
    EXPECT_LE(primary, expected.color.size() / 1000) << what;
    EXPECT_LE(secondary, expected.color.size() / 100) << what;
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

TEST_P(GBuffer, IsGivenTheVisibilityOfTheCpu) {
    const BuildResult& scene = courtyard();
    // Points of the triangles, as a rasteriser gives them.
    const Scene mesh = make_sample("courtyard");
    std::vector<vec3> positions, normals;
    for (std::size_t i = 0; i < mesh.triangles.size() && positions.size() < 3000; i += 7) {
        const auto corners = mesh.corners(i);
        const dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        if (!(glm::length(normal) > 1e-9)) continue;
        positions.emplace_back((corners[0] + corners[1] + corners[2]) / 3.0);
        normals.emplace_back(glm::normalize(normal));
    }
    positions.push_back(vec3(NAN));
    normals.push_back(vec3(0, 1, 0));
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
    // Positions in float move rays by some hundredths of a voxel.
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
