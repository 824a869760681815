// SPDX-License-Identifier: MIT
#include "octavo/attributes/cell_index.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>

#include "octavo/attributes/loop_lookup.h"
#include "octavo/construct/build.h"
#include "octavo/mesh/samples.h"
#include "octavo/trace/dag_view.h"
#include "support/small_dags.h"

namespace octavo::shared {

struct CellView {
    const uint* sums = nullptr;
    int level = 0;
};
uint cell_sum(CellView cells, uint word) {
    return cells.sums[word];
}

}  // namespace octavo::shared

#include "octavo/attributes/cell_rank.h"

namespace octavo {
namespace {

/// The numbers of all cells, by asking for every voxel in Morton order.
std::map<std::uint64_t, std::uint64_t> numbers_by_voxels(const Dag& dag, int level) {
    std::map<std::uint64_t, std::uint64_t> numbers;
    const std::uint64_t voxels = std::uint64_t{1} << 3 * dag.depth();
    for (std::uint64_t code = 0; code < voxels; ++code)
        if (dag.voxel(morton_decode(code)))
            numbers.emplace(code >> 3 * (dag.depth() - level), numbers.size());
    return numbers;
}

std::vector<Dag> some_dags() {
    std::vector<Dag> dags;
    for (int depth = 2; depth <= 6; ++depth)
        for (std::uint32_t seed = 1; seed <= 3; ++seed) {
            dags.push_back(test::dust(depth, 0.3 * seed, seed));
        }
    dags.emplace_back();
    return dags;
}

TEST(CellIndex, NumbersAreRanksInMortonOrderAtEveryLevel) {
    for (const Dag& dag : some_dags())
        for (int level = 2; level <= dag.depth(); ++level) {
            const CellIndex index(dag, level);
            const auto expected = numbers_by_voxels(dag, level);
            ASSERT_EQ(index.count(), expected.size());
            const std::uint64_t cells = std::uint64_t{1} << 3 * level;
            for (std::uint64_t code = 0; code < cells; ++code) {
                const auto known = expected.find(code);
                const auto found = index.find(morton_decode(code));
                ASSERT_EQ(found.has_value(), known != expected.end());
                if (found) {
                    ASSERT_EQ(*found, known->second)
                        << "depth " << dag.depth() << " level " << level;
                }
            }
        }
}

TEST(CellIndex, CellIsTheInverseOfFind) {
    for (const Dag& dag : some_dags())
        for (int level = 2; level <= dag.depth(); ++level) {
            const CellIndex index(dag, level);
            for (std::uint64_t i = 0; i < index.count(); ++i)
                ASSERT_EQ(index.find(index.cell(i)), i);
        }
}

TEST(CellIndex, VisitsAnyRangeInOrder) {
    const Dag dag = test::dust(6, 0.5, 7);
    std::mt19937 random(5);
    for (int level = 2; level <= 6; ++level) {
        const CellIndex index(dag, level);
        for (int i = 0; i < 50; ++i) {
            const std::uint64_t begin = random() % (index.count() + 1);
            const std::uint64_t end = begin + random() % (index.count() - begin + 1);
            std::uint64_t next = begin;
            index.for_each({begin, end}, [&](std::uint64_t number, const uvec3& cell) {
                ASSERT_EQ(number, next++);
                ASSERT_EQ(index.find(cell), number);
            });
            ASSERT_EQ(next, end);
        }
    }
}

TEST(CellIndex, ACoarserCellHoldsTheRunOfItsCells) {
    const Dag dag = test::dust(5, 0.5, 3);
    for (int level = 2; level <= 5; ++level) {
        const CellIndex index(dag, level);
        for (int coarse = 0; coarse <= level; ++coarse) {
            std::uint64_t next = 0;
            for (std::uint64_t code = 0; code < std::uint64_t{1} << 3 * coarse; ++code) {
                const CellRange range = index.cells_in(morton_decode(code), coarse);
                if (range.empty()) continue;
                ASSERT_EQ(range.begin, next) << level << " " << coarse;
                next = range.end;
                index.for_each(range, [&](std::uint64_t, const uvec3& cell) {
                    ASSERT_EQ(morton_encode(cell) >> 3 * (level - coarse), code);
                });
            }
            ASSERT_EQ(next, index.count());
        }
    }
}

TEST(CellIndex, AgreesWithTheLoopOfThePost) {
    for (const Dag& dag : some_dags()) {
        if (dag.depth() > 5) continue;
        for (int level = 2; level <= dag.depth(); ++level) {
            const CellIndex index(dag, level);
            for (std::uint64_t code = 0; code < std::uint64_t{1} << 3 * level; code += 3) {
                const uvec3 cell = morton_decode(code);
                ASSERT_EQ(index.find(cell), find_cell_by_loop(dag, level, cell));
            }
        }
    }
}

TEST(CellIndex, TheSharedTextFindsTheSameNumbers) {
    for (const Dag& dag : some_dags())
        for (int level = 2; level <= dag.depth(); ++level) {
            const CellIndex index(dag, level);
            const shared::CellView view{index.sums().data(), level};
            for (std::uint64_t code = 0; code < std::uint64_t{1} << 3 * level; ++code) {
                const uvec3 cell = morton_decode(code);
                const auto found = index.find(cell);
                const std::uint32_t rank = shared::cell_rank(shared::view(dag), view, cell);
                ASSERT_EQ(rank, found ? *found : shared::kNoCell);
            }
        }
}

TEST(CellIndex, NothingOutsideTheGrid) {
    const CellIndex index(test::dust(4, 1.0, 1), 3);
    EXPECT_FALSE(index.find({8, 0, 0}));
    EXPECT_FALSE(index.find({0, 0, 0xffffffffu}));
}

TEST(CellIndex, CountsPast32BitsByVisitingNodes) {
    // A full grid of 131072^3: 2^51 voxels behind 137 words.
    const Dag dag = test::full_grid(17);
    const CellIndex index(dag, 17);
    EXPECT_EQ(index.count(), std::uint64_t{1} << 51);
    EXPECT_FALSE(index.fits_32_bits());
    std::mt19937_64 random(1);
    for (int i = 0; i < 1000; ++i) {
        const std::uint64_t number = random() >> 13;
        EXPECT_EQ(index.cell(number), morton_decode(number));
        EXPECT_EQ(index.find(morton_decode(number)), number);
    }
}

TEST(CellIndex, RefusesLevelsThatTheDagDoesNotHave) {
    const Dag dag = test::dust(5, 0.5, 1);
    EXPECT_THROW(CellIndex(dag, 1), Error);
    EXPECT_THROW(CellIndex(dag, 6), Error);
}

}  // namespace
}  // namespace octavo
