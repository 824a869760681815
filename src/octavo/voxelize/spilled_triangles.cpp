// SPDX-License-Identifier: MIT
#include "octavo/voxelize/spilled_triangles.h"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "octavo/core/error.h"
#include "octavo/core/morton.h"
#include "octavo/voxelize/tile_rasterizer.h"

namespace octavo {
namespace {

// Rasterized at once: a tile may hold any number.
constexpr std::size_t kBatch = 4096;

static_assert(std::is_trivially_copyable_v<CutOuts::Triangle>);

std::unique_ptr<SpillFile> file_for_holes(const CutOuts& cut_outs, std::filesystem::path file) {
    if (cut_outs.empty()) return nullptr;
    file += ".holes";
    return std::make_unique<SpillFile>(file, SpillFile::Kind::temporary);
}

}  // namespace

/// Triangles of one tile that are rasterized together.
class SpilledTriangles::Batch final : public HoleLookup {
public:
    explicit Batch(const SpillFile* holes_file) : holes_file_(holes_file) {}

    [[nodiscard]] std::size_t size() const { return corners_.size(); }
    void add(const std::array<FixedPoint, 3>& corners, std::uint32_t holes) {
        corners_.push_back(corners);
        holes_.push_back(holes);
    }

    /// Empties the batch.
    void rasterize(const FixedMesh::Frame& frame, std::uint32_t tile, VoxelRule rule,
                   TileBitmap& bitmap) {
        std::vector<TileTriangle> pairs;
        for (std::uint32_t i = 0; i < corners_.size(); ++i) pairs.push_back({tile, i});
        const FixedMesh mesh(frame, std::move(corners_));
        rasterize_tile(mesh, holes_file_ != nullptr ? this : nullptr, pairs, morton_decode(tile),
                       rule, bitmap);
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
                                   int tile_depth, const DiskSort& sort)
    : rule_(rule),
      cut_outs_(scene, grid),
      holes_file_(file_for_holes(cut_outs_, sort.file)),
      facets_(
          scene, grid, tile_depth,
          [this](std::size_t begin, std::span<std::uint32_t> numbers) {
              number_by_holes(begin, numbers);
          },
          sort),
      bitmaps_([tile_depth] { return TileBitmap(tile_depth); }) {
    cut_outs_.forget_triangles();
}

void SpilledTriangles::number_by_holes(std::size_t begin, std::span<std::uint32_t> numbers) {
    std::ranges::fill(numbers, kNoHoles);
    if (!holes_file_) return;
    std::vector<CutOuts::Triangle> found;
    CutOuts::Triangle one;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (!cut_outs_.find(begin + i, one)) continue;
        numbers[i] = hole_count_ + static_cast<std::uint32_t>(found.size());
        found.push_back(one);
    }
    holes_file_->write(std::uint64_t{hole_count_} * sizeof one, found.data(),
                       found.size() * sizeof one);
    hole_count_ += static_cast<std::uint32_t>(found.size());
}

void SpilledTriangles::voxelize(std::size_t index, TileOctree& octree) const {
    TileBitmap& bitmap = bitmaps_.local();
    const auto tile = static_cast<std::uint32_t>(tiles()[index]);
    Batch batch(holes_file_.get());
    const auto rasterize = [&] { batch.rasterize(facets_.frame(), tile, rule_, bitmap); };
    facets_.for_each(tile, [&](const std::array<FixedPoint, 3>& corners, std::uint32_t holes) {
        batch.add(corners, holes);
        if (batch.size() == kBatch) rasterize();
    });
    if (batch.size() != 0) rasterize();
    bitmap.take(octree);
}

}  // namespace octavo
