// SPDX-License-Identifier: MIT
#include "octavo/construct/estimate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "octavo/construct/build_plan.h"
#include "octavo/construct/construct.h"
#include "octavo/construct/sampled_tiles.h"
#include "octavo/construct/scratch.h"
#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"

namespace octavo {
namespace {

// Of the tiles one in 4^3 is built, and of these one in four once more to see how the DAG grows
// with what is in it; of grids below 4096^3, which have few tiles, more.
constexpr int kMostRarity = 3;
constexpr int kWholeDepth = 9;  // up to here all

// Under a cap the triangles of the sample may take an eighth of it.
constexpr std::uint64_t kCapPerSample = 8;
constexpr int kMostRarityUnderCap = 5;

// Small tiles, so that there are many.
constexpr int kTileDepth = 5, kMaxTileDepth = 7;
constexpr int kTilesDepth = 7;

// While it grows, the store holds the DAG and tables of 6 to 13 bytes for nodes of about 20.
constexpr double kStoreBytesPerDagByte = 1.6;
constexpr std::uint64_t kBytesPerThread = 16 << 20;  // tiles in flight

// Where everything spills: the program itself and its buffers, tiles in flight, and in the merge an
// id for each node of the largest level, of which there is one for 8 to 20 bytes of the level.
constexpr std::uint64_t kLeastBytes = 40 << 20;
constexpr std::uint64_t kLeastBytesPerThread = 8 << 20;
constexpr double kMergeBytesPerDagByte = 0.1;

// Parts hold a node more than once, the merged part and the finished words once each.
constexpr double kScratchBytesPerDagByte = 3.5;

// A cell's attributes, in blocks with palettes: textured surfaces take most for colour, normals of
// curved ones for these.
constexpr double kColorBytes = 3.1, kRoughColorBytes = 1.2, kNormalBytes = 1.5;
constexpr double kEmissionBytes = 0.3, kBackPart = 0.1;
constexpr double kSecondsPerCell = 0.25e-6;  // of one core

// Where attributes spill: tiles in flight, and 4 bytes for each block of each channel.
constexpr std::uint64_t kLeastForAttributes = 8 << 20;
constexpr std::uint64_t kLeastForAttributesPerThread = 10 << 20;
constexpr double kTableBytesPerCell = 6 * 4.0 / CellValues::kBlockCells;

// Under the cap that is advised the forecast is made again, with another sample: Sponza with
// attributes was refused under 66M, which was advised, for want of 2 MiB.
constexpr double kAdvisedPart = 1.0625;

/// What building a sample took.
struct Trial {
    double sort_seconds = 0.0;
    double tile_seconds = 0.0;
    double dag_bytes = 1.0;
    double quarter_bytes = 1.0;  // of a DAG of a quarter of the sample, on average
    double triangles = 0.0;      // sorted
    Statistics statistics;
    std::vector<double> quarter_nodes;  // of each level, likewise
};

/// A scratch folder in that of the build, or none, that is gone afterwards, come what may. What a
/// forecast that is killed leaves there goes with the build's own, whichever build ends next.
class PassingScratch {
public:
    /// @param of_build  its scratch folder, or none
    PassingScratch(std::filesystem::path of_build, const char* what, const BuildPlan& plan)
        : of_build_(std::move(of_build)),
          folder_(of_build_.empty() ? of_build_
                                    : of_build_ / (kEstimatePrefix + std::string(what))),
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

/// @param disposable  the triangles, if they may be given up once they are sorted; or null
Trial try_sample(const Scene& triangles, Scene* disposable, const BuildOptions& options,
                 const Grid& grid, int tile_depth, const TileSample& sample) {
    if (triangles.triangles.empty()) return {};
    BuildOptions part;
    part.grid = grid;
    part.rule = options.rule;
    part.threads = options.threads;
    part.tile = 1u << tile_depth;
    // Not the cap itself: one that cannot be kept is to be found here and not to stop us.
    if (options.max_memory_bytes != 0 && !options.scratch.empty()) {
        part.scratch = options.scratch;
        part.spill = {options.max_memory_bytes / 4 + 1, options.max_memory_bytes / 8 + 1};
    }
    part.progress = [&](const Progress&) {
        // Only to let the caller stop: these tiles are not progress of theirs.
        return !options.progress || options.progress({"estimate", 0, 0, 0});
    };
    Trial trial;
    trial.triangles = static_cast<double>(triangles.triangles.size());
    with_threads(options.threads, [&] {
        const auto start = std::chrono::steady_clock::now();
        const BuildPlan plan = plan_build(triangles, part);
        PassingScratch for_triangles(part.scratch, "triangles", plan);
        const SortedTriangles sorted =
            sort_triangles(triangles, disposable, plan, part, *for_triangles);
        const auto is_sorted = std::chrono::steady_clock::now();
        const auto build_part = [&](const TileSample& of, const char* what) {
            PassingScratch scratch(part.scratch, what, plan);
            SampledTiles tiles(*sorted.source, of);  // the source itself forgets nothing
            return construct(tiles, grid.depth,
                             {.max_store_bytes = part.spill.node_bytes,
                              .expected_nodes = {},
                              .reduce = {},
                              .progress = part.progress,
                              .journal_interval = std::chrono::hours(24 * 365)},
                             *scratch);
        };
        const auto bytes = [](const Constructed& built) {
            return static_cast<double>(built.dag.size_bytes());
        };
        {
            const Constructed whole = build_part(sample, "whole");
            trial.dag_bytes = std::max(1.0, bytes(whole));
            trial.statistics = whole.statistics;
        }
        const auto end = std::chrono::steady_clock::now();
        trial.sort_seconds = std::chrono::duration<double>(is_sorted - start).count();
        trial.tile_seconds = std::chrono::duration<double>(end - is_sorted).count();
        double of_quarters = 0.0;
        trial.quarter_nodes.resize(trial.statistics.levels.size());
        const char* const quarters[4] = {"0", "1", "2", "3"};
        for (std::uint64_t i = 0; i < 4; ++i) {
            const Constructed quarter = build_part(sample.quarter(i), quarters[i]);
            of_quarters += bytes(quarter);
            for (std::size_t l = 0; l < quarter.statistics.levels.size(); ++l)
                trial.quarter_nodes[l] +=
                    static_cast<double>(quarter.statistics.levels[l].dag_nodes) / 4.0;
        }
        trial.quarter_bytes = std::max(1.0, of_quarters / 4.0);
    });
    return trial;
}

/// Of this level in the whole grid.
double count_cells(const Trial& trial, const TileSample& sample, int depth, int tile_depth,
                   int level) {
    if (trial.statistics.levels.empty()) return 0.0;
    // A sample's tiles tell nothing of cells larger than they are.
    const int told = std::max(level, depth - tile_depth);
    const double cells = static_cast<double>(
        told == depth ? trial.statistics.voxels
                      : trial.statistics.levels[static_cast<unsigned>(told)].svo_nodes);
    return cells * std::pow(4.0, sample.rarity - (told - level));
}

/// As much again three times, as at twice the resolution: never more than four times the nodes.
double growth_of(double whole, double quarter) {
    return std::clamp(whole / std::max(quarter, 1.0), 1.0, 4.0);
}

/// Of the DAG of the whole grid.
std::vector<std::uint64_t> level_nodes(const Trial& trial, const TileSample& sample, int depth,
                                       int tile_depth) {
    std::vector<std::uint64_t> nodes(static_cast<unsigned>(depth - 1));
    // Above its tiles a sample tells nothing, and there is little.
    for (auto l = static_cast<std::size_t>(depth - tile_depth);
         l < nodes.size() && l < trial.statistics.levels.size(); ++l) {
        const auto whole = static_cast<double>(trial.statistics.levels[l].dag_nodes);
        nodes[l] = static_cast<std::uint64_t>(
            whole * std::pow(growth_of(whole, trial.quarter_nodes[l]), sample.rarity));
    }
    return nodes;
}

double attribute_bytes_per_cell(const AttributeOptions& wanted, const Scene& scene) {
    const bool shines = std::ranges::any_of(scene.materials, [](const Material& m) {
        return m.emission.x + m.emission.y + m.emission.z > 0.0f;
    });
    double bytes = 0.0;
    if (wanted.color) bytes += wanted.tolerance > 0 ? kRoughColorBytes : kColorBytes;
    if (wanted.normal) bytes += kNormalBytes;
    if (wanted.emission && shines) bytes += kEmissionBytes;
    return bytes * (1.0 + kBackPart);
}

std::uint64_t store_bytes(double dag_bytes) {
    return static_cast<std::uint64_t>(kStoreBytesPerDagByte * dag_bytes);
}

std::string megabytes(double bytes) {
    return std::to_string(static_cast<std::uint64_t>(std::ceil(bytes / (1 << 20)))) + " MiB";
}

}  // namespace

Estimate estimate_build(const Scene& scene, const BuildOptions& options,
                        const AttributeOptions* attributes) {
    const std::uint64_t import_peak = peak_resident_bytes();
    Estimate estimate;
    estimate.depth = options.grid ? options.grid->depth : options.depth;
    const Grid grid = options.grid ? *options.grid : smallest_cube(scene.bounds(), estimate.depth);
    const int tile_depth = std::min(
        estimate.depth, std::clamp(estimate.depth - kTilesDepth, kTileDepth, kMaxTileDepth));
    TileSample sample{std::clamp(estimate.depth - kWholeDepth, 0, kMostRarity)};
    Scene triangles;
    if (sample.rarity != 0)
        with_threads(options.threads, [&] {
            triangles = sampled_triangles(scene, options, grid, tile_depth, sample);
        });
    const Trial trial = sample.rarity == 0
                            ? try_sample(scene, nullptr, options, grid, tile_depth, sample)
                            : try_sample(triangles, &triangles, options, grid, tile_depth, sample);
    triangles = {};
    double cells = 0.0;
    if (attributes != nullptr) {
        const int level = attributes->level != 0 ? attributes->level
                                                 : AttributeOptions::usual_level(estimate.depth);
        cells = count_cells(trial, sample, estimate.depth, tile_depth, level);
        estimate.attribute_bytes =
            static_cast<std::uint64_t>(cells * attribute_bytes_per_cell(*attributes, scene));
    }
    trim_memory();

    estimate.growth = growth_of(trial.dag_bytes, trial.quarter_bytes);
    estimate.level_nodes = level_nodes(trial, sample, estimate.depth, tile_depth);
    const double dag_bytes = trial.dag_bytes * std::pow(estimate.growth, sample.rarity);
    estimate.dag_bytes = static_cast<std::uint64_t>(dag_bytes);
    const auto all = static_cast<double>(scene.triangles.size());
    estimate.seconds = trial.sort_seconds * all / std::max(trial.triangles, 1.0) +
                       trial.tile_seconds * std::pow(4.0, sample.rarity);

    const auto threads =
        static_cast<std::uint64_t>(options.threads > 0 ? options.threads : available_threads());
    const std::uint64_t triangles_in_tiles =
        16 * scene.positions.size() + 24 * scene.triangles.size();
    const std::uint64_t held = resident_bytes();
    estimate.peak_bytes =
        std::max(peak_resident_bytes(),
                 held + triangles_in_tiles + threads * kBytesPerThread + store_bytes(dag_bytes));
    estimate.least_bytes =
        std::max({import_peak, held + (std::uint64_t{8} << 20),
                  kLeastBytes + threads * kLeastBytesPerThread +
                      static_cast<std::uint64_t>(kMergeBytesPerDagByte * dag_bytes)});
    estimate.scratch_bytes = static_cast<std::uint64_t>(kScratchBytesPerDagByte * dag_bytes) +
                             120 * scene.triangles.size();
    if (attributes != nullptr) {
        estimate.seconds += cells * kSecondsPerCell / static_cast<double>(threads);
        // All channels, and the largest of them once more; the DAG is in memory beside them.
        estimate.peak_bytes =
            std::max(estimate.peak_bytes,
                     held + triangles_in_tiles + estimate.dag_bytes + 2 * estimate.attribute_bytes);
        estimate.least_bytes =
            std::max(estimate.least_bytes,
                     held + kLeastForAttributes + threads * kLeastForAttributesPerThread +
                         static_cast<std::uint64_t>(kTableBytesPerCell * cells));
        estimate.scratch_bytes += estimate.attribute_bytes + 100 * scene.triangles.size();
    }
    return estimate;
}

void require_memory(const Estimate& estimate, std::uint64_t max_memory_bytes) {
    const auto cap = static_cast<double>(max_memory_bytes);
    const auto least = static_cast<double>(estimate.least_bytes);
    if (max_memory_bytes == 0 || least <= cap) return;

    double dag_bytes = static_cast<double>(estimate.dag_bytes);
    const double without_dag = least - kMergeBytesPerDagByte * dag_bytes;
    const double advised = kAdvisedPart * least / (1 << 20);
    std::string advice = "--max-memory " +
                         std::to_string(static_cast<std::uint64_t>(std::ceil(advised))) +
                         "M would do";
    for (int depth = estimate.depth - 1; depth >= kMinDepth; --depth) {
        dag_bytes /= std::max(estimate.growth, 1.5);
        if (without_dag + kMergeBytesPerDagByte * dag_bytes > cap) continue;
        advice += ", or a resolution of " + std::to_string(1 << depth);
        break;
    }
    throw Error(Errc::limit, "this build takes at least " + megabytes(least) + " of memory, and " +
                                 megabytes(cap) + " are allowed; " + advice);
}

}  // namespace octavo
