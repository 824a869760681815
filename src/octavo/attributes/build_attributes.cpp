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

#include "octavo/attributes/tile_averages.h"
#include "octavo/core/memory.h"
#include "octavo/core/morton.h"
#include "octavo/core/parallel.h"

namespace octavo {
namespace {

using Channel = Attributes::Channel;
constexpr std::size_t kChannels = Attributes::kChannels;

constexpr int kUsualLevel = 10;
constexpr int kTileDepth = 6;        // 64^3 cells: what a tile takes stays in a core's cache
constexpr int kMostTilesDepth = 10;  // as many as TriangleSource can sort into

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

class AttributeBuild {
public:
    AttributeBuild(const Scene& scene, const Dag& dag, const Grid& grid,
                   const AttributeOptions& options)
        : options_(options),
          cells_(dag, options.level),
          surfaces_(scene),
          tile_depth_(std::clamp(kTileDepth, options.level - kMostTilesDepth, options.level)),
          triangles_(scene, grid_of_cells(grid, options.level), VoxelRule::conservative,
                     tile_depth_),
          averagers_([this] {
              return TileAverager(cells_, triangles_.mesh(), surfaces_, options_, tile_depth_);
          }) {
        wanted_[static_cast<unsigned>(Channel::color)] = options.color;
        wanted_[static_cast<unsigned>(Channel::emission)] =
            options.emission && surfaces_.greatest_emission() > 0.0f;
        wanted_[static_cast<unsigned>(Channel::normal)] = options.normal;
        wanted_[static_cast<unsigned>(Channel::back)] = true;
        wanted_[static_cast<unsigned>(Channel::back_emission)] = wanted(Channel::emission);
        wanted_[static_cast<unsigned>(Channel::back_normal)] = options.normal;
        for (std::size_t c = 0; c < kChannels; ++c)
            writers_.emplace_back(Attributes::kValueBits[c],
                                  tolerance_of(static_cast<Channel>(c), options.tolerance));
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
        const std::size_t in_flight =
            4 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
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
        const Tile& tile = tiles_[part.index];
        averagers_.local().average(tile.place, tile.range, triangles_in(tile.place), part.values);
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
        check_memory();
    }

    void check_memory() const {
        const std::uint64_t cap = options_.max_memory_bytes;
        if (cap == 0) return;
        // To finish a channel its words are put together once more.
        std::uint64_t largest = 0;
        for (const CellValuesWriter& writer : writers_)
            largest = std::max(largest, writer.size_bytes());
        const std::uint64_t need = resident_bytes() + largest;
        if (need > cap)
            throw Error(Errc::limit, "the attributes need more than the memory cap of " +
                                         std::to_string(cap >> 20) +
                                         " MiB: with them it comes to " +
                                         std::to_string(need >> 20) +
                                         " MiB; raise the cap or lower the attribute resolution");
    }

    [[nodiscard]] std::span<const TileTriangle> triangles_in(const uvec3& tile) const {
        const auto& tiles = triangles_.tiles();
        const std::uint64_t code = morton_encode(tile);
        const auto found = std::lower_bound(tiles.begin(), tiles.end(), code);
        if (found == tiles.end() || *found != code) return {};
        return triangles_.triangles(static_cast<std::size_t>(found - tiles.begin()));
    }

    const AttributeOptions& options_;
    CellIndex cells_;
    SurfaceSampler surfaces_;
    int tile_depth_;
    TriangleSource triangles_;
    std::vector<Tile> tiles_;
    std::array<bool, kChannels> wanted_{};
    std::array<bool, kChannels> any_{};
    std::vector<CellValuesWriter> writers_;
    // For each thread, as its scratch memory is then in that core's cache.
    tbb::enumerable_thread_specific<TileAverager> averagers_;
};

}  // namespace

Attributes build_attributes(const Scene& scene, const Dag& dag, const Grid& grid,
                            const AttributeOptions& options) {
    AttributeOptions chosen = options;
    if (chosen.level == 0) chosen.level = std::min(kUsualLevel, dag.depth());
    if (chosen.tolerance < 0 || chosen.tolerance > 255)
        throw Error(Errc::bad_argument, "the tolerance of colours is 0 to 255");
    std::optional<Attributes> result;
    with_threads(options.threads, [&] {
        report(options.progress, {"attributes", 0, 0, 0});
        result = AttributeBuild(scene, dag, grid, chosen).run();
    });
    return std::move(*result);
}

}  // namespace octavo
