// SPDX-License-Identifier: MIT
#include "octavo/construct/estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "octavo/construct/sample_trial.h"
#include "octavo/construct/word_limits.h"
#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"

namespace octavo {
namespace {

// While it grows, the store holds the DAG's words and tables, which just after one has grown take a
// bucket of 64 bytes for 4.5 nodes.
constexpr std::uint64_t kTableBytesPerNode = 15;
constexpr std::uint64_t kBytesPerThread = 16 << 20;  // tiles in flight

// Where everything spills: the program itself and its buffers, tiles in flight, and in the merge an
// id for each node of the largest level, of which there is one for 8 to 20 bytes of the level.
constexpr std::uint64_t kLeastBytes = 40 << 20;
constexpr std::uint64_t kLeastBytesPerThread = 8 << 20;
constexpr double kMergeBytesPerDagByte = 0.1;

// Parts hold a node more than once, the merged part and the finished words once each.
constexpr double kScratchBytesPerDagByte = 3.5;

// A curve that bends is carried on between two ways: as if it bent no more, and twice as much
// more with each step as in the sample; most likely once as much.
constexpr double kLikelyBend = 1.0, kMostBend = 2.0;
constexpr double kModelError = 0.05;       // of what is carried on so
constexpr double kBytesPerNodeAbove = 20;  // tiles: a mask and some four children

// A cell's attributes, in blocks with palettes: textured surfaces take most for colour, normals of
// curved ones for these.
constexpr double kColorBytes = 3.1, kRoughColorBytes = 1.2, kNormalBytes = 1.5;
constexpr double kEmissionBytes = 0.3, kBackPart = 0.1;
constexpr double kSecondsPerCell = 0.25e-6;  // of one core

// Where attributes spill: tiles in flight, and 4 bytes for each block of each channel.
constexpr std::uint64_t kLeastForAttributes = 8 << 20;
constexpr std::uint64_t kLeastForAttributesPerThread = 10 << 20;
constexpr double kTableBytesPerCell = 6 * 4.0 / CellValues::kBlockCells;

constexpr double kMostDagBytes = double{sizeof(std::uint32_t)} * WordLimits{}.of_dag;

// Under the cap that is advised the forecast is made again, with another sample: Sponza with
// attributes was refused under 66M, which was advised, for want of 2 MiB.
constexpr double kAdvisedPart = 1.0625;

/// Of this level in the whole grid.
double count_cells(const SampleTrial& trial, int depth, int level) {
    // A sample's tiles tell nothing of cells larger than they are.
    const int told = std::max(level, depth - trial.tile_depth);
    OctreeCounts counts = trial.counts;
    const auto cells =
        static_cast<double>(told == depth ? counts.voxels : counts.at_height(depth - 2 - told));
    return cells * std::pow(4.0, trial.sample.rarity - (told - level));
}

/// How many nodes four times as much of a scene has, and so on: what the curve says of the last
/// step from a quarter of the sample to all of it, and of how that differs from the step before.
/// @param bend  how much of that difference each further step has on top
double carried_on(const std::array<double, SampledNodes::kPieces>& curve, int steps, double bend) {
    if (curve[0] <= 0.0) return curve[15];
    const double before = std::log2(curve[3] / curve[0]), last = std::log2(curve[15] / curve[3]);
    double doublings = 0.0;  // a step has two of them at most, where nothing comes again
    for (int step = 1; step <= steps; ++step)
        doublings += std::clamp(last + bend * step * std::min(0.0, last - before), 0.0, 2.0);
    return curve[15] * std::exp2(doublings);
}

/// How many nodes there are above tiles: a quarter as many cells with each level, and a cell is
/// like another one if its four children are.
/// @param different  of the tiles
double nodes_above(double tiles, double different) {
    double sum = 0.0, part = std::min(1.0, different / std::max(tiles, 1.0));
    for (double cells = tiles / 4.0; cells >= 1.0; cells /= 4.0) {
        part = 1.0 - std::pow(1.0 - part, 4.0);
        sum += cells * part;
    }
    return sum;
}

Between around(double likely, double error) {
    const auto whole = [](double number) { return static_cast<std::uint64_t>(number); };
    return {whole(likely * std::max(0.0, 1.0 - error)), whole(likely),
            whole(std::ceil(likely * (1.0 + error)))};
}

/// Nodes and bytes of the whole DAG, and its growth.
void estimate_dag(const SampleTrial& trial, Estimate& estimate) {
    const auto levels = static_cast<std::size_t>(estimate.depth - 1);
    estimate.level_nodes.assign(levels, 0);
    const int steps = trial.sample.rarity;
    struct Sum {
        double nodes = 0.0, bytes = 0.0;
    } least, likely, most, quarter;
    for (std::size_t h = 0; h < trial.levels.size(); ++h) {
        const auto& [curve, bytes] = trial.levels[h];
        const auto add = [bytes = bytes](Sum& sum, double nodes) {
            sum.nodes += nodes;
            sum.bytes += nodes * bytes;
        };
        const double nodes = carried_on(curve, steps, kLikelyBend);
        estimate.level_nodes[levels - 1 - h] = static_cast<std::uint64_t>(nodes);
        add(likely, nodes);
        add(least, carried_on(curve, steps, kMostBend));
        add(most, carried_on(curve, steps, 0.0));
        add(quarter, steps == 0 ? curve[3] : carried_on(curve, steps - 1, kLikelyBend));
    }
    if (!trial.levels.empty()) {
        const double tiles = trial.sums.tiles * std::pow(4.0, steps);
        const auto& [curve, bytes] = trial.levels.back();
        const auto add_above = [tiles, &curve = curve, steps](Sum& sum, double bend) {
            const double nodes = nodes_above(tiles, carried_on(curve, steps, bend));
            sum.nodes += nodes;
            sum.bytes += kBytesPerNodeAbove * nodes;
        };
        add_above(likely, kLikelyBend);
        add_above(least, kMostBend);
        add_above(most, 0.0);
    }
    if (steps == 0) {
        const Statistics& whole = trial.whole;
        for (const LevelStatistics& level : whole.levels)
            if (static_cast<std::size_t>(level.level) < levels)
                estimate.level_nodes[static_cast<std::size_t>(level.level)] = level.dag_nodes;
        estimate.dag_nodes = around(static_cast<double>(whole.dag_nodes), 0.0);
        estimate.dag_bytes = around(static_cast<double>(whole.dag_bytes), 0.0);
    } else {
        const double error = trial.node_error() + kModelError;
        const auto between = [error](double low, double middle, double high) {
            return Between{around(low, error).least, around(middle, error).likely,
                           around(high, error).most};
        };
        estimate.dag_nodes = between(least.nodes, likely.nodes, most.nodes);
        estimate.dag_bytes = between(least.bytes, likely.bytes, most.bytes);
    }
    estimate.growth = std::clamp(likely.bytes / std::max(quarter.bytes, 1.0), 1.0, 4.0);
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
    const SampleTrial trial = try_sample(scene, options, grid);
    double cells = 0.0;
    if (attributes != nullptr) {
        const int level = attributes->level != 0 ? attributes->level
                                                 : AttributeOptions::usual_level(estimate.depth);
        cells = count_cells(trial, estimate.depth, level);
        estimate.attribute_bytes =
            static_cast<std::uint64_t>(cells * attribute_bytes_per_cell(*attributes, scene));
    }
    trim_memory();

    const double part = std::pow(0.25, trial.sample.rarity);
    estimate.sampled = part;
    estimate.voxels = around(static_cast<double>(trial.counts.voxels) / part, trial.voxel_error());
    estimate_dag(trial, estimate);
    estimate.seconds = trial.seconds(static_cast<double>(scene.triangles.size()));

    const auto threads =
        static_cast<std::uint64_t>(options.threads > 0 ? options.threads : available_threads());
    const std::uint64_t triangles_in_tiles =
        16 * scene.positions.size() + 24 * scene.triangles.size();
    const std::uint64_t held = resident_bytes();
    const auto dag_bytes = static_cast<double>(estimate.dag_bytes.most);
    estimate.peak_bytes =
        std::max(peak_resident_bytes(), held + triangles_in_tiles + threads * kBytesPerThread +
                                            estimate.dag_bytes.most +
                                            kTableBytesPerNode * estimate.dag_nodes.most);
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
            std::max(estimate.peak_bytes, held + triangles_in_tiles + estimate.dag_bytes.most +
                                              2 * estimate.attribute_bytes);
        estimate.least_bytes =
            std::max(estimate.least_bytes,
                     held + kLeastForAttributes + threads * kLeastForAttributesPerThread +
                         static_cast<std::uint64_t>(kTableBytesPerCell * cells));
        estimate.scratch_bytes += estimate.attribute_bytes + 100 * scene.triangles.size();
    }
    return estimate;
}

bool beyond_pointers(double least_dag_bytes) {
    return least_dag_bytes > kMostDagBytes;
}

void require_words(const Estimate& estimate) {
    if (!beyond_pointers(static_cast<double>(estimate.dag_bytes.least))) return;
    auto bytes = static_cast<double>(estimate.dag_bytes.most);
    int depth = estimate.depth;
    for (; depth > kMinDepth && bytes > kMostDagBytes; --depth)
        bytes /= std::max(estimate.growth, 1.5);
    throw Error(Errc::limit, "this DAG would take some " +
                                 megabytes(static_cast<double>(estimate.dag_bytes.likely)) +
                                 ", and pointers reach as far as " + megabytes(kMostDagBytes) +
                                 ": a resolution of " + std::to_string(1 << depth) + " would do");
}

void require_memory(const Estimate& estimate, std::uint64_t max_memory_bytes) {
    const auto cap = static_cast<double>(max_memory_bytes);
    const auto least = static_cast<double>(estimate.least_bytes);
    if (max_memory_bytes == 0 || least <= cap) return;

    auto dag_bytes = static_cast<double>(estimate.dag_bytes.most);
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
