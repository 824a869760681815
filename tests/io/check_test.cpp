// SPDX-License-Identifier: MIT
#include "octavo/io/check.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/small_model.h"

namespace octavo {
namespace {

class FindFaults : public testing::Test {
protected:
    FindFaults() {
        const Dag dag = test::small_model().dag;
        begins.assign(dag.level_begins().begin(), dag.level_begins().end());
        words.assign(dag.words().begin(), dag.words().end());
    }

    /// The first fault's reason, or an empty text; `at` receives its word.
    std::string reason() {
        const auto faults = find_faults(begins, words, {.level_nodes = nodes, .voxels = voxels});
        if (faults.empty()) return {};
        at = faults.front().word;
        return faults.front().reason;
    }

    std::vector<std::uint64_t> begins;
    std::vector<std::uint32_t> words;
    std::vector<std::uint64_t> nodes;
    std::optional<std::uint64_t> voxels;
    std::uint64_t at = 0;
};

TEST_F(FindFaults, AcceptsASoundDag) {
    EXPECT_EQ(reason(), "");
    nodes = {1, 2, 2};
    EXPECT_EQ(reason(), "");
}

TEST_F(FindFaults, AcceptsADagWithoutVoxels) {
    words.clear();
    begins = {0, 0, 0, 0};
    EXPECT_EQ(reason(), "");
}

TEST_F(FindFaults, AcceptsASingleLeaf) {
    words = {0, 1};
    begins = {0, 2};
    EXPECT_EQ(reason(), "");
    words = {0, 1, 0, 1};
    begins = {0, 4};
    EXPECT_EQ(reason(), "level 0 is not a single node");
}

TEST_F(FindFaults, SeesANodeWithoutChildren) {
    words[6] = 0;
    EXPECT_EQ(reason(), "a node without children");
    EXPECT_EQ(at, 6u);
}

TEST_F(FindFaults, SeesSpareBits) {
    words[3] |= 0x100;
    EXPECT_EQ(reason(), "spare bits of a node are not zero");
    EXPECT_EQ(at, 3u);
}

TEST_F(FindFaults, SeesANodeThatReachesIntoTheNextLevel) {
    words[6] = 0xff;
    EXPECT_EQ(reason(), "a node reaches past the end of its level");
    EXPECT_EQ(at, 6u);
}

TEST_F(FindFaults, SeesAPointerIntoTheMiddleOfANode) {
    words[1] = 4;
    EXPECT_EQ(reason(), "pointer 4 leads into the middle of a node");
    EXPECT_EQ(at, 1u);
}

TEST_F(FindFaults, SeesAPointerIntoTheMiddleOfALeaf) {
    words[7] = 9;
    EXPECT_EQ(reason(), "pointer 9 leads into the middle of a node");
    EXPECT_EQ(at, 7u);
}

TEST_F(FindFaults, SeesPointersOutsideTheNextLevel) {
    for (const std::uint32_t pointer : {0u, 2u, 8u, 10u, 12u, 0xffffffffu}) {
        words[2] = pointer;
        EXPECT_EQ(reason(), "pointer " + std::to_string(pointer) + " leads outside the next level");
        EXPECT_EQ(at, 2u);
    }
}

TEST_F(FindFaults, SeesALeafWithoutVoxels) {
    words[8] = 0;
    EXPECT_EQ(reason(), "a leaf without voxels");
    EXPECT_EQ(at, 8u);
}

TEST_F(FindFaults, SeesTwoRoots) {
    words = {0x01, 4, 0x01, 4, 1, 0};
    begins = {0, 4, 6};
    EXPECT_EQ(reason(), "level 0 is not a single node");
}

TEST_F(FindFaults, SeesWrongNodeCounts) {
    nodes = {1, 3, 2};
    EXPECT_EQ(reason(), "level 1 has 2 nodes where 3 are stated");
    nodes = {1, 2, 1};
    EXPECT_EQ(reason(), "level 2 has 2 nodes where 1 are stated");
}

TEST_F(FindFaults, SeesLevelsThatDoNotCoverTheWords) {
    begins = {0, 3, 8, 11};
    EXPECT_NE(reason(), "");
    begins = {0, 3, 8, std::uint64_t{1} << 63};
    EXPECT_NE(reason(), "");
    begins = {0, 8, 3, 12};
    EXPECT_NE(reason(), "");
    begins = {1, 3, 8, 12};
    EXPECT_NE(reason(), "");
    begins = {12};
    EXPECT_NE(reason(), "");
    begins.assign(18, 0);
    EXPECT_NE(reason(), "");
}

}  // namespace
}  // namespace octavo
