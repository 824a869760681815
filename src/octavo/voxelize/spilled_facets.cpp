// SPDX-License-Identifier: MIT
#include "octavo/voxelize/spilled_facets.h"

#include <algorithm>

#include "octavo/core/radix_sort.h"
#include "octavo/voxelize/tile_rasterizer.h"
#include "octavo/voxelize/triangle_source.h"

namespace octavo {
namespace {

constexpr std::size_t kPieceTriangles = std::size_t{1} << 15;
// A triangle can meet a million tiles, so few are asked about at once.
constexpr std::uint32_t kTrianglesAtOnce = 32;

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

}  // namespace

SpilledFacets::SpilledFacets(const Scene& scene, const Grid& grid, int tile_depth,
                             const Numbering& numbering, const DiskSort& sort)
    : tile_depth_(checked_tile_depth(tile_depth, grid.depth)),
      grid_depth_(grid.depth),
      file_(sort.file, SpillFile::Kind::temporary),
      // Sorting needs as much again.
      max_records_(std::max<std::uint64_t>(1024, sort.buffer_bytes / 2 / sizeof(Record))) {
    const Box bounds = scene.bounds();
    const std::size_t count = scene.triangles.size();
    records_.reserve(max_records_);
    frame_ = FixedMesh(Scene(), grid, bounds).frame();
    for (std::size_t begin = 0; begin < count; begin += kPieceTriangles) {
        report(sort.progress, {"sort triangles", begin, count, 0});
        add_piece(scene, begin, std::min(count, begin + kPieceTriangles), bounds, grid, numbering);
    }
    write_run();
    records_ = {};
    tiles_.shrink_to_fit();
}

void SpilledFacets::add_piece(const Scene& scene, std::size_t begin, std::size_t end,
                              const Box& bounds, const Grid& grid, const Numbering& numbering) {
    const Scene piece = piece_of(scene, begin, end);
    const FixedMesh mesh(piece, grid, bounds);
    degenerate_ += mesh.degenerate_triangles();
    non_finite_ += mesh.non_finite_triangles();
    std::vector<std::uint32_t> numbers(end - begin);
    numbering(begin, numbers);

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
                 numbers[mesh.scene_triangle(pair.triangle)]});
            if (records_.size() == max_records_) write_run();
        }
    }
}

void SpilledFacets::write_run() {
    static_assert(sizeof(Record) == kRecordWords * sizeof(std::uint32_t));
    constexpr std::size_t kBlockRecords = kSpillBlockWords / kRecordWords;
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

/// The last block that begins before the tile may end with it.
std::size_t SpilledFacets::first_block(std::size_t run, std::uint32_t tile) const {
    const auto found = std::ranges::lower_bound(runs_[run], tile, {}, &Block::first_tile);
    const auto before = static_cast<std::size_t>(found - runs_[run].begin());
    return before == 0 ? 0 : before - 1;
}

std::span<const std::uint32_t> SpilledFacets::read(std::size_t run, std::size_t block,
                                                   Open& open) const {
    if (open.block != block) {
        open.words.clear();
        open.block = ~std::size_t{0};
        (void)read_block(file_, runs_[run][block].offset, open.words);
        open.block = block;
    }
    return open.words;
}

std::size_t SpilledFacets::first_record(std::span<const std::uint32_t> words, std::uint32_t tile) {
    std::size_t low = 0, high = words.size() / kRecordWords;
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (words[middle * kRecordWords] < tile) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low * kRecordWords;
}

std::array<FixedPoint, 3> SpilledFacets::corners_of(const std::uint32_t* record) {
    std::array<FixedPoint, 3> corners;
    const std::uint32_t* word = record + 1;
    for (FixedPoint& corner : corners) {
        corner = {static_cast<std::int32_t>(word[0]), static_cast<std::int32_t>(word[1]),
                  static_cast<std::int32_t>(word[2]), 0};
        word += 3;
    }
    return corners;
}

}  // namespace octavo
