// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "octavo/core/grid.h"
#include "octavo/core/progress.h"
#include "octavo/core/spill_file.h"
#include "octavo/mesh/scene.h"
#include "octavo/voxelize/cut_outs.h"
#include "octavo/voxelize/fixed_point.h"
#include "octavo/voxelize/rule.h"
#include "octavo/voxelize/tile_bitmap.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

/// A scene's triangles as voxels, as TriangleSource has them, from disk: the scene is not needed
/// any more once this is made. Where triangles have holes, the textures' pixels that are solid stay
/// in memory, and how each such triangle lies on them goes to disk too.
///
/// Each pair of a tile and a triangle that meets it is a record, with the triangle's rounded
/// corners. Records are sorted by tile as many as fit at a time, and each of these runs is written
/// out in blocks. A thread that wants a tile looks into the one block of each run in which the
/// tile's records begin, and keeps that block, because the next tile's are mostly in it too.
///
/// Memory: `buffer_bytes` while it is made; then 16 bytes for each block of 64 kB, 8 for each tile,
/// and for each thread a tile's bits and a block of each run.
class SpilledTriangles final : public VoxelSource {
public:
    /// @param tile_depth    as TriangleSource
    /// @param file          a temporary file; it has no name once this is made, nor has another one
    ///                      beside it
    /// @param buffer_bytes  how much to sort at once
    /// @param progress      phase "sort triangles", in triangles
    /// @throws Error        as TriangleSource; io; cancelled
    SpilledTriangles(const Scene& scene, const Grid& grid, VoxelRule rule, int tile_depth,
                     const std::filesystem::path& file, std::uint64_t buffer_bytes,
                     const ProgressFunction& progress);

    [[nodiscard]] int tile_depth() const override { return tile_depth_; }
    [[nodiscard]] const std::vector<std::uint64_t>& tiles() const override { return tiles_; }
    void voxelize(std::size_t index, std::vector<LeafBlock>& leaves) const override;

    [[nodiscard]] std::uint64_t degenerate_triangles() const { return degenerate_; }
    [[nodiscard]] std::uint64_t non_finite_triangles() const { return non_finite_; }
    [[nodiscard]] std::size_t runs() const { return runs_.size(); }

private:
    /// A tile's Morton code, three corners, and which triangle with holes this is; eleven words.
    struct Record {
        std::uint32_t tile;
        std::array<std::int32_t, 9> corners;
        std::uint32_t holes;  // in the file of these, or kNoHoles
    };
    static constexpr std::uint32_t kNoHoles = 0xffffffffu;
    class Batch;
    struct Block {
        std::uint32_t first_tile;
        std::uint64_t offset;
    };
    using Run = std::vector<Block>;

    /// What a thread holds: the block that it looked into last, of each run.
    struct Reader {
        explicit Reader(int tile_depth) : bitmap(tile_depth) {}
        TileBitmap bitmap;
        struct Open {
            std::size_t block = ~std::size_t{0};
            std::vector<std::uint32_t> words;
        };
        std::vector<Open> open;
    };

    void add_piece(const Scene& scene, std::size_t begin, std::size_t end, const Box& bounds,
                   const Grid& grid);
    void write_run();

    VoxelRule rule_;
    int tile_depth_;
    int grid_depth_;
    SpillFile file_;
    std::size_t max_records_;
    std::uint64_t end_ = 0;  // of the file
    std::vector<Record> records_;
    FixedMesh::Frame frame_;
    CutOuts cut_outs_;
    std::unique_ptr<SpillFile> holes_file_;  // a CutOuts::Triangle for each that has holes
    std::uint32_t hole_count_ = 0;
    std::vector<Run> runs_;
    std::vector<std::uint64_t> tiles_;
    std::uint64_t degenerate_ = 0;
    std::uint64_t non_finite_ = 0;
    mutable tbb::enumerable_thread_specific<Reader> readers_;
};

}  // namespace octavo
