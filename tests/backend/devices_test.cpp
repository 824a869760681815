// SPDX-License-Identifier: MIT
//
// The same rays on every device meet the same voxels.
#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <utility>

#include "backend/test_devices.h"
#include "octavo/construct/build.h"
#include "octavo/mesh/load.h"
#include "octavo/mesh/samples.h"
#include "support/exact_trace.h"
#include "support/random_rays.h"
#include "support/shared_scenes.h"
#include "support/small_dags.h"

namespace octavo {
namespace {

namespace s = shared;
constexpr s::Stop kToVoxels{0, 0.0f, 0.0f};

class Rays : public test::OnDevice {};
INSTANTIATE_TEST_SUITE_P(All, Rays, test::kTestDevices, test::device_name);
class RaysSlow : public test::OnDevice {};
INSTANTIATE_TEST_SUITE_P(All, RaysSlow, test::kTestDevices, test::device_name);

/// Every kind of random ray, among them those along edges and from far away.
std::vector<s::GridRay> all_kinds(const Dag& dag, std::uint32_t seed, std::size_t count) {
    test::RandomRays random(seed, static_cast<int>(dag.resolution()));
    std::vector<s::GridRay> rays;
    for (std::size_t i = 0; i < count; ++i) {
        Ray ray = random(static_cast<test::RandomRays::Kind>(i % test::RandomRays::kinds));
        if (i % 13 == 0) ray.origin -= 4.0 * dag.resolution() * ray.direction;
        rays.push_back(test::grid_ray(ray));
    }
    return rays;
}

/// How the answers of a device compare with the shared text on the CPU.
struct Comparison {
    std::size_t rays = 0;
    std::size_t hits = 0;
    std::size_t ties = 0;  // another voxel, but the ray touches its face within rounding

    void add(const Dag& dag, const s::GridRay& ray, const s::GridHit& expected,
             const s::GridHit& found) {
        ++rays;
        hits += expected.face != s::kFaceNone;
        if (expected.face == found.face && expected.path == found.path &&
            expected.height == found.height)
            return;
        const test::ExactRay exact{dvec3(ray.cell) + dvec3(ray.frac), dvec3(ray.dir), ray.t_min,
                                   ray.t_max};
        const test::ExactHit reference{expected.face != s::kFaceNone, expected.t, expected.path};
        const double tolerance = 4e-6 * dag.resolution();
        const bool tie = test::differ_by_a_graze(exact, found.face != s::kFaceNone, found.path,
                                                 reference, tolerance);
        EXPECT_TRUE(tie) << "ray " << rays;
        ++ties;
    }
    void print(const char* device, const std::string& what) const {
        std::printf("%s: %s: %zu rays, %zu hits, %zu ties\n", device, what.c_str(), rays, hits,
                    ties);
    }
};

void compare(Device& device, const Dag& dag, const std::vector<s::GridRay>& rays,
             const s::Stop& stop, Comparison& comparison) {
    const auto uploaded = device.upload(dag);
    std::vector<s::GridHit> hits(rays.size());
    std::vector<std::uint32_t> occluded(rays.size());
    device.trace_closest(*uploaded, rays, stop, hits);
    device.trace_any(*uploaded, rays, stop, occluded);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const s::GridHit expected = s::trace_closest(s::view(dag), rays[i], stop);
        comparison.add(dag, rays[i], expected, hits[i]);
        ASSERT_EQ(occluded[i], hits[i].face != s::kFaceNone ? 1u : 0u) << i;
    }
}

TEST_P(Rays, MeetTheSameVoxelsInRandomDags) {
    Comparison comparison;
    for (const int depth : {2, 3, 5, 9, 13, 17})
        for (const Dag& dag :
             {test::dust(depth, 0.5, 4), test::slanted_wall(depth, {3, -5, 7}, (3 << depth) / 2)})
            compare(device(), dag, all_kinds(dag, static_cast<std::uint32_t>(depth), 4000),
                    kToVoxels, comparison);
    comparison.print(GetParam(), "random DAGs");
    EXPECT_GT(comparison.hits, comparison.rays / 5);
    EXPECT_LE(comparison.ties, comparison.rays / 1000);
}

TEST_P(Rays, StopAtTheSameLargerCells) {
    Comparison comparison;
    const Dag dag = test::dust(10, 0.5, 4);
    for (const s::Stop& stop :
         {s::Stop{1, 0.0f, 0.0f}, s::Stop{5, 0.0f, 0.0f}, s::Stop{10, 0.0f, 0.0f}}) {
        compare(device(), dag, all_kinds(dag, 8, 2000), stop, comparison);
    }
    comparison.print(GetParam(), "larger cells");
}

TEST_P(Rays, MissAnEmptyDag) {
    const auto uploaded = device().upload(Dag());
    const std::vector<s::GridRay> rays(100, {ivec3(0), vec3(0.5f), vec3(1, 0, 0), 0.0f, 1e9f});
    std::vector<s::GridHit> hits(rays.size());
    device().trace_closest(*uploaded, rays, kToVoxels, hits);
    for (const s::GridHit& hit : hits) EXPECT_EQ(hit.face, s::kFaceNone);
}

/// The claim of every backend: the same million rays.
TEST_P(RaysSlow, MillionMeetTheSameVoxels) {
    Comparison comparison;
    for (const int depth : {6, 11, 17}) {
        const Dag dag = test::dust(depth, 0.55, 11);
        compare(device(), dag, all_kinds(dag, 70 + static_cast<std::uint32_t>(depth), 200000),
                kToVoxels, comparison);
    }
    for (const auto& [name, scale] : {std::pair("courtyard", 1.0), std::pair("city", 0.3),
                                      std::pair("hairball", 0.05), std::pair("scan", 0.02)}) {
        const Dag dag = test::build_at(make_sample(name, scale), 10).dag;
        compare(device(), dag, all_kinds(dag, 5, 100000), kToVoxels, comparison);
    }
    comparison.print(GetParam(), "a million rays");
    EXPECT_LE(comparison.ties, comparison.rays / 1000);
}

TEST_P(RaysSlow, MeetTheSameVoxelsInSponza) {
    OCTAVO_REQUIRE_SCENE("sponza/Sponza.gltf");
    const Scene scene = load_scene(test::shared_scenes() / "sponza/Sponza.gltf");
    const Dag dag = test::build_at(scene, 11).dag;
    Comparison comparison;
    compare(device(), dag, all_kinds(dag, 5, 100000), kToVoxels, comparison);
    comparison.print(GetParam(), "Sponza");
    EXPECT_LE(comparison.ties, comparison.rays / 1000);
}

TEST(Devices, ListBeginsWithTheCpuAndSaysWhatIsMissing) {
    const DeviceList list = list_devices();
    ASSERT_FALSE(list.devices.empty());
    EXPECT_EQ(list.devices.front().id(), "cpu");
    for (const auto& [kind, why] : list.missing) {
        EXPECT_TRUE(kind == "cuda" || kind == "vulkan");
        EXPECT_FALSE(why.empty());
    }
}

TEST(Devices, RefusesNamesThatAreNone) {
    for (const char* name : {"", "gpu", "vulkan:", "vulkan:x", "vulkan:-1", "cuda:1x", "cpu:0"})
        try {
            (void)open_device(name);
            ADD_FAILURE() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Errc::bad_argument) << name;
        }
    EXPECT_THROW((void)reducer_on("vulkan"), Error);
    EXPECT_FALSE(reducer_on("cpu"));
}

TEST(Devices, SaysClearlyThatThereIsNoSuchDevice) {
    for (const char* name : {"vulkan:77", "cuda:77"}) try {
            (void)open_device(name);
            ADD_FAILURE() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Errc::unsupported) << name;
            EXPECT_NE(std::string(error.what()), "");
        }
}

}  // namespace
}  // namespace octavo
