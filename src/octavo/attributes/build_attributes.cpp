// SPDX-License-Identifier: MIT
#include "octavo/attributes/build_attributes.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "octavo/attributes/cell_values_writer.h"
#include "octavo/attributes/tile_averages.h"
#include "octavo/core/memory.h"
#include "octavo/core/morton.h"
#include "octavo/core/parallel.h"

namespace octavo {
namespace {

using Channel = Attributes::Channel;
constexpr std::size_t kChannels = Attributes::kChannels;

constexpr int kTileDepth = 6;        // 64^3 cells: what a tile takes stays in a core's cache
constexpr int kMostTilesDepth = 10;  // as many as TriangleSource can sort into

// Of the cap, what triangles are sorted in on their way to disk.
constexpr std::uint64_t kSortedShare = 8;

/// The DAG's cells as a grid of their own.
Grid grid_of_cells(const Grid& grid, int level) {
    Grid cells = grid;
    cells.voxel_size = std::ldexp(grid.voxel_size, grid.depth - level);
    cells.depth = level;
    return cells;
}

int tolerance_of(Channel channel, int tolerance) {
    return channel == Channel::color || channel == Channel::back ? tolerance : 0;
}

/// Kept free under a cap for what tiles take while they are worked on, and the texels that they
/// look at: of each page the system brings its neighbours along.
std::uint64_t reserve_below(std::uint64_t cap) {
    constexpr std::uint64_t kPerThread = std::uint64_t{9} << 20;
    const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
    return std::max(std::min(cap / 6, std::uint64_t{128} << 20),
                    std::min(cap / 3, threads * kPerThread));
}

/// One tile on its way through the pipeline. Blocks of 256 cells that lie wholly in the tile are
/// packed here; what is left before and after goes with the neighbours'.
struct TilePart {
    struct ChannelPart {
        std::span<const std::uint32_t> before, after;
        PackedBlocks blocks;
    };

    std::vector<BlockPacker> packers;
    std::size_t index = 0;
    CellRange range;
    TileValues values;
    std::array<ChannelPart, kChannels> channels;
};

/// The averages of all cells, on their way.
class Averaging {
public:
    Averaging(const SurfaceTiles& triangles, const SurfaceSampler& surfaces, const Dag& dag,
              const AttributeOptions& options)
        : options_(options),
          on_disk_(options.is_on_disk()),
          cells_(dag, options.level),
          surfaces_(surfaces),
          tile_depth_(triangles.tile_depth()),
          averagers_([&] {
              return TileAverager(cells_, triangles, surfaces_, options_,
                                  on_disk_ ? [this] { check_memory(); } : std::function<void()>());
          }) {
        wanted_[static_cast<unsigned>(Channel::color)] = options.color;
        wanted_[static_cast<unsigned>(Channel::emission)] =
            options.emission && surfaces_.greatest_emission() > 0.0f;
        wanted_[static_cast<unsigned>(Channel::normal)] = options.normal;
        wanted_[static_cast<unsigned>(Channel::back)] = true;
        wanted_[static_cast<unsigned>(Channel::back_emission)] = wanted(Channel::emission);
        wanted_[static_cast<unsigned>(Channel::back_normal)] = options.normal;
        for (std::size_t c = 0; c < kChannels; ++c) {
            const int tolerance = tolerance_of(static_cast<Channel>(c), options.tolerance);
            if (on_disk_ && wanted_[c]) {
                writers_.emplace_back(Attributes::kValueBits[c], tolerance, cells_.count(),
                                      options.scratch / "attributes");
            } else {
                writers_.emplace_back(Attributes::kValueBits[c], tolerance, cells_.count());
            }
        }
        find_tiles();
    }

    Attributes run() {
        average_all_tiles();
        std::array<CellValues, kChannels> channels;
        for (std::size_t c = 0; c < kChannels; ++c) {
            if (wanted_[c] && needed(static_cast<Channel>(c)))
                channels[c] = std::move(writers_[c]).finish();
        }
        return {std::move(cells_), std::move(channels), options_.tolerance};
    }

private:
    struct Tile {
        uvec3 place;
        CellRange range;
    };

    [[nodiscard]] bool wanted(Channel channel) const {
        return wanted_[static_cast<unsigned>(channel)];
    }

    [[nodiscard]] bool any(Channel channel) const { return any_[static_cast<unsigned>(channel)]; }

    /// An array of nothing but zeros says no more than one that is not there.
    [[nodiscard]] bool needed(Channel channel) const {
        const bool emission = any(Channel::emission) || any(Channel::back_emission);
        switch (channel) {
            case Channel::back:
            case Channel::back_normal:
                return any(Channel::back);
            case Channel::emission:
                return emission;
            case Channel::back_emission:
                return emission && any(Channel::back);
            default:
                return true;
        }
    }

    /// The tiles that have cells: those of the DAG, as rounding may find fewer in the triangles.
    void find_tiles() {
        const int level = options_.level - tile_depth_;
        std::uint64_t next = 0;
        while (next < cells_.count()) {
            const uvec3 tile = cells_.cell(next) >> static_cast<unsigned>(tile_depth_);
            tiles_.push_back({tile, cells_.cells_in(tile, level)});
            next = tiles_.back().range.end;
        }
    }

    void average_all_tiles() {
        // Where memory is scarce, fewer tiles wait for one that takes long.
        const std::size_t in_flight =
            (on_disk_ ? 2 : 4) * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
        std::vector<std::unique_ptr<TilePart>> places(in_flight);
        for (auto& part : places) {
            part = std::make_unique<TilePart>();
            for (std::size_t c = 0; c < kChannels; ++c)
                part->packers.emplace_back(
                    Attributes::kValueBits[c],
                    tolerance_of(static_cast<Channel>(c), options_.tolerance));
        }
        std::size_t next_tile = 0;
        const auto feed = [&](tbb::flow_control& control) -> TilePart* {
            if (next_tile >= tiles_.size()) {
                control.stop();
                return nullptr;
            }
            TilePart* part = places[next_tile % in_flight].get();
            part->index = next_tile++;
            return part;
        };
        const auto work = [&](TilePart* part) {
            average(*part);
            return part;
        };
        const auto collect = [&](TilePart* part) { append(*part); };
        tbb::parallel_pipeline(
            in_flight,
            tbb::make_filter<void, TilePart*>(tbb::filter_mode::serial_in_order, feed) &
                tbb::make_filter<TilePart*, TilePart*>(tbb::filter_mode::parallel, work) &
                tbb::make_filter<TilePart*, void>(tbb::filter_mode::serial_in_order, collect));
    }

    void average(TilePart& part) {
        if (on_disk_) check_memory();
        const Tile& tile = tiles_[part.index];
        averagers_.local().average(tile.place, tile.range, part.values);
        constexpr std::uint64_t kBlock = CellValues::kBlockCells;
        const std::uint64_t size = tile.range.size();
        const std::uint64_t before = std::min(size, (kBlock - tile.range.begin % kBlock) % kBlock);
        const std::uint64_t blocks = (size - before) / kBlock;
        for (std::size_t c = 0; c < kChannels; ++c) {
            if (!wanted_[c]) continue;
            TilePart::ChannelPart& out = part.channels[c];
            const std::span<const std::uint32_t> values(part.values[c]);
            out.before = values.first(before);
            out.after = values.subspan(before + blocks * kBlock);
            out.blocks.begins.clear();
            out.blocks.words.clear();
            for (std::uint64_t b = 0; b < blocks; ++b)
                part.packers[c].pack(values.subspan(before + b * kBlock, kBlock), out.blocks);
        }
    }

    void append(const TilePart& part) {
        for (std::size_t c = 0; c < kChannels; ++c) {
            if (!wanted_[c]) continue;
            const TilePart::ChannelPart& values = part.channels[c];
            writers_[c].append(values.before);
            writers_[c].append(values.blocks);
            writers_[c].append(values.after);
            any_[c] = any_[c] || std::any_of(part.values[c].begin(), part.values[c].end(),
                                             [](std::uint32_t v) { return v != 0; });
        }
        report(options_.progress, {"attributes", part.index + 1, tiles_.size(), 0});
        if (!on_disk_) check_memory();
    }

    /// Of what is on disk, any thread may give back what all have looked at.
    void check_memory() const {
        const std::uint64_t cap = options_.max_memory_bytes;
        if (cap == 0) return;
        // A channel in memory may be moved once more as it grows.
        std::uint64_t largest = 0;
        if (!on_disk_)
            for (const CellValuesWriter& writer : writers_)
                largest = std::max(largest, writer.size_bytes());
        if (resident_bytes() + reserve_below(cap) <= cap - std::min(cap, largest)) return;
        if (on_disk_) {
            surfaces_.release();
            const Dag& dag = cells_.dag();
            dag.release(0, dag.words().size());
            trim_memory();
        }
        const std::uint64_t need = resident_bytes() + largest;
        if (need > cap)
            throw Error(Errc::limit, "the attributes need more than the memory cap of " +
                                         std::to_string(cap >> 20) +
                                         " MiB: with them it comes to " +
                                         std::to_string(need >> 20) +
                                         " MiB; raise the cap or lower the attribute resolution");
    }

    const AttributeOptions& options_;
    bool on_disk_;
    CellIndex cells_;
    const SurfaceSampler& surfaces_;
    int tile_depth_;
    std::vector<Tile> tiles_;
    std::array<bool, kChannels> wanted_{};
    std::array<bool, kChannels> any_{};
    std::vector<CellValuesWriter> writers_;
    // For each thread, as its scratch memory is then in that core's cache.
    tbb::enumerable_thread_specific<TileAverager> averagers_;
};

AttributeOptions checked(AttributeOptions options, int depth) {
    if (options.level == 0) options.level = AttributeOptions::usual_level(depth);
    if (options.level < kMinDepth || options.level > depth)
        throw Error(Errc::bad_argument, "the attributes' level " + std::to_string(options.level) +
                                            " is not one of 2 to the depth, " +
                                            std::to_string(depth));
    if (options.tolerance < 0 || options.tolerance > 255)
        throw Error(Errc::bad_argument, "the tolerance of colours is 0 to 255");
    return options;
}

}  // namespace

class AttributeSource::Parts {
public:
    Parts(const Scene& scene, const Grid& grid, const AttributeOptions& wanted)
        : options(checked(wanted, grid.depth)),
          surfaces(scene, scratch()),
          triangles(scene, grid_of_cells(grid, options.level),
                    std::clamp(kTileDepth, options.level - kMostTilesDepth, options.level),
                    scratch(), options.max_memory_bytes / kSortedShare, options.progress) {}

    AttributeOptions options;
    SurfaceSampler surfaces;
    SurfaceTiles triangles;

private:
    [[nodiscard]] std::filesystem::path scratch() const {
        return options.is_on_disk() ? options.scratch : std::filesystem::path();
    }
};

AttributeSource::AttributeSource(const Scene& scene, const Grid& grid,
                                 const AttributeOptions& options) {
    with_threads(options.threads, [&] {
        report(options.progress, {"attributes", 0, 0, 0});
        parts_ = std::make_unique<Parts>(scene, grid, options);
    });
    if (parts_->options.is_on_disk()) trim_memory();
}

AttributeSource::~AttributeSource() = default;
AttributeSource::AttributeSource(AttributeSource&&) noexcept = default;
AttributeSource& AttributeSource::operator=(AttributeSource&&) noexcept = default;

const std::vector<std::string>& AttributeSource::warnings() const {
    return parts_->surfaces.warnings();
}

Attributes AttributeSource::average(const Dag& dag) const {
    std::optional<Attributes> result;
    with_threads(parts_->options.threads, [&] {
        result = Averaging(parts_->triangles, parts_->surfaces, dag, parts_->options).run();
    });
    return std::move(*result);
}

Attributes build_attributes(const Scene& scene, const Dag& dag, const Grid& grid,
                            const AttributeOptions& options) {
    return AttributeSource(scene, grid, options).average(dag);
}

}  // namespace octavo
