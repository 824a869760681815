// SPDX-License-Identifier: MIT
// The fuzzers' harnesses over what they have found, and over random sound DAGs.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <iostream>

#include "cli/run_command.h"
#include "harness.h"
#include "octavo/io/validate.h"
#include "octavo/render/render.h"
#include "octavo/trace/trace.h"
#include "support/sanitized.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

fuzz::Bytes bytes_of(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string text_of(const std::vector<std::uint8_t>& bytes) {
    return {bytes.begin(), bytes.end()};
}

class Corpus : public testing::TestWithParam<fuzz::Harness> {};

TEST_P(Corpus, BreaksNoPromise) {
    const fs::path folder = fs::path(OCTAVO_SOURCE_DIR) / "tests" / "corpus" / GetParam().name;
    int files = 0;
    if (fs::is_directory(folder)) {
        for (const auto& entry : fs::directory_iterator(folder)) {
            SCOPED_TRACE(entry.path().string());
            GetParam().run(bytes_of(test::file_content(entry.path())));
            ++files;
        }
    }
    GetParam().run({});
    std::cout << files << " files\n";
}

INSTANTIATE_TEST_SUITE_P(Harness, Corpus,
                         testing::ValuesIn(fuzz::harnesses().begin(), fuzz::harnesses().end()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(SoundDags, AreAcceptedAndBearEveryOperation) {
    const TemporaryFolder folder;
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        const auto file = fuzz::random_octv(seed, true);
        test::write_file(folder / "a", text_of(file));
        const Validation found = validate_octv(folder / "a");
        ASSERT_TRUE(found.valid()) << seed << ": " << found.findings[0].message;
        SCOPED_TRACE(seed);
        fuzz::run_octv(file);
    }
}

TEST(SoundDags, WithWrongCountsAreRefused) {
    const TemporaryFolder folder;
    int refused = 0;
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        const auto file = fuzz::random_octv(seed, false);
        test::write_file(folder / "a", text_of(file));
        const Validation found = validate_octv(folder / "a");
        if (found.valid()) continue;  // by chance
        EXPECT_EQ(found.findings[0].code, "voxel-count");
        ++refused;
    }
    EXPECT_GT(refused, 40);
}

/// A few hundred bytes of shared nodes that stand for 2^39 and 2^51 voxels.
class FullCube : public testing::TestWithParam<int> {
protected:
    FullCube() { test::write_file(folder / "full.octv", text_of(fuzz::full_octv(GetParam()))); }

    /// Within the address space of a small program, and a time that paths would not keep.
    void expect_answer(const std::string& line, const std::vector<int>& codes) {
        // A sanitizer's shadow needs more space, and its code more time.
        const std::string limit =
            test::kSanitized ? "timeout 200 " : "ulimit -v 4000000; timeout 20 ";
        const test::Outcome outcome = test::run_shell(folder.path(), limit + line);
        EXPECT_TRUE(std::ranges::find(codes, outcome.code) != codes.end())
            << line << "\n"
            << outcome.code << ": " << outcome.err;
    }
    TemporaryFolder folder;
};

TEST_P(FullCube, IsAnsweredAtOnceByEveryOperation) {
    const std::uint64_t voxels = std::uint64_t{1} << 3 * GetParam();
    const Validation found = validate_octv(folder / "full.octv", {.strict = true});
    ASSERT_TRUE(found.valid()) << found.findings[0].message;
    EXPECT_EQ(found.statistics.voxels, voxels);
    EXPECT_LE(found.statistics.dag_bytes, 600u);

    const auto file = fuzz::full_octv(GetParam(), 5);
    test::write_file(folder / "looks.octv", text_of(file));
    for (const char* line :
         {"octavo validate --strict full.octv", "octavo validate --json looks.octv",
          "octavo info full.octv --levels", "octavo info looks.octv --json",
          "octavo query full.octv --ray -100,3,3,1,0.01,0.01",
          "octavo query full.octv --point 0,3,1", "octavo query looks.octv --point 0,3,1 --json",
          "octavo render full.octv -o a.png --size 32x32 -q --force --samples 1 --ao 4",
          "octavo light looks.octv -o lit.octv -q --rays 1 --bounces 1",
          "octavo validate --strict lit.octv",
          "octavo render lit.octv -o a.png --size 16x16 -q --force --samples 1 --gi",
          "octavo export full.octv --html page.html",
          "octavo bench trace full.octv --frames 1 --size 8 --threads 1"})
        expect_answer(line, {0});
    // Refused, as there is nothing to light, and as these voxels have no place in a grid of bricks.
    expect_answer("octavo light full.octv -q", {2});
    expect_answer("octavo bench trace full.octv --frames 1 --size 8 --nanovdb", {2, 4});
    expect_answer("octavo build full.octv -r 32 -o again.octv -q", {2, 3});
}

TEST_P(FullCube, IsServed) {
    const test::Outcome outcome = test::serve_and_interrupt(folder.path(), "octavo view full.octv");
    EXPECT_NE(outcome.out.find("http://127.0.0.1"), std::string::npos) << outcome.out;
    EXPECT_LT(outcome.code, 128) << outcome.out;
}

/// Cells that all look alike take 4 bytes for 256 of them, and next to nothing compressed.
TEST(ManyCells, OfAFewBytesAreRefusedBySize) {
    if (test::kSanitized)
        GTEST_SKIP() << "a sanitizer's shadow does not fit the limit of this test";
    const TemporaryFolder folder;
    test::write_file(folder / "many.octv", text_of(fuzz::full_octv(13, 9, true)));
    EXPECT_LT(std::filesystem::file_size(folder / "many.octv"), 20000u);
    EXPECT_TRUE(validate_octv(folder / "many.octv").valid());
    const test::Outcome light = test::run_shell(
        folder.path(), "ulimit -v 8000000; timeout 60 octavo light many.octv -q --bounces 8");
    EXPECT_EQ(light.code, 4) << light.err;
    EXPECT_EQ(test::lines_in(light.err), 1) << light.err;
}

INSTANTIATE_TEST_SUITE_P(Depth, FullCube, testing::Values(13, 17),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace octavo
