// SPDX-License-Identifier: MIT
#include "octavo/mesh/samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "octavo/core/error.h"
#include "octavo/core/parallel.h"
#include "octavo/mesh/exact_math.h"

namespace octavo {
namespace {

/// FNV-1a over the bytes of positions, triangles and colours.
std::uint64_t fingerprint(const Scene& scene) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&hash](const void* data, std::size_t size) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
    };
    add(scene.positions.data(), scene.positions.size() * sizeof(dvec3));
    add(scene.triangles.data(), scene.triangles.size() * sizeof(uvec3));
    add(scene.colors.data(), scene.colors.size() * 4);
    return hash;
}

TEST(Samples, AreTheSameBitsOnEveryMachine) {
    // Made on x86-64 with g++ 12; a change of a sample changes its number here.
    const std::pair<const char*, std::uint64_t> kExpected[] = {
        {"courtyard", 18233708798030425280u},
        {"hairball", 10778502147873103053u},
        {"scan", 6044756678080328547u},
        {"city", 9006151148856899236u},
    };
    for (const auto& [name, expected] : kExpected)
        EXPECT_EQ(fingerprint(make_sample(name, 0.01)), expected) << name;
}

TEST(Samples, DoNotDependOnThreads) {
    for (const SampleInfo& info : samples()) {
        std::uint64_t one = 0, many = 1;
        with_threads(1, [&] { one = fingerprint(make_sample(info.name, 0.003)); });
        with_threads(5, [&] { many = fingerprint(make_sample(info.name, 0.003)); });
        EXPECT_EQ(one, many) << info.name;
    }
}

TEST(Samples, HaveTheTrianglesThatTheyAnnounce) {
    for (const SampleInfo& info : samples()) {
        const double size = info.triangles > 5'000'000 ? 0.02 : 1.0;
        const auto triangles = static_cast<double>(make_sample(info.name, size).triangles.size());
        EXPECT_NEAR(triangles / (size * static_cast<double>(info.triangles)), 1.0, 0.05)
            << info.name << " has " << triangles;
    }
}

TEST(Samples, GrowAndShrinkWithTheirSize) {
    for (const SampleInfo& info : samples()) {
        const auto at = [&](double size) {
            return static_cast<double>(make_sample(info.name, size).triangles.size());
        };
        EXPECT_LT(at(0.02), at(0.1)) << info.name;
        EXPECT_GT(at(0.0001), 0) << info.name;
    }
}

TEST(Samples, AreWholeScenes) {
    for (const SampleInfo& info : samples()) {
        const Scene scene = make_sample(info.name, 0.01);
        EXPECT_FALSE(scene.cameras.empty()) << info.name;
        ASSERT_FALSE(scene.lights.empty()) << info.name;
        EXPECT_EQ(scene.lights[0].kind, Light::Kind::sun);
        EXPECT_EQ(scene.triangle_materials.size(), scene.triangles.size());
        EXPECT_TRUE(scene.colors.empty() || scene.colors.size() == scene.positions.size());
        for (const uvec3& t : scene.triangles)
            ASSERT_LT(std::max({t.x, t.y, t.z}), scene.positions.size());
        for (const std::uint32_t material : scene.triangle_materials)
            ASSERT_LT(material, scene.materials.size());
        for (const dvec3& p : scene.positions)
            ASSERT_TRUE(std::isfinite(p.x + p.y + p.z)) << info.name;
        for (const Camera& camera : scene.cameras) {
            EXPECT_NEAR(glm::length(camera.forward), 1.0, 1e-12);
            EXPECT_NEAR(glm::dot(camera.forward, camera.up), 0.0, 1e-12);
        }
    }
}

TEST(Samples, CoordinatesAreFloatsSoThatFilesHoldThemExactly) {
    for (const SampleInfo& info : samples())
        for (const dvec3& p : make_sample(info.name, 0.002).positions)
            ASSERT_EQ(p, exact::rounded_to_float(p)) << info.name;
}

TEST(Samples, CourtyardHasLampsThatEmitAndThreeViews) {
    const Scene scene = make_sample("courtyard", 0.05);
    int lamps = 0;
    for (const Material& material : scene.materials)
        if (material.emission.r > 1.0f) ++lamps;
    EXPECT_GE(lamps, 1);
    EXPECT_GE(scene.cameras.size(), 3u);
}

TEST(Samples, UnknownNamesAndSizesAreRefused) {
    EXPECT_THROW((void)make_sample("teapot"), Error);
    for (const double size : {0.0, -1.0, 1e9, std::nan("")})
        EXPECT_THROW((void)make_sample("courtyard", size), Error);
}

TEST(SamplesSlow, ScanHasTenMillionTriangles) {
    EXPECT_NEAR(static_cast<double>(make_sample("scan").triangles.size()), 10e6, 0.05e6);
}

}  // namespace
}  // namespace octavo
