// SPDX-License-Identifier: MIT
#include "octavo/attributes/surface_tiles.h"

#include <limits>
#include <numeric>

#include "octavo/core/error.h"

namespace octavo {

SurfaceTiles::SurfaceTiles(const Scene& scene, const Grid& cells, int tile_depth,
                           const std::filesystem::path& scratch, std::uint64_t buffer_bytes,
                           const ProgressFunction& progress)
    : tile_depth_(tile_depth) {
    if (scene.triangles.size() > std::numeric_limits<std::uint32_t>::max())
        throw Error(Errc::limit, "a scene can have at most 2^32 - 1 triangles");
    if (scratch.empty()) {
        in_memory_.emplace(scene, cells, VoxelRule::conservative, tile_depth);
    } else {
        const auto by_place = [](std::size_t begin, std::span<std::uint32_t> numbers) {
            std::iota(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(begin));
        };
        spilled_.emplace(scene, cells, tile_depth, by_place,
                         DiskSort{scratch / "surfaces", buffer_bytes, progress});
    }
}

}  // namespace octavo
