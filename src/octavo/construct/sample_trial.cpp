// SPDX-License-Identifier: MIT
#include "octavo/construct/sample_trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "octavo/construct/build_plan.h"
#include "octavo/construct/reduce.h"
#include "octavo/construct/scratch.h"
#include "octavo/construct/tile_pipeline.h"
#include "octavo/core/error.h"
#include "octavo/core/morton.h"
#include "octavo/core/parallel.h"

namespace octavo {
namespace {

// Of the tiles one in 4^3 is built; of grids below 4096^3, which have few tiles, more.
constexpr int kMostRarity = 3;
constexpr int kWholeDepth = 9;  // up to here all

// Four times as many tiles are taken where chance decides more than this, as where a few tiles have
// nearly all of the nodes, and the ones that were taken had no more of anything.
constexpr double kGoodError = 0.15;
constexpr std::uint64_t kCheapVoxels = 10'000'000;
constexpr double kCheapTriangles = 125'000;

// Under a cap the triangles of the sample may take an eighth of it, and its nodes a quarter.
constexpr std::uint64_t kCapPerSample = 8, kCapPerNodes = 4;
constexpr int kMostRarityUnderCap = 5;

// Small tiles, so that there are many.
constexpr int kTileDepth = 5, kMaxTileDepth = 7;
constexpr int kTilesDepth = 7;

// To sort it, of one core.
constexpr double kMostSecondsPerTriangle = 0.3e-6;

/// The folder in a build's scratch folder that its forecast has for triangles, or none, that is
/// gone afterwards, come what may. What a forecast that is killed leaves there goes with the
/// build's own, whichever build ends next.
class PassingScratch {
public:
    /// @param of_build  its scratch folder, or none
    PassingScratch(std::filesystem::path of_build, const BuildPlan& plan)
        : of_build_(std::move(of_build)),
          folder_(of_build_.empty() ? of_build_
                                    : of_build_ / (kEstimatePrefix + std::string("triangles"))),
          scratch_(folder_, plan.key, plan.tile_depth - 2) {
        if (of_build_.empty()) return;
        std::error_code error;
        std::filesystem::create_directory(of_build_, error);
        if (error) throw Error(Errc::io, of_build_, "cannot make this folder: " + error.message());
    }
    ~PassingScratch() {
        scratch_.remove();
        if (of_build_.empty()) return;
        delete_scratch(folder_);  // as an earlier one, killed, left it
        std::error_code ignored;
        std::filesystem::remove(of_build_, ignored);  // unless there is something else in it
    }
    PassingScratch(const PassingScratch&) = delete;
    PassingScratch& operator=(const PassingScratch&) = delete;

    [[nodiscard]] Scratch& operator*() { return scratch_; }

private:
    std::filesystem::path of_build_, folder_;
    Scratch scratch_;
};

/// Those of the sample, which becomes smaller where they would take too much of a cap.
Scene sampled_triangles(const Scene& scene, const BuildOptions& options, const Grid& grid,
                        int tile_depth, TileSample& sample) {
    const std::uint64_t most = options.max_memory_bytes / kCapPerSample;
    std::vector<std::size_t> chosen = triangles_in_sample(scene, grid, tile_depth, sample);
    while (most != 0 && sample.rarity < kMostRarityUnderCap &&
           kBareTriangleBytes * chosen.size() > most) {
        ++sample.rarity;
        chosen = triangles_in_sample(scene, grid, tile_depth, sample);
    }
    return bare_scene(scene, chosen);
}

/// Thrown where a sample's nodes have no room.
struct SampleTooLarge {};

/// @param most_bytes  that the nodes may take; 0: any number. @throws SampleTooLarge
void build_tiles(const VoxelSource& source, const BuildOptions& options, int depth,
                 std::uint64_t most_bytes, SampleTrial& trial) {
    SampledTiles tiles(source, trial.sample);
    std::vector<std::size_t> all(tiles.tiles().size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const int top = source.tile_depth() - 2;
    SampledNodes nodes(trial.sample.rarity == 0 ? depth - 2 : top);
    std::vector<CellNode> roots;
    run_tiles(tiles, all, options.max_memory_bytes != 0, options.reduce, [&](const TilePart& tile) {
        report(options.progress, {"estimate", 0, 0, 0});
        if (tile.empty) return;
        const std::uint64_t code = tiles.tiles()[tile.index];
        const std::uint64_t known = nodes.count();
        const std::uint32_t root =
            nodes.merge(tile.store, trial.sample.piece_of(morton_decode(code)));
        if (trial.sample.rarity == 0) roots.push_back({static_cast<std::uint32_t>(code), root});
        trial.counts.add(tile.counts);
        const auto voxels = static_cast<double>(tile.counts.voxels);
        const auto new_nodes = static_cast<double>(nodes.count() - known);
        trial.sums.tiles += 1.0;
        trial.sums.square_voxels += voxels * voxels;
        trial.sums.nodes += new_nodes;
        trial.sums.square_nodes += new_nodes * new_nodes;
        if (most_bytes != 0 && nodes.memory_bytes() > most_bytes) throw SampleTooLarge{};
    });
    for (int h = 0; h <= top; ++h) {
        const UniqueNodes& level = nodes.store().level(h);
        trial.levels.push_back(
            {nodes.growth_curve(h), level.count() == 0
                                        ? 0.0
                                        : 4.0 * static_cast<double>(level.words().size()) /
                                              static_cast<double>(level.count())});
    }
    if (trial.sample.rarity != 0) return;
    reduce_upwards(nodes.store(), source.tile_depth() - 1, roots, trial.counts);
    std::vector<std::uint64_t> level_words, level_nodes;
    for (int h = depth - 2; h >= 0; --h) {
        level_words.push_back(nodes.store().level(h).words().size());
        level_nodes.push_back(nodes.store().level(h).count());
    }
    trial.whole = statistics_of(depth, trial.counts, level_begins(level_words), level_nodes);
}

/// @param disposable  the triangles, if they may be given up once they are sorted; or null
SampleTrial build_sample(const Scene& triangles, Scene* disposable, const BuildOptions& options,
                         const Grid& grid, int tile_depth, TileSample sample) {
    SampleTrial trial{.sample = sample, .tile_depth = tile_depth};
    if (triangles.triangles.empty()) return trial;
    BuildOptions part;
    part.grid = grid;
    part.rule = options.rule;
    part.threads = options.threads;
    part.reduce = options.reduce;
    part.tile = 1u << tile_depth;
    // Not the cap itself: one that cannot be kept is to be found here and not to stop us.
    if (options.max_memory_bytes != 0 && !options.scratch.empty()) {
        part.scratch = options.scratch;
        part.spill.triangle_bytes = options.max_memory_bytes / kCapPerSample + 1;
    }
    part.progress = [&](const Progress&) {
        // Only to let the caller stop: these tiles are not progress of theirs.
        return !options.progress || options.progress({"estimate", 0, 0, 0});
    };
    with_threads(options.threads, [&] {
        const auto start = std::chrono::steady_clock::now();
        const BuildPlan plan = plan_build(triangles, part);
        PassingScratch for_triangles(part.scratch, plan);
        const auto count = static_cast<double>(triangles.triangles.size());
        const SortedTriangles sorted =
            sort_triangles(triangles, disposable, plan, part, *for_triangles);
        const auto is_sorted = std::chrono::steady_clock::now();
        const double sort_seconds = std::chrono::duration<double>(is_sorted - start).count();
        for (;; ++sample.rarity) {
            trial = {.sample = sample,
                     .tile_depth = tile_depth,
                     .sort_seconds = sort_seconds,
                     .triangles = count};
            const auto tiles_start = std::chrono::steady_clock::now();
            const bool last = sample.rarity >= kMostRarityUnderCap;
            try {
                build_tiles(*sorted.source, part, grid.depth,
                            last ? 0 : options.max_memory_bytes / kCapPerNodes, trial);
            } catch (const SampleTooLarge&) {
                continue;
            }
            trial.tile_seconds =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - tiles_start)
                    .count();
            break;
        }
    });
    return trial;
}

}  // namespace

double SampleTrial::error_of(double sum, double squares) const {
    if (sample.rarity == 0) return 0.0;
    if (sum <= 0.0) return 1.0;  // all there is may be in other tiles
    return 3.0 * std::sqrt((1.0 - std::pow(0.25, sample.rarity)) * squares) / sum;
}

double SampleTrial::seconds(double all_triangles) const {
    // A few triangles take the time of what is done once.
    const double more = all_triangles - triangles;
    return std::min(sort_seconds * all_triangles / std::max(triangles, 1.0),
                    sort_seconds + more * kMostSecondsPerTriangle) +
           tile_seconds * std::pow(4.0, sample.rarity);
}

SampleTrial try_sample(const Scene& scene, const BuildOptions& options, const Grid& grid) {
    const int tile_depth =
        std::min(grid.depth, std::clamp(grid.depth - kTilesDepth, kTileDepth, kMaxTileDepth));
    TileSample sample{std::clamp(grid.depth - kWholeDepth, 0, kMostRarity)};
    for (;; --sample.rarity) {
        if (sample.rarity == 0)
            return build_sample(scene, nullptr, options, grid, tile_depth, sample);
        Scene triangles;
        with_threads(options.threads, [&] {
            triangles = sampled_triangles(scene, options, grid, tile_depth, sample);
        });
        SampleTrial trial = build_sample(triangles, &triangles, options, grid, tile_depth, sample);
        const double share =
            static_cast<double>(scene.triangles.size()) * std::pow(0.25, trial.sample.rarity);
        trial.missing = std::max(0.0, 1.0 - trial.triangles / std::max(share, 1.0));
        if (trial.node_error() <= kGoodError || trial.counts.voxels > kCheapVoxels ||
            trial.triangles > kCheapTriangles || options.max_memory_bytes != 0)
            return trial;
    }
}

}  // namespace octavo
