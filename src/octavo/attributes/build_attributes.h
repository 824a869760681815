// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

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
};

/// Averages what the triangles look like over their area inside each occupied cell.
///
/// A cell gets a second side where triangles in it face away from most of the others, by more than
/// about 105 degrees. A cell that no triangle has area in, because it is only touched at a face, an
/// edge or a corner, gets what the nearest triangle has there: every occupied cell has a colour.
/// The result does not depend on threads, the memory cap or the order of the triangles.
///
/// @param scene    the one that `dag` was built from
/// @param grid     that of `dag`
/// @throws Error   bad_argument where the level is out of range; limit where the memory cap would
/// be
///                 passed; cancelled
/// Cost            O(cells + triangles): about 0.1 us of one core for each cell; memory: the
///                 attributes, 16 bytes for each position and 8 for each pair of a triangle and a
///                 tile of 64^3 cells that it meets, and a tile for each thread
[[nodiscard]] Attributes build_attributes(const Scene& scene, const Dag& dag, const Grid& grid,
                                          const AttributeOptions& options);

}  // namespace octavo
