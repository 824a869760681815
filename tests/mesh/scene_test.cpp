// SPDX-License-Identifier: MIT
#include "octavo/mesh/scene.h"

#include <gtest/gtest.h>

#include <limits>

#include "mesh/mesh_files.h"
#include "octavo/core/parallel.h"
#include "octavo/mesh/samples.h"

namespace octavo {
namespace {

TEST(SceneBounds, LeaveOutUnusedPositionsAndTrianglesThatAreNotFinite) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0},   {0, 2, 0},        {100, 100, 100},
                       {9, 9, 9}, {nan, 0, 0}, {0, infinity, 0}, {0, 0, 3}};
    scene.triangles = {{0, 1, 2}, {0, 4, 5}, {6, 4, 0}, {0, 1, 7}};
    const Box box = scene.bounds();
    EXPECT_EQ(box.low, dvec3(0, 0, 0));
    EXPECT_EQ(box.high, dvec3(1, 2, 3));
}

TEST(SceneBounds, AreEmptyForAnEmptyScene) {
    EXPECT_TRUE(Scene{}.bounds().empty());
}

TEST(SceneBounds, DoNotDependOnThreads) {
    const Scene scene = make_sample("hairball", 0.05);
    Box one, many;
    with_threads(1, [&] { one = scene.bounds(); });
    with_threads(7, [&] { many = scene.bounds(); });
    EXPECT_EQ(one.low, many.low);
    EXPECT_EQ(one.high, many.high);
}

TEST(LoadScene, SaysThatAFileIsMissing) {
    EXPECT_EQ(test::load_error("/nonexistent/scene.ply").code(), Errc::io);
}

TEST(LoadScene, RejectsFoldersPipesAndUnknownKinds) {
    const test::TemporaryFolder folder;
    EXPECT_EQ(test::load_error(folder.path()).code(), Errc::bad_input);
    EXPECT_EQ(test::load_error("/dev/zero").code(), Errc::bad_input);
    EXPECT_EQ(test::load_error(folder.write("notes.txt", "hello")).code(), Errc::unsupported);
}

TEST(LoadScene, KnowsAFormatByItsContentWhateverItsName) {
    const test::TemporaryFolder folder;
    const auto file = folder.write("scan.dat",
                                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                   "property float y\nproperty float z\nelement face 1\n"
                                   "property list uchar int vertex_indices\nend_header\n"
                                   "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    EXPECT_EQ(load_scene(file).triangles.size(), 1u);
}

TEST(LoadScene, ReadsOtherFormatsThroughAssimp) {
    const test::TemporaryFolder folder;
    const auto file =
        folder.write("quad.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
    const Scene scene = load_scene(file);
    EXPECT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(scene.bounds().high, dvec3(1, 1, 0));
}

TEST(LoadScene, EndsInAnErrorForAnyBytesUnderAnyName) {
    const test::TemporaryFolder folder;
    std::uint32_t state = 1;
    for (const char* name : {"a.gltf", "a.glb", "a.obj", "a.ply", "a.stl", "a.ply.gz", "a.off"}) {
        for (const char* start :
             {"", "glTF\x02", "ply\n", "solid ", "\x1f\x8b\x08", "{", "OFF\n"}) {
            std::string bytes = start;
            for (int i = 0; i < 500; ++i)
                bytes += static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
            const auto file = folder.write(name, bytes);
            EXPECT_THROW((void)load_scene(file), Error) << name << " with " << start;
        }
    }
}

}  // namespace
}  // namespace octavo
