// SPDX-License-Identifier: MIT
// Small files that would become huge scenes, and libraries that do not come back.
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <string>

#include "mesh/mesh_files.h"
#include "octavo/mesh/child_process.h"
#include "octavo/mesh/save.h"
#include "octavo/mesh/scene_archive.h"
#include "support/sanitized.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

Errc code_of(const std::function<void()>& work, std::string* message = nullptr) {
    try {
        work();
    } catch (const Error& error) {
        if (message) *message = error.what();
        return error.code();
    }
    ADD_FAILURE() << "no Error";
    return Errc::cancelled;
}

TEST(LoadLimits, InstancesOfAMeshStopAtTheCap) {
    // 2000 nodes that show one mesh of a million zeros, in a file of some KiB.
    std::string nodes;
    std::string roots;
    for (int i = 0; i < 2000; ++i) {
        nodes += std::string(i ? "," : "") + R"({"mesh":0})";
        roots += std::string(i ? "," : "") + std::to_string(i);
    }
    const test::TemporaryFolder folder;
    const auto file = folder.write(
        "a.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[)" + roots +
                      R"(]}],"nodes":[)" + nodes +
                      R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
                      R"("accessors":[{"componentType":5126,"type":"VEC3","count":999999}]})");
    std::string message;
    EXPECT_EQ(code_of([&] { (void)load_scene(file, {.max_bytes = 128 * kMiB}); }, &message),
              Errc::limit);
    EXPECT_NE(message.find("instances"), std::string::npos) << message;
}

TEST(LoadLimits, ListedInstancesOfAMeshStopAtTheCap) {
    // 2000 nodes that each list a million places, of an empty mesh.
    std::string nodes;
    for (int i = 0; i < 2000; ++i)
        nodes +=
            std::string(i ? "," : "") +
            R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"SCALE":0}}}})";
    const test::TemporaryFolder folder;
    const auto file = folder.write(
        "a.gltf", R"({"asset":{"version":"2.0"},"nodes":[)" + nodes +
                      R"(],"meshes":[{"primitives":[]}],)"
                      R"("accessors":[{"componentType":5126,"type":"VEC3","count":999999}]})");
    EXPECT_EQ(code_of([&] { (void)load_scene(file, {.max_bytes = 128 * kMiB}); }), Errc::limit);
}

TEST(LoadLimits, InflatedFileStopsAtTheCap) {
    const test::TemporaryFolder folder;
    const std::string file = (folder / "bomb.ply.gz").string();
    gzFile out = gzopen(file.c_str(), "wb9");
    const std::string zeros(kMiB, '0');
    for (int i = 0; i < 64; ++i) gzwrite(out, zeros.data(), static_cast<unsigned>(zeros.size()));
    gzclose(out);
    EXPECT_EQ(code_of([&] { (void)load_scene(file, {.max_bytes = 16 * kMiB}); }), Errc::limit);
}

TEST(ChildProcess, HandsTheSceneOver) {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 1e300}, {0, 1, 0}};
    scene.triangles = {{0, 1, 2}};
    scene.colors.resize(3);
    scene.materials.resize(2);
    scene.materials[1].name = "m";
    scene.materials[1].alpha_cutoff = 0.25f;
    scene.triangle_materials = {1};
    scene.textures.push_back({"t", "/x/t.png", {std::byte{7}}});
    scene.cameras.resize(1);
    scene.cameras[0].name = "c";
    scene.lights.resize(1);
    scene.lights[0].kind = Light::Kind::spot;
    scene.warnings = {"one", ""};
    const Scene got = read_in_child(
        "a", [&] { return scene; }, 256 * kMiB, 60.0);
    EXPECT_EQ(got.geometry_hash(), scene.geometry_hash());
    EXPECT_EQ(got.warnings, scene.warnings);
    EXPECT_EQ(got.triangle_materials, scene.triangle_materials);
    EXPECT_EQ(got.materials[1].name, "m");
    EXPECT_EQ(got.materials[1].alpha_cutoff, 0.25f);
    EXPECT_FALSE(got.materials[0].alpha_cutoff);
    EXPECT_EQ(got.textures[0].file, "/x/t.png");
    EXPECT_EQ(got.textures[0].encoded, scene.textures[0].encoded);
    EXPECT_EQ(got.cameras[0].name, "c");
    EXPECT_EQ(got.lights[0].kind, Light::Kind::spot);
}

TEST(ChildProcess, AllocationThatFailsIsALimitEvenWhereTheLibraryCatchesIt) {
    if (test::kAllocationsMayNotFail)
        GTEST_SKIP() << "under the thread sanitizer nothing is thrown";
    const auto greedy = []() -> Scene {
        try {
            std::vector<char> all(std::size_t{1} << 40);
            return {};
        } catch (const std::exception& error) {
            throw Error(Errc::bad_input, "a", error.what());
        }
    };
    EXPECT_THROW((void)read_in_child("a", greedy, 256 * kMiB, 60.0), std::bad_alloc);
}

TEST(LoadLimits, CountsThatNoMemoryHoldsAreALimit) {
    if (test::kAllocationsMayNotFail)
        GTEST_SKIP() << "under the thread sanitizer nothing is thrown";
    const test::TemporaryFolder folder;
    const Error error =
        test::load_error(folder.write("a.off", "OFF\n4000000000 4000000000 0\n0 0 0\n"));
    EXPECT_EQ(error.code(), Errc::limit) << error.what();
}

/// Each is well-formed; its numbers are not.
TEST(Content, ThatIsNotFiniteOrTooLargeIsBadInputWithItsFile) {
    const test::TemporaryFolder folder;
    const auto obj = [](const std::string& x, const std::string& second = "1") {
        return "v " + x + " 0 0\nv " + second + " 0 0\nv 0 1 0\nf 1 2 3\n";
    };
    std::string stl(84, '\0');
    stl[80] = 1;
    for (int i = 0; i < 12; ++i) stl += test::raw(NAN);
    stl += std::string(2, '\0');
    for (const auto& [name, text] :
         {std::pair("huge.obj", obj("1e400")), std::pair("nan.obj", obj("nan")),
          std::pair("wide.obj", obj("1e308", "-1e308")), std::pair("nan.stl", stl)}) {
        const Error error = test::load_error(folder.write(name, text));
        EXPECT_EQ(error.code(), Errc::bad_input) << name;
        EXPECT_EQ(error.file(), folder / name) << error.what();
    }
    // One that is finite is enough.
    const auto mixed = folder.write("mixed.obj", obj("0") + obj("nan"));
    EXPECT_EQ(load_scene(mixed).triangles.size(), 2u);
}

TEST(Content, OfPlyListsIsWholeNumbers) {
    const test::TemporaryFolder folder;
    const auto ply = [](const std::string& count, const std::string& index) {
        return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
               "property float z\nelement face 1\nproperty list " +
               count + " " + index + " vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    };
    EXPECT_EQ(load_scene(folder.write("a.ply", ply("uchar", "int"))).triangles.size(), 1u);
    for (const auto& [count, index] : {std::pair("float", "int"), std::pair("uchar", "double")})
        EXPECT_EQ(test::load_error(folder.write("a.ply", ply(count, index))).code(),
                  Errc::bad_input);
}

TEST(ChildProcess, CrashIsBadInput) {
    std::string message;
    const auto crash = []() -> Scene {
        raise(SIGSEGV);
        return {};
    };
    EXPECT_EQ(code_of([&] { (void)read_in_child("a.dae", crash, 256 * kMiB, 60.0); }, &message),
              Errc::bad_input);
    EXPECT_EQ(message.find("a.dae: "), 0u) << message;
}

TEST(ChildProcess, WhatItPrintsIsNotSeen) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const auto chatter = []() -> Scene {
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
            if (write(stream, "loaded\n", 7) != 7) throw Error(Errc::io, "a", "cannot print");
        return {};
    };
    (void)read_in_child("a.dae", chatter, 256 * kMiB, 60.0);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ChildProcess, EndlessLoopIsALimit) {
    const auto begin = std::chrono::steady_clock::now();
    const auto loop = []() -> Scene {
        for (;;) {
            std::atomic_signal_fence(std::memory_order_seq_cst);
        }
    };
    EXPECT_EQ(code_of([&] { (void)read_in_child("a", loop, 256 * kMiB, 0.2); }), Errc::limit);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST(ChildProcess, ErrorsArriveAsTheyWere) {
    std::string message;
    const auto refuse = []() -> Scene { throw Error(Errc::unsupported, "a", "of another kind"); };
    EXPECT_EQ(code_of([&] { (void)read_in_child("a", refuse, 256 * kMiB, 60.0); }, &message),
              Errc::unsupported);
    EXPECT_EQ(message, "a: of another kind");
}

TEST(ChildProcess, BytesThatAreNoSceneAreRefused) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{8}, std::size_t{200}}) {
        const std::vector<std::byte> bytes(size, std::byte{0xff});
        EXPECT_EQ(code_of([&] { (void)read_scene_bytes(bytes); }), Errc::bad_input);
    }
}

}  // namespace
}  // namespace octavo
