// SPDX-License-Identifier: MIT
// Files of format version 1, frozen: every later program must read them as this one does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "harness.h"
#include "io/small_model.h"
#include "octavo/attributes/cell_values_writer.h"
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

CellValues values_of(int bits, const std::vector<std::uint32_t>& values) {
    CellValuesWriter writer(bits, 0);
    writer.append(values);
    return std::move(writer).finish();
}

/// The small model with every channel of attributes, cells with two sides among them.
Model colored_model() {
    Model model = test::small_model();
    CellIndex cells(model.dag, model.dag.depth());
    std::vector<std::uint32_t> color, back, emission, normal, back_normal;
    for (std::uint32_t i = 0; i < cells.count(); ++i) {
        const bool two_sided = i % 3 == 1;
        color.push_back(0x102030u * (i + 1) & 0xffffffu);
        back.push_back(two_sided ? pack_back(0x0a0b0cu + i, i % 120) : 0u);
        emission.push_back(i % 2 == 0 ? pack_rgb9e5(vec3(0.5f, 2.0f, 16.0f) * float(i + 1)) : 0u);
        normal.push_back(pack_normal(glm::normalize(vec3(1.0f, -2.0f, float(i)))));
        back_normal.push_back(two_sided ? pack_normal(vec3(0.0f, 0.0f, -1.0f)) : 0u);
    }
    model.metadata.attributes = AttributeSummary{model.dag.depth(), cells.count(), 0};
    std::array<CellValues, Attributes::kChannels> channels;
    const auto put = [&](Attributes::Channel channel, const std::vector<std::uint32_t>& values) {
        const auto index = static_cast<std::size_t>(channel);
        channels[index] = values_of(Attributes::kValueBits[index], values);
    };
    put(Attributes::Channel::color, color);
    put(Attributes::Channel::back, back);
    put(Attributes::Channel::emission, emission);
    put(Attributes::Channel::back_emission, emission);
    put(Attributes::Channel::normal, normal);
    put(Attributes::Channel::back_normal, back_normal);
    model.attributes = Attributes(std::move(cells), std::move(channels));
    return model;
}

/// The same with light.
Model lit_model() {
    Model model = colored_model();
    std::vector<std::uint32_t> words;
    for (std::uint32_t i = 0; i < 6 * model.attributes.cells().count(); ++i)
        words.push_back(i % 5 == 0 ? CellLight::kHidden : pack_rgb9e5(vec3(0.25f, 1.0f, float(i))));
    model.light = CellLight(model.dag.depth(), 2, std::move(words));
    model.metadata.light = LightSummary{2, model.metadata.lights, "color:1,2,3"};
    return model;
}

void expect_same_looks(const Model& read, const Model& expected) {
    expect_same(read, expected);
    ASSERT_EQ(read.attributes.cells().count(), expected.attributes.cells().count());
    ASSERT_GT(read.attributes.cells().count(), 5u);
    for (std::size_t c = 0; c < Attributes::kChannels; ++c) {
        const auto channel = static_cast<Attributes::Channel>(c);
        ASSERT_TRUE(read.attributes.has(channel)) << c;
        for (std::uint64_t i = 0; i < read.attributes.cells().count(); ++i)
            EXPECT_EQ(read.attributes.channel(channel).get(i),
                      expected.attributes.channel(channel).get(i))
                << c << " of cell " << i;
    }
    EXPECT_EQ(read.light.bounces(), expected.light.bounces());
    EXPECT_TRUE(std::ranges::equal(read.light.words(), expected.light.words()));
}

TEST(FormatVersion1, AttributesAndLightStayReadable) {
    expect_same_looks(read_octv(frozen("v1-colored.octv")), colored_model());
    expect_same_looks(read_octv(frozen("v1-lit.octv")), lit_model());
    // What the bits mean, too.
    const Attributes looks = read_octv(frozen("v1-colored.octv")).attributes;
    EXPECT_EQ(looks.color(0, vec3(0.0f)), (Rgb8{0x30, 0x20, 0x10}));
    EXPECT_EQ(looks.emission(2, vec3(0.0f)), vec3(1.5f, 6.0f, 48.0f));
    EXPECT_FALSE(looks.two_sided(0));
    EXPECT_TRUE(looks.two_sided(1));
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
                             "v1-full-8192.octv", "v1-colored.octv", "v1-lit.octv"})
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
    EXPECT_EQ(header_checksum("v1-colored.octv"), 0x9eca53481b3d6ac5ull);
    EXPECT_EQ(header_checksum("v1-lit.octv"), 0xf0f5578a14953bfcull);
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
