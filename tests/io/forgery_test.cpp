// SPDX-License-Identifier: MIT
// Files whose checksums are right and whose content is not.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "io/small_model.h"
#include "octavo/attributes/cell_values_writer.h"
#include "octavo/core/error.h"
#include "octavo/io/compression.h"
#include "octavo/io/container.h"
#include "octavo/io/octv.h"
#include "octv_parts.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using octv::Section;
using test::TemporaryFolder;

/// A model's file taken apart, to be changed and sealed again.
struct Forgery : fuzz::OctvParts {
    explicit Forgery(const Model& model, bool compress = false)
        : OctvParts(test::bytes_of(model, compress)) {}

    Part& metadata() { return *find(octv::kMetadataSection); }
    Part& dag() { return *find(octv::kDagSection); }

    void set_word(std::size_t index, std::uint32_t word) {
        std::memcpy(dag().content.data() + 4 * index, &word, 4);
    }
    void replace_in_metadata(const std::string& from, const std::string& to) {
        const std::size_t at = metadata().content.find(from);
        ASSERT_NE(at, std::string::npos);
        metadata().content.replace(at, from.size(), to);
    }
};

/// The error that reading these bytes gives, as "CODE OFFSET MESSAGE"; or "read".
std::string reading(const std::vector<std::uint8_t>& bytes) {
    const TemporaryFolder folder;
    test::write_file(folder / "a", std::string(bytes.begin(), bytes.end()));
    try {
        (void)read_octv(folder / "a");
        return "read";
    } catch (const Error& error) {
        const std::string code = error.code() == Errc::bad_input     ? "bad "
                                 : error.code() == Errc::unsupported ? "unsupported "
                                 : error.code() == Errc::limit       ? "limit "
                                                                     : "other ";
        std::string message = error.what();
        message = message.substr(message.find(": ") + 2);
        return code + std::to_string(error.offset().value_or(~0ull)) + " " + message;
    }
}

TEST(Forgery, OfNothingIsRead) {
    EXPECT_EQ(reading(Forgery(test::small_model()).sealed()), "read");
    EXPECT_EQ(reading(Forgery(test::small_model(), true).sealed()), "read");
}

TEST(Forgery, NewerVersionIsRefusedByItsNumber) {
    std::vector<std::uint8_t> file = Forgery(test::small_model()).sealed();
    file[8] = 2;
    EXPECT_EQ(reading(file), "unsupported 8 format version 2; this program reads up to 1");
    file[8] = 0;
    EXPECT_EQ(reading(file), "bad 8 format version 0 does not exist");
}

TEST(Forgery, BigEndianFileIsNamedAsSuch) {
    std::vector<std::uint8_t> file = Forgery(test::small_model()).sealed();
    std::memcpy(file.data() + 8, "\0\0\0\1\1\2\3\4", 8);
    EXPECT_EQ(reading(file), "bad 12 the file's bytes are in big-endian order");
}

TEST(Forgery, UnknownSectionsAreSkippedUnlessRequired) {
    Forgery forgery(test::small_model());
    forgery.set(octv::section_id("ATTR"), 0, "whatever this is");
    EXPECT_EQ(reading(forgery.sealed()), "read");
    forgery.parts.back().section.flags = octv::kRequired;
    EXPECT_EQ(
        reading(forgery.sealed()),
        "unsupported 160 section ATTR is needed to understand the file, and this program does "
        "not know it");
    forgery.parts.back().section.id = octv::kDagSection;
    EXPECT_EQ(reading(forgery.sealed()), "bad 160 section DAG is there twice");
}

TEST(Forgery, MissingSectionsAreNamed) {
    Forgery forgery(test::small_model());
    forgery.parts.pop_back();
    EXPECT_EQ(reading(forgery.sealed()), "bad 64 section DAG is missing");
    forgery.parts.pop_back();
    EXPECT_NE(reading(forgery.sealed()), "read");
}

TEST(Forgery, SectionsMustBeAlignedApartAndInside) {
    const Forgery forgery(test::small_model());
    const auto with = [&](auto change) {
        return reading(forgery.sealed([&](std::vector<Section>& table) { change(table[1]); }));
    };
    EXPECT_EQ(with([](Section& dag) { dag.offset += 4; }),
              "bad 120 section DAG does not begin at a multiple of 4096");
    EXPECT_EQ(with([](Section& dag) { dag.offset = 4096; }),
              "bad 120 section DAG overlaps what comes before it");
    EXPECT_EQ(with([](Section& dag) { dag.offset = 0; }),
              "bad 120 section DAG overlaps what comes before it");
    EXPECT_EQ(with([](Section& dag) { dag.offset = ~std::uint64_t{4095}; }),
              "bad 128 section DAG reaches past the end of the file");
    EXPECT_EQ(with([](Section& dag) { dag.stored_bytes = dag.raw_bytes = ~0ull; }),
              "bad 128 section DAG reaches past the end of the file");
    EXPECT_EQ(with([](Section& dag) { dag.raw_bytes += 4; }),
              "bad 136 section DAG is not compressed, yet has two sizes");
    EXPECT_EQ(with([](Section& dag) { dag.flags |= 8; }),
              "bad 116 section DAG has flags that format version 1 does not know");
}

TEST(Forgery, HugeSectionCountIsRefused) {
    std::vector<std::uint8_t> file = Forgery(test::small_model()).sealed();
    std::memcpy(file.data() + 24, "\xff\xff\xff\xff", 4);
    EXPECT_EQ(reading(file), "bad 24 4294967295 sections; at most 84 fit");
}

TEST(Forgery, PointersAreFollowedToTheByte) {
    Forgery forgery(test::small_model());
    forgery.set_word(1, 4);
    EXPECT_EQ(reading(forgery.sealed()), "bad 8196 pointer 4 leads into the middle of a node");
    forgery.set_word(1, 0);  // a cycle
    EXPECT_EQ(reading(forgery.sealed()), "bad 8196 pointer 0 leads outside the next level");
    forgery.set_word(1, 3);
    forgery.set_word(3, 0x10003);
    EXPECT_EQ(reading(forgery.sealed()), "bad 8204 spare bits of a node are not zero");
}

TEST(Forgery, CompressedWordsAreCheckedToo) {
    Forgery forgery(test::small_model());
    forgery.set_word(1, 4);
    std::string frame;
    const std::string words = forgery.dag().content;
    zstd_compress(
        std::as_bytes(std::span(words)),
        [&](std::span<const std::byte> piece) {
            frame.append(reinterpret_cast<const char*>(piece.data()), piece.size());
        },
        [](std::uint64_t) {});
    forgery.dag().section.flags |= octv::kZstd;
    forgery.dag().section.raw_bytes = words.size();
    forgery.dag().content = frame;
    EXPECT_EQ(
        reading(forgery.sealed()),
        "bad 8192 pointer 4 leads into the middle of a node (word 1 of the decompressed DAG)");

    forgery.dag().content = frame + frame;
    EXPECT_EQ(
        reading(forgery.sealed()),
        "bad 8192 section DAG does not decompress: it is not one zstd frame of the stated size");
}

TEST(Forgery, SizesThatDisagreeAreRefusedBeforeMemoryIsTaken) {
    Forgery forgery(test::small_model(), true);
    forgery.dag().section.raw_bytes = std::uint64_t{1} << 62;
    EXPECT_EQ(reading(forgery.sealed()),
              "bad 8192 section DAG has 4611686018427387904 bytes where the metadata states 48");
    forgery.dag().section.raw_bytes = 48;
    forgery.metadata().section.flags |= octv::kZstd;
    forgery.metadata().section.raw_bytes = std::uint64_t{1} << 40;
    EXPECT_EQ(reading(forgery.sealed()), "bad 4096 the metadata is larger than 16 MiB");
}

TEST(Forgery, CompressedDagAboveTheBudgetIsALimit) {
    const TemporaryFolder folder;
    write_octv(folder / "a", test::small_model(), {.compress = true});
    try {
        (void)read_octv(folder / "a", {.max_dag_bytes = 47});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::limit);
    }
}

TEST(Forgery, CompressedSectionsShareTheBudget) {
    const TemporaryFolder folder;
    Model model = test::small_model();
    const CellIndex cells(model.dag, 4);
    std::array<CellValues, Attributes::kChannels> channels;
    CellValuesWriter writer(24, 0);
    writer.append(std::vector<std::uint32_t>(cells.count(), 7));
    channels[0] = std::move(writer).finish();
    model.attributes = Attributes(cells, channels);
    const std::uint64_t all = model.dag.size_bytes() + channels[0].words().size_bytes();
    write_octv(folder / "a", model, {.compress = true});
    EXPECT_TRUE(read_octv(folder / "a", {.max_dag_bytes = all}).attributes.has_color());
    try {
        (void)read_octv(folder / "a", {.max_dag_bytes = all - 1});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::limit);
    }
}

TEST(Forgery, MetadataThatDoesNotMatchTheWordsIsRefused) {
    Forgery forgery(test::small_model());
    forgery.replace_in_metadata(R"("dag_nodes":2,"words":5)", R"("dag_nodes":1,"words":5)");
    EXPECT_EQ(reading(forgery.sealed()), "bad 8204 level 1 has 2 nodes where 1 are stated");
}

TEST(Forgery, MetadataErrorsNameTheField) {
    Forgery forgery(test::small_model());
    forgery.replace_in_metadata(R"("depth":4)", R"("depth":"4")");
    EXPECT_EQ(reading(forgery.sealed()), "bad 4096 metadata: /grid/depth is not a count");
    forgery.metadata().content = "{";
    EXPECT_EQ(reading(forgery.sealed()), "bad 4096 metadata: not JSON at its byte 2");
}

}  // namespace
}  // namespace octavo
