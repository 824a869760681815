// SPDX-License-Identifier: MIT
#include "octavo/voxelize/spilled_triangles.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <type_traits>
#include <utility>

#include "octavo/core/error.h"
#include "octavo/core/morton.h"
#include "octavo/core/radix_sort.h"
#include "octavo/voxelize/tile_rasterizer.h"
#include "octavo/voxelize/triangle_source.h"

namespace octavo {
namespace {

constexpr std::size_t kPieceTriangles = std::size_t{1} << 15;
// A triangle can meet a million tiles, so few are asked about at once.
constexpr std::uint32_t kTrianglesAtOnce = 32;
constexpr std::size_t kRecordWords = 11;
constexpr std::size_t kBlockRecords = kSpillBlockWords / kRecordWords;
// Rasterized at once: a tile may hold any number.
constexpr std::size_t kBatch = 4096;

/// Triangles [begin, end) with positions of their own.
Scene piece_of(const Scene& scene, std::size_t begin, std::size_t end) {
    Scene piece;
    for (std::size_t i = begin; i < end; ++i) {
        const auto first = static_cast<std::uint32_t>(piece.positions.size());
        for (const dvec3& corner : scene.corners(i)) piece.positions.push_back(corner);
        piece.triangles.push_back({first, first + 1, first + 2});
    }
    return piece;
}

static_assert(std::is_trivially_copyable_v<CutOuts::Triangle>);

}  // namespace

/// Triangles of one tile that are rasterized together.
class SpilledTriangles::Batch final : public HoleLookup {
public:
    explicit Batch(const SpillFile* holes_file) : holes_file_(holes_file) {}

    [[nodiscard]] std::size_t size() const { return corners_.size(); }
    void add(const std::uint32_t* record) {
        std::array<FixedPoint, 3> corners;
        const std::uint32_t* word = record + 1;
        for (FixedPoint& corner : corners) {
            corner = {static_cast<std::int32_t>(word[0]), static_cast<std::int32_t>(word[1]),
                      static_cast<std::int32_t>(word[2]), 0};
            word += 3;
        }
        corners_.push_back(corners);
        holes_.push_back(*word);
    }

    /// Empties the batch.
    void rasterize(const FixedMesh::Frame& frame, std::uint32_t tile, int tile_depth,
                   VoxelRule rule, TileBitmap& bitmap) {
        std::vector<TileTriangle> pairs;
        for (std::uint32_t i = 0; i < corners_.size(); ++i) pairs.push_back({tile, i});
        const FixedMesh mesh(frame, std::move(corners_));
        rasterize_tile(mesh, holes_file_ != nullptr ? this : nullptr, pairs, morton_decode(tile),
                       tile_depth, rule, bitmap);
        corners_.clear();
        holes_.clear();
    }

    bool find(std::size_t triangle, CutOuts::Triangle& out) const override {
        const std::uint32_t holes = holes_[triangle];
        if (holes == kNoHoles) return false;
        if (!holes_file_->read(std::uint64_t{holes} * sizeof out, &out, sizeof out))
            throw Error(Errc::io, holes_file_->path(), "the scratch file is shorter than written");
        return true;
    }

private:
    const SpillFile* holes_file_;
    std::vector<std::array<FixedPoint, 3>> corners_;
    std::vector<std::uint32_t> holes_;
};

SpilledTriangles::SpilledTriangles(const Scene& scene, const Grid& grid, VoxelRule rule,
                                   int tile_depth, const std::filesystem::path& file,
                                   std::uint64_t buffer_bytes, const ProgressFunction& progress)
    : rule_(rule),
      tile_depth_(checked_tile_depth(tile_depth, grid.depth)),
      grid_depth_(grid.depth),
      file_(file, SpillFile::Kind::temporary),
      // Sorting needs as much again.
      max_records_(std::max<std::uint64_t>(1024, buffer_bytes / 2 / sizeof(Record))),
      cut_outs_(scene, grid),
      readers_([tile_depth] { return Reader(tile_depth); }) {
    const Box bounds = scene.bounds();
    const std::size_t count = scene.triangles.size();
    records_.reserve(max_records_);
    if (!cut_outs_.empty()) {
        std::filesystem::path holes = file;
        holes += ".holes";
        holes_file_ = std::make_unique<SpillFile>(holes, SpillFile::Kind::temporary);
    }
    frame_ = FixedMesh(Scene(), grid, bounds).frame();
    for (std::size_t begin = 0; begin < count; begin += kPieceTriangles) {
        report(progress, {"sort triangles", begin, count, 0});
        add_piece(scene, begin, std::min(count, begin + kPieceTriangles), bounds, grid);
    }
    write_run();
    records_ = {};
    cut_outs_.forget_triangles();
    tiles_.shrink_to_fit();
}

void SpilledTriangles::add_piece(const Scene& scene, std::size_t begin, std::size_t end,
                                 const Box& bounds, const Grid& grid) {
    const Scene piece = piece_of(scene, begin, end);
    const FixedMesh mesh(piece, grid, bounds);
    degenerate_ += mesh.degenerate_triangles();
    non_finite_ += mesh.non_finite_triangles();

    std::vector<std::uint32_t> holes(end - begin, kNoHoles);  // of each triangle of the piece
    if (holes_file_) {
        std::vector<CutOuts::Triangle> found;
        CutOuts::Triangle one;
        for (std::size_t i = begin; i < end; ++i) {
            if (!cut_outs_.find(i, one)) continue;
            holes[i - begin] = hole_count_ + static_cast<std::uint32_t>(found.size());
            found.push_back(one);
        }
        holes_file_->write(std::uint64_t{hole_count_} * sizeof one, found.data(),
                           found.size() * sizeof one);
        hole_count_ += static_cast<std::uint32_t>(found.size());
    }

    std::vector<TileTriangle> pairs;
    const auto count = static_cast<std::uint32_t>(mesh.size());
    for (std::uint32_t first = 0; first < count; first += kTrianglesAtOnce) {
        pairs.clear();
        find_tiles(mesh, first, std::min(count, first + kTrianglesAtOnce), grid_depth_, tile_depth_,
                   pairs);
        for (const TileTriangle& pair : pairs) {
            std::array<FixedPoint, 3> c;
            if (!mesh.corners(pair.triangle, c)) continue;
            records_.push_back(
                {pair.tile,
                 {c[0].x, c[0].y, c[0].z, c[1].x, c[1].y, c[1].z, c[2].x, c[2].y, c[2].z},
                 holes[mesh.scene_triangle(pair.triangle)]});
            if (records_.size() == max_records_) write_run();
        }
    }
}

void SpilledTriangles::write_run() {
    static_assert(sizeof(Record) == kRecordWords * sizeof(std::uint32_t));
    if (records_.empty()) return;
    {
        std::vector<Record> scratch;
        radix_sort(
            records_, 3 * (grid_depth_ - tile_depth_),
            [](const Record& record) { return record.tile; }, scratch);
    }
    Run run;
    for (std::size_t i = 0; i < records_.size(); i += kBlockRecords) {
        const std::size_t count = std::min(kBlockRecords, records_.size() - i);
        run.push_back({records_[i].tile, end_});
        WordWriter writer(file_, end_);
        writer.put(reinterpret_cast<const std::uint32_t*>(&records_[i]), count * kRecordWords);
        end_ = writer.finish();
    }
    runs_.push_back(std::move(run));

    const std::size_t known = tiles_.size();
    for (std::size_t i = 0; i < records_.size(); ++i)
        if (i == 0 || records_[i].tile != records_[i - 1].tile) tiles_.push_back(records_[i].tile);
    std::inplace_merge(tiles_.begin(), tiles_.begin() + static_cast<std::ptrdiff_t>(known),
                       tiles_.end());
    tiles_.erase(std::unique(tiles_.begin(), tiles_.end()), tiles_.end());
    records_.clear();
}

void SpilledTriangles::voxelize(std::size_t index, std::vector<LeafBlock>& leaves) const {
    Reader& reader = readers_.local();
    reader.open.resize(runs_.size());
    const auto tile = static_cast<std::uint32_t>(tiles_[index]);

    Batch batch(holes_file_.get());
    const auto rasterize = [&] {
        batch.rasterize(frame_, tile, tile_depth_, rule_, reader.bitmap);
    };

    for (std::size_t r = 0; r < runs_.size(); ++r) {
        const Run& run = runs_[r];
        Reader::Open& open = reader.open[r];
        // The last block that begins before the tile may end with it.
        auto block = std::ranges::lower_bound(run, tile, {}, &Block::first_tile);
        if (block != run.begin()) --block;
        for (; block != run.end() && block->first_tile <= tile; ++block) {
            const auto number = static_cast<std::size_t>(block - run.begin());
            if (open.block != number) {
                open.words.clear();
                open.block = ~std::size_t{0};
                (void)read_block(file_, block->offset, open.words);
                open.block = number;
            }
            const std::size_t count = open.words.size() / kRecordWords;
            const auto tile_of = [&](std::size_t i) { return open.words[i * kRecordWords]; };
            std::size_t low = 0, high = count;
            while (low < high) {
                const std::size_t middle = (low + high) / 2;
                if (tile_of(middle) < tile) {
                    low = middle + 1;
                } else {
                    high = middle;
                }
            }
            for (; low < count && tile_of(low) == tile; ++low) {
                batch.add(&open.words[low * kRecordWords]);
                if (batch.size() == kBatch) rasterize();
            }
        }
    }
    if (batch.size() != 0) rasterize();
    reader.bitmap.take(leaves);
}

}  // namespace octavo
