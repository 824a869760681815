// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "octavo/core/box.h"
#include "octavo/core/grid.h"
#include "octavo/core/progress.h"
#include "octavo/core/spill_file.h"
#include "octavo/mesh/scene.h"
#include "octavo/voxelize/fixed_point.h"

namespace octavo {

/// Where triangles are sorted on disk, and how.
struct DiskSort {
    std::filesystem::path file;      // temporary; it has no name once the triangles are sorted
    std::uint64_t buffer_bytes = 0;  // to sort at once
    ProgressFunction progress = {};  // phase "sort triangles", in triangles
};

/// A scene's triangles by the tiles that they meet, on disk: the scene is not needed any more once
/// this is made.
///
/// Each pair of a tile and a triangle that meets it is a record, with the triangle's rounded
/// corners. Records are sorted by tile as many as fit at a time, and each of these runs is written
/// out in blocks. A thread that wants a tile looks into the one block of each run in which the
/// tile's records begin, and keeps that block, because the next tile's are mostly in it too.
///
/// Memory: the sort's buffer while it is made; then 16 bytes for each block of 64 kB, 8 for each
/// tile, and for each thread a block of each run.
class SpilledFacets {
public:
    /// Says by what number each triangle from `begin` on is to be known.
    using Numbering = std::function<void(std::size_t begin, std::span<std::uint32_t> numbers)>;

    /// @param tile_depth  as TriangleSource
    /// @throws Error      as TriangleSource; io; cancelled
    SpilledFacets(const Scene& scene, const Grid& grid, int tile_depth, const Numbering& numbering,
                  const DiskSort& sort);

    [[nodiscard]] int tile_depth() const { return tile_depth_; }
    [[nodiscard]] const FixedMesh::Frame& frame() const { return frame_; }
    [[nodiscard]] std::uint64_t degenerate_triangles() const { return degenerate_; }
    [[nodiscard]] std::uint64_t non_finite_triangles() const { return non_finite_; }
    [[nodiscard]] std::size_t runs() const { return runs_.size(); }

    /// The Morton codes of the tiles that any triangle meets, in order.
    [[nodiscard]] const std::vector<std::uint64_t>& tiles() const { return tiles_; }

    /// Calls visit(corners, number) for the triangles that meet a tile, in no particular order.
    template <class Visit>
    void for_each(std::uint32_t tile, const Visit& visit) const {
        std::vector<Open>& open = open_.local();
        open.resize(runs_.size());
        for (std::size_t r = 0; r < runs_.size(); ++r)
            for (std::size_t block = first_block(r, tile);
                 block < runs_[r].size() && runs_[r][block].first_tile <= tile; ++block) {
                const std::span<const std::uint32_t> words = read(r, block, open[r]);
                for (std::size_t at = first_record(words, tile);
                     at < words.size() && words[at] == tile; at += kRecordWords)
                    visit(corners_of(&words[at]), words[at + kRecordWords - 1]);
            }
    }

private:
    struct Record {
        std::uint32_t tile;
        std::array<std::int32_t, 9> corners;
        std::uint32_t number;
    };
    static constexpr std::size_t kRecordWords = 11;
    struct Block {
        std::uint32_t first_tile;
        std::uint64_t offset;
    };
    using Run = std::vector<Block>;

    /// The block of a run that a thread looked into last.
    struct Open {
        std::size_t block = ~std::size_t{0};
        std::vector<std::uint32_t> words;
    };

    void add_piece(const Scene& scene, std::size_t begin, std::size_t end, const Box& bounds,
                   const Grid& grid, const Numbering& numbering);
    void write_run();
    [[nodiscard]] std::size_t first_block(std::size_t run, std::uint32_t tile) const;
    [[nodiscard]] static std::size_t first_record(std::span<const std::uint32_t> words,
                                                  std::uint32_t tile);
    [[nodiscard]] std::span<const std::uint32_t> read(std::size_t run, std::size_t block,
                                                      Open& open) const;
    [[nodiscard]] static std::array<FixedPoint, 3> corners_of(const std::uint32_t* record);

    int tile_depth_;
    int grid_depth_;
    SpillFile file_;
    std::size_t max_records_;
    std::uint64_t end_ = 0;  // of the file
    std::vector<Record> records_;
    FixedMesh::Frame frame_;
    std::vector<Run> runs_;
    std::vector<std::uint64_t> tiles_;
    std::uint64_t degenerate_ = 0;
    std::uint64_t non_finite_ = 0;
    mutable tbb::enumerable_thread_specific<std::vector<Open>> open_;
};

}  // namespace octavo
