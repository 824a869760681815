// SPDX-License-Identifier: MIT
#include "octavo/io/validate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "harness.h"
#include "io/small_model.h"
#include "octavo/construct/build.h"
#include "octavo/io/compression.h"
#include "octavo/mesh/samples.h"
#include "octv_parts.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using fuzz::OctvParts;
using test::bytes_of;
using test::TemporaryFolder;

Validation validate(const std::vector<std::uint8_t>& bytes, bool strict = false) {
    const TemporaryFolder folder;
    test::write_file(folder / "a", std::string(bytes.begin(), bytes.end()));
    return validate_octv(folder / "a", {.strict = strict});
}

/// "CODE@OFFSET CODE@OFFSET ..."
std::string codes(const std::vector<std::uint8_t>& bytes, bool strict = false) {
    std::string text;
    for (const Finding& finding : validate(bytes, strict).findings)
        text += (text.empty() ? "" : " ") + finding.code + "@" +
                (finding.offset ? std::to_string(*finding.offset) : "-");
    return text;
}

class ValidateWords : public testing::Test {
protected:
    /// The small model's file with these words of its DAG changed.
    [[nodiscard]] std::vector<std::uint8_t> with(
        const std::vector<std::pair<std::size_t, std::uint32_t>>& changes) const {
        OctvParts parts(bytes_of(test::small_model()));
        for (const auto& [word, value] : changes)
            std::memcpy(parts.find(octv::kDagSection)->content.data() + 4 * word, &value, 4);
        return parts.sealed();
    }
    static constexpr std::uint64_t kDag = 8192;  // where the section begins
};

TEST(Validate, FindsNothingInWhatTheWriterWrites) {
    for (const bool compress : {false, true}) {
        EXPECT_EQ(codes(bytes_of(test::small_model(), compress), true), "");
        EXPECT_EQ(codes(bytes_of(test::model_of(5, {0, 0, 0, 0, 0}, {}), compress), true), "");
        EXPECT_EQ(codes(bytes_of(test::model_of(2, {0, 2}, {7, 0}), compress), true), "");
    }
}

Model built_courtyard(int depth) {
    static const Scene kScene = make_sample("courtyard");
    BuildOptions options;
    options.depth = depth;
    options.tile = 8;
    return make_model("courtyard", kScene, options.rule, build(kScene, options));
}

TEST(Validate, FindsABuiltSceneMinimalAndInOrder) {
    for (const int depth : {3, 6, 9}) {
        const Model model = built_courtyard(depth);
        const Validation found = validate(bytes_of(model), true);
        EXPECT_TRUE(found.valid()) << found.findings.front().code;
        EXPECT_EQ(found.statistics.voxels, model.metadata.statistics.voxels);
    }
}

TEST_F(ValidateWords, CollectsEveryFaultWithItsByte) {
    EXPECT_EQ(codes(with({{1, 4}, {2, 0}, {10, 0}, {11, 0}})),
              "pointer-inside@" + std::to_string(kDag + 4) + " pointer-outside@" +
                  std::to_string(kDag + 8) + " leaf-empty@" + std::to_string(kDag + 40));
    EXPECT_EQ(codes(with({{3, 0x103}})), "node-spare-bits@" + std::to_string(kDag + 12));
    EXPECT_EQ(codes(with({{6, 0}})), "node-empty@" + std::to_string(kDag + 24));
    EXPECT_EQ(codes(with({{6, 0xff}})), "node-overrun@" + std::to_string(kDag + 24));
}

TEST_F(ValidateWords, CountsVoxelsBottomUp) {
    EXPECT_EQ(codes(with({{9, 1}})), "voxel-count@" + std::to_string(kDag));
    EXPECT_THROW(
        {
            const TemporaryFolder folder;
            const auto bytes = with({{9, 1}});
            test::write_file(folder / "a", std::string(bytes.begin(), bytes.end()));
            (void)read_octv(folder / "a");
        },
        Error);
}

TEST(Validate, ReportsAtMostTheFirstHundred) {
    const Model model = built_courtyard(7);
    OctvParts parts(bytes_of(model));
    OctvParts::Part& dag = *parts.find(octv::kDagSection);
    const std::uint64_t leaves = 4 * model.dag.level_begin(model.dag.leaf_level());
    std::fill(dag.content.begin() + static_cast<std::ptrdiff_t>(leaves), dag.content.end(), '\0');
    const std::uint64_t first = dag.section.offset + leaves;
    const Validation found = validate(parts.sealed());
    ASSERT_EQ(found.findings.size(), 100u);
    EXPECT_EQ(found.findings.front().offset, first);
    EXPECT_EQ(found.findings.back().offset, first + std::uint64_t{99} * 8);
}

TEST(ValidateStrict, SeesEqualNodes) {
    EXPECT_EQ(codes(bytes_of(test::model_of(3, {0, 3, 7}, {0x03, 3, 5, 1, 0, 1, 0})), true),
              "node-duplicate@8212");
    EXPECT_EQ(codes(bytes_of(test::model_of(3, {0, 3, 7}, {0x03, 3, 5, 1, 0, 1, 0}))), "");
}

TEST(ValidateStrict, SeesNodesOutOfOrder) {
    EXPECT_EQ(codes(bytes_of(test::model_of(3, {0, 3, 7}, {0x03, 5, 3, 1, 0, 2, 0})), true),
              "node-order@8212");
}

TEST(ValidateStrict, SeesWhatNothingLeadsTo) {
    const Model leaf = test::model_of(4, {0, 3, 7, 11}, {0x03, 3, 5, 0x01, 7, 0x02, 7, 1, 0, 2, 0});
    EXPECT_EQ(codes(bytes_of(leaf), true), "node-unreachable@8228");
    EXPECT_EQ(codes(bytes_of(leaf)), "");
    // Below a node that nothing leads to, nothing is reached either.
    const Model node = test::model_of(
        5, {0, 3, 7, 11, 15}, {0x03, 3, 5, 0x01, 7, 0x02, 7, 0x01, 11, 0x01, 13, 1, 0, 2, 0});
    EXPECT_EQ(codes(bytes_of(node), true), "node-unreachable@8228 node-unreachable@8244");
}

TEST(ValidateStrict, SeesPaddingAndTrailingBytes) {
    std::vector<std::uint8_t> file = bytes_of(test::small_model());
    file[4000] = 1;
    EXPECT_EQ(codes(file, true), "padding@4000");
    EXPECT_EQ(codes(file), "");

    file = bytes_of(test::small_model());
    const std::uint64_t size = file.size() + 3;
    file.resize(size);
    std::memcpy(file.data() + offsetof(octv::FileHeader, file_bytes), &size, 8);
    fuzz::seal_directory(file);
    EXPECT_EQ(codes(file, true), "trailing-bytes@" + std::to_string(size - 3));
    EXPECT_EQ(codes(file), "");
}

TEST(Validate, NamesWhatIsWrongWithTheDirectory) {
    std::vector<std::uint8_t> file = bytes_of(test::small_model());
    file[0] = 'x';
    EXPECT_EQ(codes(file), "magic@0");
    file = bytes_of(test::small_model());
    file[8] = 9;
    EXPECT_EQ(codes(file), "version-newer@8");
    file = bytes_of(test::small_model());
    file[44] = 1;
    fuzz::seal_directory(file);
    EXPECT_EQ(codes(file), "header-reserved@40");
    file = bytes_of(test::small_model());
    file[100] ^= 1;
    EXPECT_EQ(codes(file), "table-checksum@32");
    file.pop_back();
    EXPECT_EQ(codes(file), "file-size@16");
    EXPECT_EQ(codes({}), "magic@0");
}

TEST(Validate, ReportsAWrongChecksumAndWhatItMayHaveHidden) {
    std::vector<std::uint8_t> file = bytes_of(test::small_model());
    file[8192 + 4] = 4;  // a pointer, unsealed
    EXPECT_EQ(codes(file), "section-checksum@8192 pointer-inside@8196");
}

TEST(Validate, ChecksSectionsThatItDoesNotKnow) {
    OctvParts parts(bytes_of(test::small_model()));
    parts.set(octv::section_id("ELSE"), 0, "whatever this is");
    std::vector<std::uint8_t> file = parts.sealed();
    EXPECT_EQ(codes(file, true), "");
    file.back() ^= 1;
    EXPECT_EQ(codes(file), "section-checksum@12288");
}

TEST(Validate, ComparesTheOctreeNodesOfEachLevel) {
    OctvParts parts(bytes_of(test::small_model()));
    std::string& json = parts.find(octv::kMetadataSection)->content;
    const std::string was = R"("svo_nodes":3,"dag_nodes":2)";
    ASSERT_NE(json.find(was), std::string::npos) << json;
    json.replace(json.find(was), was.size(), R"("svo_nodes":4,"dag_nodes":2)");
    EXPECT_EQ(codes(parts.sealed()), "octree-count@4096");
}

TEST(Validate, RefusesADagAboveTheBudgetWithoutTakingItsMemory) {
    OctvParts parts(bytes_of(test::small_model(), true));
    const TemporaryFolder folder;
    const auto bytes = parts.sealed();
    test::write_file(folder / "a", std::string(bytes.begin(), bytes.end()));
    const Validation found = validate_octv(folder / "a", {.max_dag_bytes = 40});
    ASSERT_EQ(found.findings.size(), 1u);
    EXPECT_EQ(found.findings[0].code, "limit");
}

TEST(Validate, AgreesWithTheReaderOnMutatedFiles) {
    std::vector<std::uint8_t> file = bytes_of(test::small_model());
    const auto keep = [](std::uint8_t*, std::size_t size, std::size_t) { return size; };
    const TemporaryFolder folder;
    std::set<std::string> seen;
    for (std::uint32_t seed = 1; seed <= 600; ++seed) {
        const auto mutated = fuzz::mutate_octv(file, seed, keep);
        test::write_file(folder / "a", std::string(mutated.begin(), mutated.end()));
        const Validation found = validate_octv(folder / "a");
        bool read = true;
        try {
            (void)read_octv(folder / "a");
        } catch (const Error& error) {
            read = false;
            ASSERT_FALSE(found.valid()) << seed << ": " << error.what();
        }
        for (const Finding& finding : found.findings) {
            seen.insert(finding.code);
            ASSERT_TRUE(!read || finding.code == "octree-count") << seed << ": " << finding.code;
        }
    }
    EXPECT_GT(seen.size(), 10u);
}

TEST(Validate, EveryCodeIsInTheTableOfTheFormat) {
    const std::filesystem::path source(OCTAVO_SOURCE_DIR);
    const std::string page = test::file_content(source / "docs" / "file-format.md");
    for (const char* file :
         {"check.cpp", "container.cpp", "node_starts.cpp", "read_cells.cpp", "read_octv.cpp",
          "section_source.cpp", "validate.cpp", "finding.cpp"}) {
        const std::string text = test::file_content(source / "src" / "octavo" / "io" / file);
        std::size_t codes_here = 0;
        // Every quoted word with a hyphen in it, and nothing else, is a code.
        for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos;) {
            const std::size_t end = text.find('"', at + 1);
            if (end == std::string::npos) break;
            const std::string word = text.substr(at + 1, end - at - 1);
            at = end + 1;
            if (word.find('-') == std::string::npos ||
                word.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") != std::string::npos ||
                word.front() == '-')
                continue;
            ++codes_here;
            EXPECT_NE(page.find("| `" + word + "` |"), std::string::npos) << word;
        }
        if (std::string(file) != "finding.cpp") {
            EXPECT_GT(codes_here, 0u) << file;
        }
    }
}

}  // namespace
}  // namespace octavo
