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
    TemporaryFolder folder;
};

TEST_P(FullCube, IsAnsweredAtOnceByEveryOperation) {
    const std::uint64_t voxels = std::uint64_t{1} << 3 * GetParam();
    const Validation found = validate_octv(folder / "full.octv", {.strict = true});
    ASSERT_TRUE(found.valid()) << found.findings[0].message;
    EXPECT_EQ(found.statistics.voxels, voxels);
    EXPECT_LE(found.statistics.dag_bytes, 600u);

    // Each command under the address space of a small program, and a time that paths would not
    // keep.
    for (const std::string& command :
         {std::string("octavo validate --strict full.octv"),
          std::string("octavo info full.octv --levels"),
          std::string("octavo query full.octv --ray -100,3,3,1,0.01,0.01"),
          std::string("octavo query full.octv --point 0,3,1"),
          std::string(
              "octavo render full.octv -o a.png --size 32x32 -q --force --samples 1 --ao 4")}) {
        const test::Outcome outcome = test::run_shell(folder.path(), "timeout 20 " + command);
        EXPECT_EQ(outcome.code, 0) << command << "\n" << outcome.err;
    }
}

INSTANTIATE_TEST_SUITE_P(Depth, FullCube, testing::Values(13, 17),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace octavo
