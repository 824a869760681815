// SPDX-License-Identifier: MIT
// Files of format version 1, frozen: every later program must read them as this one does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "harness.h"
#include "io/small_model.h"
#include "octavo/io/validate.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

std::filesystem::path frozen(const std::string& name) {
    return std::filesystem::path(OCTAVO_SOURCE_DIR) / "tests" / "format" / name;
}

void expect_same(const Model& read, const Model& expected) {
    EXPECT_TRUE(std::ranges::equal(read.dag.words(), expected.dag.words()));
    EXPECT_TRUE(std::ranges::equal(read.dag.level_begins(), expected.dag.level_begins()));
    EXPECT_EQ(encode_metadata(read.metadata), encode_metadata(expected.metadata));
}

TEST(FormatVersion1, StaysReadable) {
    expect_same(read_octv(frozen("v1-small.octv")), test::small_model());
    expect_same(read_octv(frozen("v1-compressed.octv")), test::small_model());
    expect_same(read_octv(frozen("v1-leaf.octv")), test::model_of(2, {0, 2}, {7, 0}));
    expect_same(read_octv(frozen("v1-empty.octv")), test::model_of(5, {0, 0, 0, 0, 0}, {}));
    const Model full = read_octv(frozen("v1-full-8192.octv"));
    EXPECT_EQ(full.metadata.statistics.voxels, std::uint64_t{1} << 39);
    EXPECT_EQ(compute_statistics(full.dag).voxels, std::uint64_t{1} << 39);
}

TEST(FormatVersion1, StaysStrictlyValid) {
    for (const char* name : {"v1-small.octv", "v1-compressed.octv", "v1-leaf.octv", "v1-empty.octv",
                             "v1-full-8192.octv"})
        EXPECT_TRUE(validate_octv(frozen(name), {.strict = true}).valid()) << name;
}

TEST(FormatVersion1, FrozenBytesHaveNotChanged) {
    // The checksum of the header and the table, which has those of the sections, is in the header.
    const auto header_checksum = [](const char* name) {
        const std::string bytes = test::file_content(frozen(name));
        std::uint64_t checksum = 0;
        std::memcpy(&checksum, bytes.data() + 32, 8);
        return checksum;
    };
    EXPECT_EQ(header_checksum("v1-small.octv"), 0xe6cd9fd52617992cull);
    EXPECT_EQ(header_checksum("v1-compressed.octv"), 0x531df0c8e4fd9907ull);
    EXPECT_EQ(header_checksum("v1-leaf.octv"), 0xa17f2a1dc30fad56ull);
    EXPECT_EQ(header_checksum("v1-empty.octv"), 0x458c488dd6d6c43aull);
    EXPECT_EQ(header_checksum("v1-full-8192.octv"), 0xffb2ed5021d25b55ull);
}

TEST(FormatVersion1, NewerFileIsRefusedByItsVersion) {
    const test::TemporaryFolder folder;
    std::string file = test::file_content(frozen("v1-small.octv"));
    file[8] = 7;
    test::write_file(folder / "a", file);
    try {
        (void)read_octv(folder / "a");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::unsupported);
        EXPECT_NE(std::string(error.what()).find("format version 7"), std::string::npos)
            << error.what();
    }
}

}  // namespace
}  // namespace octavo
