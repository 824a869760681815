// SPDX-License-Identifier: MIT
//
// Question: what does each part of a build cost, on one thread? The overlap kernel (voxelize), the
// node store by tiles (reduce) and by sorting ([K13]), the merge of tiles and the freezing.
// Rates are of SVO leaves (4x4x4 blocks), the same number for every part of one scene.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "octavo/construct/node_store.h"
#include "octavo/construct/reduce.h"
#include "octavo/core/parallel.h"
#include "octavo/mesh/samples.h"
#include "octavo/voxelize/triangle_source.h"
#include "sort_levels.h"

namespace {

using namespace octavo;

constexpr int kDepth = 11;
constexpr int kTileDepth = 8;
constexpr int kTileTop = kTileDepth - 2;  // height of a tile's root

/// A scene cut into tiles, voxelized and reduced: the input of every part.
struct Prepared {
    Scene scene;
    TriangleSource source;
    std::vector<TileOctree> octrees;
    std::vector<NodeStore> parts;
    std::vector<std::uint32_t> codes;  // where each part is, in tiles
    std::uint64_t leaf_count = 0;

    explicit Prepared(Scene of)
        : scene(std::move(of)),
          source(scene, smallest_cube(scene.bounds(), kDepth), VoxelRule::conservative,
                 kTileDepth) {
        ReduceScratch scratch;
        for (std::size_t i = 0; i < source.tiles().size(); ++i) {
            TileOctree octree;
            source.voxelize(i, octree);
            if (octree.empty()) continue;
            leaf_count += octree.leaves.size();
            parts.emplace_back(kTileTop);
            reduce_tile(parts.back(), octree, scratch);
            octrees.push_back(std::move(octree));
            codes.push_back(static_cast<std::uint32_t>(source.tiles()[i]));
        }
    }
};

const Prepared& prepared(const std::string& scene) {
    static const Prepared courtyard(make_sample("courtyard"));
    static const Prepared hairball(make_sample("hairball", 0.1));
    static const Prepared scan(make_sample("scan", 0.1));
    return scene == "courtyard" ? courtyard : scene == "hairball" ? hairball : scan;
}

void set_rate(benchmark::State& state, const Prepared& scene) {
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(scene.leaf_count));
}

void voxelize(benchmark::State& state, const std::string& name) {
    const Prepared& scene = prepared(name);
    TileOctree octree;
    for ([[maybe_unused]] auto iteration : state)
        for (std::size_t i = 0; i < scene.source.tiles().size(); ++i) {
            scene.source.voxelize(i, octree);
            benchmark::DoNotOptimize(octree.leaves.data());
        }
    set_rate(state, scene);
}

void reduce_tiles(benchmark::State& state, const std::string& name) {
    const Prepared& scene = prepared(name);
    NodeStore part(kTileTop);
    ReduceScratch scratch;
    for ([[maybe_unused]] auto iteration : state)
        for (const TileOctree& octree : scene.octrees) {
            part.clear();
            reduce_tile(part, octree, scratch);
            benchmark::DoNotOptimize(scratch.nodes.data());
        }
    set_rate(state, scene);
}

void reduce_tiles_by_sorting(benchmark::State& state, const std::string& name) {
    const Prepared& scene = prepared(name);
    std::vector<std::vector<LeafBlock>> tiles;
    for (const TileOctree& octree : scene.octrees) tiles.push_back(blocks_of(octree, kTileTop));
    for ([[maybe_unused]] auto iteration : state)
        for (const std::vector<LeafBlock>& blocks : tiles)
            benchmark::DoNotOptimize(bench::reduce_by_sorting(blocks, kTileDepth));
    set_rate(state, scene);
}

/// A store of the whole scene, as deep as its tiles.
NodeStore merge_all(const Prepared& scene, std::vector<CellNode>& roots) {
    NodeStore store(kDepth - 2);
    for (std::size_t i = 0; i < scene.parts.size(); ++i)
        roots.push_back({scene.codes[i], store.merge_root(scene.parts[i])});
    return store;
}

void merge(benchmark::State& state, const std::string& name) {
    const Prepared& scene = prepared(name);
    for ([[maybe_unused]] auto iteration : state) {
        std::vector<CellNode> roots;
        const NodeStore store = merge_all(scene, roots);
        benchmark::DoNotOptimize(store.level(0).count());
    }
    set_rate(state, scene);
}

void freeze(benchmark::State& state, const std::string& name) {
    const Prepared& scene = prepared(name);
    for ([[maybe_unused]] auto iteration : state) {
        state.PauseTiming();
        std::vector<CellNode> cells;
        NodeStore store = merge_all(scene, cells);
        for (int height = kTileTop + 1; height <= store.top(); ++height)
            reduce_level(store, height, cells);
        state.ResumeTiming();
        benchmark::DoNotOptimize(std::move(store).freeze(kDepth).words().data());
    }
    set_rate(state, scene);
}

void register_all() {
    for (const std::string scene : {"courtyard", "hairball", "scan"}) {
        const auto add = [&](const char* part,
                             void (*function)(benchmark::State&, const std::string&)) {
            benchmark::RegisterBenchmark((std::string(part) + "/" + scene).c_str(), function, scene)
                ->Unit(benchmark::kMillisecond);
        };
        add("voxelize", voxelize);
        add("reduce", reduce_tiles);
        add("reduce_by_sorting", reduce_tiles_by_sorting);
        add("merge", merge);
        add("freeze", freeze);
    }
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    octavo::with_threads(1, [] {
        register_all();
        benchmark::RunSpecifiedBenchmarks();
    });
}
