// SPDX-License-Identifier: MIT
#include "octavo/construct/estimate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "octavo/attributes/cell_index.h"
#include "octavo/construct/scratch.h"
#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"

namespace octavo {
namespace {

constexpr int kCoarserBy = 3;  // levels

// The finer the voxels, the more a node has its like: from level to level growth falls, by 2 % for
// architecture and 10 % for hair.
constexpr double kGrowthDecay = 0.93;

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

struct Trial {
    double seconds = 0.0;
    double dag_bytes = 1.0;
    double voxels = 1.0;
    Dag dag;
};

Trial try_build(const Scene& scene, const BuildOptions& options, int depth) {
    BuildOptions coarse;
    coarse.depth = depth;
    coarse.rule = options.rule;
    coarse.threads = options.threads;
    // Not the cap itself: one that cannot be kept is to be found here and not to stop us.
    if (options.max_memory_bytes != 0 && !options.scratch.empty()) {
        coarse.scratch = options.scratch;
        coarse.scratch += "-estimate";
        coarse.journal_interval = std::chrono::hours(24 * 365);
        coarse.spill = {options.max_memory_bytes / 4 + 1, options.max_memory_bytes / 8 + 1};
    }
    struct Cleaner {
        const std::filesystem::path& folder;
        ~Cleaner() {
            if (!folder.empty()) delete_scratch(folder);
        }
    } const cleaner{coarse.scratch};
    coarse.progress = [&](const Progress&) {
        // Only to let the caller stop: these tiles are not progress of theirs.
        return !options.progress || options.progress({"estimate", 0, 0, 0});
    };
    if (options.grid) {
        coarse.grid = options.grid;
        coarse.grid->voxel_size = std::ldexp(options.grid->voxel_size, options.grid->depth - depth);
        coarse.grid->depth = depth;
    }
    const auto start = std::chrono::steady_clock::now();
    BuildResult built = build(scene, coarse);
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    return {passed.count(), std::max(1.0, static_cast<double>(built.dag.size_bytes())),
            std::max(1.0, static_cast<double>(built.statistics.voxels)), std::move(built.dag)};
}

/// Of this level, which may be finer than the trials.
double count_cells(const Trial& coarsest, const Trial& coarse, int level) {
    if (level <= coarse.dag.depth())
        return static_cast<double>(CellIndex(coarse.dag, level).count());
    const double growth = std::clamp(coarse.voxels / coarsest.voxels, 1.0, 4.0);
    return coarse.voxels * std::pow(growth, level - coarse.dag.depth());
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
    const int near = std::max(estimate.depth - kCoarserBy, std::min(estimate.depth, 6));
    const int far = std::max(near - 1, kMinDepth);
    const Trial coarsest = try_build(scene, options, far);
    Trial coarse = try_build(scene, options, near);
    double cells = 0.0;
    if (attributes != nullptr) {
        const int level = attributes->level != 0 ? attributes->level
                                                 : AttributeOptions::usual_level(estimate.depth);
        cells = count_cells(coarsest, coarse, level);
        estimate.attribute_bytes =
            static_cast<std::uint64_t>(cells * attribute_bytes_per_cell(*attributes, scene));
    }
    coarse.dag = {};
    trim_memory();

    // A surface has four times the voxels at twice the resolution, and never more nodes than that;
    // time comes near that factor as voxels come to outnumber triangles.
    const int levels = estimate.depth - near;
    estimate.growth = std::clamp(coarse.dag_bytes / coarsest.dag_bytes, 1.0, 4.0);
    double dag_bytes = coarse.dag_bytes;
    for (int i = 0; i < levels; ++i) {
        estimate.growth = std::max(1.0, kGrowthDecay * estimate.growth);
        dag_bytes *= estimate.growth;
    }
    const double slowdown = std::clamp(coarse.seconds / coarsest.seconds, 3.0, 4.0);
    estimate.seconds = coarse.seconds * std::pow(slowdown, levels);
    estimate.dag_bytes = static_cast<std::uint64_t>(dag_bytes);

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
    std::string advice = "--max-memory " +
                         std::to_string(static_cast<std::uint64_t>(std::ceil(least / (1 << 20)))) +
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
