// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "octavo/attributes/build_attributes.h"
#include "octavo/io/container.h"
#include "octavo/io/mapped_file.h"
#include "octavo/io/octv.h"
#include "octavo/mesh/samples.h"
#include "support/temporary_folder.h"

#include <xxhash.h>

namespace octavo {
namespace {

Model model_with(const AttributeOptions& options) {
    const Scene scene = make_sample("courtyard", 0.005);
    BuildOptions how;
    how.depth = 8;
    Model model = make_model("sample:courtyard", scene, how.rule, build(scene, how));
    model.attributes = build_attributes(scene, model.dag, model.grid(), options);
    return model;
}

std::vector<std::byte> bytes_of(const std::filesystem::path& file) {
    const auto mapping = map_file(file);
    return {mapping->bytes().begin(), mapping->bytes().end()};
}

void write_bytes(const std::filesystem::path& file, const std::vector<std::byte>& bytes) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<long>(bytes.size()));
}

TEST(AttributeFile, GivesBackWhatWasWritten) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "a.octv";
    for (const int level : {8, 6})
        for (const bool compress : {false, true})
            for (const bool map : {false, true}) {
                const Model model = model_with({.normal = true, .level = level, .tolerance = 3});
                write_octv(file, model, {.compress = compress});
                OctvReadOptions how;
                how.map = map;
                const Model read = read_octv(file, how);
                ASSERT_EQ(read.attributes.level(), level);
                ASSERT_EQ(read.attributes.tolerance(), 3);
                for (std::size_t c = 0; c < Attributes::kChannels; ++c) {
                    const auto channel = static_cast<Attributes::Channel>(c);
                    EXPECT_TRUE(std::ranges::equal(read.attributes.channel(channel).words(),
                                                   model.attributes.channel(channel).words()));
                }
                const OctvSummary summary = read_octv_summary(file);
                ASSERT_TRUE(summary.metadata.attributes);
                EXPECT_EQ(summary.metadata.attributes->cells, model.attributes.cells().count());
                EXPECT_EQ(
                    summary.attribute_bytes[0],
                    model.attributes.channel(Attributes::Channel::color).words().size_bytes());
            }
}

TEST(AttributeFile, WithoutAttributesIsAsBefore) {
    const test::TemporaryFolder folder;
    Model model = model_with({});
    model.attributes = {};
    write_octv(folder.path() / "a.octv", model);
    const Model read = read_octv(folder.path() / "a.octv");
    EXPECT_TRUE(read.attributes.empty());
    EXPECT_FALSE(read.metadata.attributes);
    EXPECT_EQ(octv::decode_directory(bytes_of(folder.path() / "a.octv"), "a").size(), 2u);
}

TEST(AttributeFile, ForgedSectionsAreRefusedOrHarmless) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "a.octv";
    const Model model = model_with({.normal = true, .level = 6});
    write_octv(file, model);
    const std::vector<std::byte> good = bytes_of(file);
    const auto sections = octv::decode_directory(good, file);
    std::mt19937 random(2);
    int refused = 0;
    for (int i = 0; i < 400; ++i) {
        std::vector<std::byte> bytes = good;
        auto forged = sections;
        auto& section = forged[2 + random() % (forged.size() - 2)];
        const std::size_t near =
            random() % 2 ? std::min<std::size_t>(section.stored_bytes, 400) : section.stored_bytes;
        for (int k = 0; k < 3; ++k)
            bytes[section.offset + random() % near] = static_cast<std::byte>(random());
        // With checksums that fit, as somebody would who means it.
        section.checksum = XXH3_64bits(bytes.data() + section.offset, section.stored_bytes);
        const auto directory = octv::encode_directory(bytes.size(), forged);
        std::copy(directory.begin(), directory.end(), bytes.begin());
        write_bytes(file, bytes);
        try {
            const Model read = read_octv(file);
            for (std::uint64_t c = 0; c < read.attributes.cells().count(); c += 7) {
                (void)read.attributes.color(c, vec3(1.0f));
                (void)read.attributes.emission(c, vec3(1.0f));
                (void)read.attributes.normal(c, vec3(1.0f));
            }
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Errc::bad_input);
            ++refused;
        }
    }
    EXPECT_GT(refused, 50);
}

TEST(AttributeFile, DamageIsFoundByTheChecksum) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "a.octv";
    write_octv(file, model_with({}));
    std::vector<std::byte> bytes = bytes_of(file);
    const auto sections = octv::decode_directory(bytes, file);
    bytes[sections[2].offset + sections[2].stored_bytes / 2] ^= std::byte{1};
    write_bytes(file, bytes);
    EXPECT_THROW((void)read_octv(file), Error);
    OctvReadOptions geometry;
    geometry.attributes = false;
    EXPECT_NO_THROW((void)read_octv(file, geometry));
}

TEST(AttributeFile, RefusesAttributesOfAnotherDag) {
    const test::TemporaryFolder folder;
    Model model = model_with({});
    model.attributes = model_with({}).attributes;
    EXPECT_THROW(write_octv(folder.path() / "a.octv", model), Error);
}

}  // namespace
}  // namespace octavo
