// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "octavo/attributes/attributes.h"
#include "octavo/attributes/cell_light.h"
#include "octavo/construct/build.h"
#include "octavo/dag/dag.h"
#include "octavo/io/metadata.h"

namespace octavo {

/// A DAG with its place in the world, its origin and its looks: what an .octv file holds.
struct Model {
    Dag dag;
    Metadata metadata;
    Attributes attributes;  // of its cells; may be empty. Their summary in metadata is made by
                            // write_octv() and read_octv()

    CellLight light = {};  // of the same cells; may be empty. metadata.light says what from

    [[nodiscard]] const Grid& grid() const { return metadata.grid; }
};

/// Joins what a build gave with what the scene says. Cameras and lights that are not finite are
/// left out: they cannot be used, and JSON cannot hold them. Surfaces that shine become lamps, see
/// mesh/mesh_lamps.h.
///
/// @param source  the name to remember: of the file, without its folder
/// @param built   without statistics (a DAG that build() did not make), they are counted
[[nodiscard]] Model make_model(std::string source, const Scene& scene, VoxelRule rule,
                               BuildResult built);

}  // namespace octavo
