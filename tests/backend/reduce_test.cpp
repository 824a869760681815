// SPDX-License-Identifier: MIT
//
// The GPU's reduction, its steps run in a loop, against the CPU's.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <string>

#include "backend/test_devices.h"
#include "octavo/backend/cuda/reduce_steps.h"
#include "octavo/backend/device.h"
#include "octavo/construct/build.h"
#include "octavo/core/error.h"
#include "octavo/mesh/samples.h"

namespace octavo {
namespace {

/// Does in a loop what CUB does on a device.
class HostRunner {
public:
    /// @param hash_bits  of the hash that are kept: with few, different nodes have one hash
    explicit HostRunner(int hash_bits) : mask_(hash_bits == 64 ? ~0ull : (1ull << hash_bits) - 1) {}

    template <typename T>
    T* array(const char* use, std::uint32_t n) {
        std::vector<std::byte>& bytes = arrays_[use];
        bytes.assign(std::max<std::size_t>(n, 1) * sizeof(T), std::byte{0x7f});
        return reinterpret_cast<T*>(bytes.data());
    }
    template <typename Step>
    void for_each(std::uint32_t n, const Step& step) {
        for (std::uint32_t i = n; i-- > 0;) step(i);  // in another order than one may rely on
    }
    void sort(std::uint64_t* hashes, std::uint32_t* order, std::uint32_t n) {
        for (std::uint32_t i = 0; i < n; ++i) hashes[i] &= mask_;
        std::vector<std::uint64_t> keys(hashes, hashes + n);
        std::stable_sort(order, order + n, [&](auto a, auto b) { return keys[a] < keys[b]; });
        for (std::uint32_t k = 0; k < n; ++k) hashes[k] = keys[order[k]];
    }
    void running_maximum(std::uint32_t* values, std::uint32_t n) {
        std::inclusive_scan(values, values + n, values,
                            [](auto a, auto b) { return std::max(a, b); });
    }
    void sum_before(const std::uint32_t* in, std::uint32_t* out, std::uint32_t n) {
        std::exclusive_scan(in, in + n, out, 0u);
    }
    std::uint32_t value(const std::uint32_t* address) { return *address; }

private:
    std::uint64_t mask_;
    std::map<std::string, std::vector<std::byte>> arrays_;
};

void reduce_in_steps(NodeStore& store, const TileOctree& octree, int hash_bits) {
    std::vector<std::uint32_t> codes;
    std::vector<cuda::Candidate> nodes;
    for (const LeafBlock& leaf : blocks_of(octree, store.top())) {
        codes.push_back(leaf.code);
        nodes.push_back({{static_cast<std::uint32_t>(leaf.voxels),
                          static_cast<std::uint32_t>(leaf.voxels >> 32)}});
    }
    HostRunner runner(hash_bits);
    cuda::reduce_tile(runner, codes.data(), nodes.data(), static_cast<std::uint32_t>(codes.size()),
                      store.top(),
                      [&](int height, const std::uint32_t* words, std::uint32_t count) {
                          store.level(height).assign({words, count});
                      });
}

void expect_same(const std::vector<LeafBlock>& leaves, int top, int hash_bits) {
    NodeStore expected(top);
    ReduceScratch scratch;
    const TileOctree octree = octree_of(leaves, top);
    reduce_tile(expected, octree, scratch);
    NodeStore found(top);
    reduce_in_steps(found, octree, hash_bits);
    for (int height = 0; height <= top; ++height) {
        const auto a = expected.level(height).words();
        const auto b = found.level(height).words();
        ASSERT_TRUE(std::ranges::equal(a, b)) << "height " << height;
        ASSERT_EQ(expected.level(height).count(), found.level(height).count());
    }
}

TEST(ReduceOnGpu, StepsGiveTheNodesOfTheCpuInTheirOrder) {
    std::mt19937 random(3);
    for (const int top : {0, 1, 3, 6})
        for (const double density : {0.05, 0.5, 1.0})
            for (const std::uint64_t kinds : {1, 5, 1000}) {
                std::vector<LeafBlock> leaves;
                for (std::uint32_t code = 0; code < 1u << std::min(3 * top, 14); ++code)
                    if (code == 0 || std::uniform_real_distribution<>(0, 1)(random) < density)
                        leaves.push_back({0x0123456789abcdefull * (1 + random() % kinds), code});
                expect_same(leaves, top, 64);
            }
}

TEST(ReduceOnGpu, EqualHashesOfDifferentNodesDoNoHarm) {
    std::mt19937 random(4);
    std::vector<LeafBlock> leaves;
    for (std::uint32_t code = 0; code < 4096; code += 1 + static_cast<std::uint32_t>(random() % 3))
        leaves.push_back({1 + random() % 40, code});
    for (const int bits : {1, 3, 8}) expect_same(leaves, 4, bits);
}

TEST(ReduceOnGpu, BuildsTheSameBytes) {
    const Scene scene = make_sample("courtyard");
    const Dag expected = test::build_at(scene, 9).dag;
    BuildOptions options;
    options.depth = 9;
    options.tile = 64;
    options.reduce = [](NodeStore& store, const TileOctree& octree) {
        reduce_in_steps(store, octree, 64);
    };
    EXPECT_TRUE(std::ranges::equal(build(scene, options).dag.words(), expected.words()));
}

TEST(ReduceOnGpu, BuildsTheSameBytesOnTheDevice) {
    BuildOptions options;
    options.depth = 11;
    try {
        options.reduce = reducer_on("cuda");
    } catch (const Error& error) {
        GTEST_SKIP() << error.what();
    }
    const Scene scene = make_sample("courtyard");
    EXPECT_TRUE(std::ranges::equal(build(scene, options).dag.words(),
                                   test::build_at(scene, 11).dag.words()));
}

}  // namespace
}  // namespace octavo
