// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "octavo/attributes/attributes.h"
#include "octavo/core/grid.h"
#include "octavo/core/progress.h"
#include "octavo/dag/dag.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// What to store for each occupied cell. Emission is stored only where the scene has any.
struct AttributeOptions {
    bool color = true;
    bool emission = true;
    bool normal = false;

    int level = 0;      // of the cells: 2 to the depth; 0: that of 1024^3, or the depth if less
    int tolerance = 0;  // by how much a channel of a colour may differ, in 255ths; 0: lossless

    int threads = 0;                     // 0: all; the result does not depend on it
    std::uint64_t max_memory_bytes = 0;  // for the whole process; 0: no cap
    ProgressFunction progress = {};      // phase "attributes", in tiles

    /// A folder for temporary files, which have no name: under a cap the triangles, the textures
    /// and the attributes themselves go there. Empty: a cap that would be passed is an error.
    std::filesystem::path scratch = {};
    [[nodiscard]] bool is_on_disk() const { return max_memory_bytes != 0 && !scratch.empty(); }

    /// What level 0 stands for.
    [[nodiscard]] static int usual_level(int depth) { return depth < 10 ? depth : 10; }
};

/// The surfaces of a scene, ready to be averaged over cells.
///
/// Memory: the textures at all their sizes, 16 bytes for each position and 8 for each pair of a
/// triangle and a tile of 64^3 cells that it meets; under a cap with a scratch folder all this is
/// on disk, and a few MB.
class AttributeSource {
public:
    /// @param scene    outlives this, unless `options` have a cap and a scratch folder
    /// @param grid     that of the DAG
    /// @throws Error   bad_argument where the level is out of range; io; cancelled
    AttributeSource(const Scene& scene, const Grid& grid, const AttributeOptions& options);
    ~AttributeSource();
    AttributeSource(AttributeSource&&) noexcept;
    AttributeSource& operator=(AttributeSource&&) noexcept;

    /// Pictures that could not be read.
    [[nodiscard]] const std::vector<std::string>& warnings() const;

    /// Averages what the triangles look like over their area inside each occupied cell.
    ///
    /// A cell gets a second side where triangles in it face away from most of the others, by more
    /// than about 105 degrees. A cell that no triangle has area in, because it is only touched at a
    /// face, an edge or a corner, gets what the nearest triangle has there: every occupied cell has
    /// a colour. The result does not depend on threads, the memory cap or the order of the
    /// triangles.
    ///
    /// @param dag      built from the scene
    /// @throws Error   limit where the memory cap would be passed; io; cancelled
    /// Cost            O(cells + triangles): about 0.2 us of one core for each cell; memory: the
    ///                 attributes, unless they are on disk, 4 bytes for each word of the DAG above
    ///                 the cells' level, and a tile for each thread
    [[nodiscard]] Attributes average(const Dag& dag) const;

private:
    class Parts;
    std::unique_ptr<Parts> parts_;
};

/// All of it at once: what AttributeSource(scene, grid, options).average(dag) gives.
[[nodiscard]] Attributes build_attributes(const Scene& scene, const Dag& dag, const Grid& grid,
                                          const AttributeOptions& options);

}  // namespace octavo
