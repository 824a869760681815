// SPDX-License-Identifier: MIT
#include "octavo/io/octv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "io/small_model.h"
#include "octavo/core/error.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using test::file_content;
using test::small_model;
using test::TemporaryFolder;
using test::write_file;

void expect_equal(const Model& a, const Model& b) {
    EXPECT_EQ(a.dag.depth(), b.dag.depth());
    EXPECT_TRUE(std::ranges::equal(a.dag.level_begins(), b.dag.level_begins()));
    EXPECT_TRUE(std::ranges::equal(a.dag.words(), b.dag.words()));
    EXPECT_EQ(encode_metadata(a.metadata), encode_metadata(b.metadata));
}

TEST(Octv, SurvivesTheRoundTrip) {
    const TemporaryFolder folder;
    const Model model = small_model();
    for (const bool compress : {false, true}) {
        write_octv(folder / "a.octv", model, {.compress = compress});
        expect_equal(read_octv(folder / "a.octv"), model);
        expect_equal(read_octv(folder / "a.octv", {.trusted = true}), model);
        expect_equal(read_octv(folder / "a.octv", {.map = false}), model);
    }
}

TEST(Octv, KeepsADagWithoutVoxelsAndASingleLeaf) {
    const TemporaryFolder folder;
    for (const Model& model :
         {test::model_of(5, {0, 0, 0, 0, 0}, {}), test::model_of(2, {0, 2}, {7, 0})}) {
        for (const bool compress : {false, true}) {
            write_octv(folder / "a.octv", model, {.compress = compress});
            expect_equal(read_octv(folder / "a.octv"), model);
        }
    }
}

TEST(Octv, MapsTheWordsOnAPageBoundary) {
    const TemporaryFolder folder;
    write_octv(folder / "a.octv", small_model());
    const Model model = read_octv(folder / "a.octv");
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(model.dag.words().data()) % 4096, 0u);
}

TEST(Octv, KeepsItsWordsWhenTheFileIsReplacedOrRemoved) {
    const TemporaryFolder folder;
    write_octv(folder / "a.octv", small_model());
    const Model model = read_octv(folder / "a.octv");
    write_octv(folder / "a.octv", test::example_model());
    expect_equal(model, small_model());
    std::filesystem::remove(folder / "a.octv");
    expect_equal(model, small_model());
}

TEST(Octv, WritesTheSameBytesAgain) {
    const TemporaryFolder folder;
    for (const bool compress : {false, true}) {
        write_octv(folder / "a.octv", small_model(), {.compress = compress});
        write_octv(folder / "b.octv", small_model(), {.compress = compress});
        EXPECT_EQ(file_content(folder / "a.octv"), file_content(folder / "b.octv"));
    }
}

TEST(Octv, SummarizesWithoutTheDag) {
    const TemporaryFolder folder;
    write_octv(folder / "a.octv", small_model(), {.compress = true});
    const OctvSummary summary = read_octv_summary(folder / "a.octv");
    EXPECT_EQ(summary.file_bytes, std::filesystem::file_size(folder / "a.octv"));
    EXPECT_TRUE(summary.compressed);
    EXPECT_EQ(encode_metadata(summary.metadata), encode_metadata(small_model().metadata));
}

TEST(Octv, LeavesTheOldFileWhenAWriteIsCancelled) {
    const TemporaryFolder folder;
    for (const bool compress : {false, true}) {
        write_file(folder / "a.octv", "old");
        const OctvWriteOptions options{.compress = compress,
                                       .progress = [](const Progress&) { return false; }};
        try {
            write_octv(folder / "a.octv", small_model(), options);
            FAIL() << "was not cancelled";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Errc::cancelled);
        }
        EXPECT_EQ(file_content(folder / "a.octv"), "old");
        EXPECT_EQ(folder.entries(), 1u);
    }
}

TEST(Octv, RefusesMetadataOfAnotherDag) {
    const TemporaryFolder folder;
    Model model = small_model();
    model.metadata = test::example_model().metadata;
    EXPECT_THROW(write_octv(folder / "a.octv", model), Error);
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Octv, LeavesOutCamerasThatAreNotFinite) {
    Scene scene;
    scene.cameras.resize(2);
    scene.cameras[1].eye.y = std::numeric_limits<double>::infinity();
    scene.lights.resize(1);
    scene.lights[0].intensity.x = std::numeric_limits<float>::quiet_NaN();
    const Model model = make_model("a", scene, VoxelRule::thin, BuildResult{});
    EXPECT_EQ(model.metadata.cameras.size(), 1u);
    EXPECT_EQ(model.metadata.lights.size(), 0u);
}

TEST(Octv, SaysWhyAFileCannotBeOpened) {
    const TemporaryFolder folder;
    for (const auto& path :
         {folder / "missing.octv", folder.path(), std::filesystem::path("/dev/null")}) {
        try {
            (void)read_octv(path);
            FAIL() << path;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), std::filesystem::exists(path) ? Errc::bad_input : Errc::io)
                << error.what();
            EXPECT_EQ(error.file(), path);
        }
    }
}

}  // namespace
}  // namespace octavo
