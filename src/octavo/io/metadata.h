// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octavo/core/grid.h"
#include "octavo/dag/statistics.h"
#include "octavo/mesh/scene.h"
#include "octavo/voxelize/rule.h"

namespace octavo {

/// Which cells the file's attributes are of.
struct AttributeSummary {
    int level = 0;            // of the cells
    std::uint64_t cells = 0;  // that are occupied
    int tolerance = 0;        // by how much a channel of a colour may differ, in 255ths
};

/// Kinds of lights as metadata has them.
inline constexpr std::array<std::string_view, 6> kLightKindNames = {"sun",  "point",     "spot",
                                                                    "disc", "rectangle", "mesh"};
[[nodiscard]] constexpr std::string_view name(Light::Kind kind) {
    return kLightKindNames[static_cast<std::size_t>(kind)];
}

/// What the light stored in a file came from.
struct LightSummary {
    int bounces = 0;            // 0 to 8
    std::vector<Light> lights;  // world space
    std::string sky;            // as the command line writes it
};

/// What an .octv file says about its DAG: how it was made, where it lies in the world, and what it
/// holds. Only what follows from the input and the options: no times, thread counts or machine
/// paths, so that the same input gives the same file.
struct Metadata {
    std::string source;  // file name of the scene without its folder, or "sample:NAME"
    VoxelRule rule = VoxelRule::conservative;
    Grid grid;
    std::uint64_t triangles = 0;
    std::uint64_t degenerate_triangles = 0;
    std::uint64_t non_finite_triangles = 0;
    std::vector<Camera> cameras;  // from the scene; world space
    std::vector<Light> lights;
    Statistics statistics;
    std::optional<AttributeSummary> attributes;  // none: the file has none
    std::optional<LightSummary> light;           // the same
};

/// As JSON text without spaces. Numbers in double are written so that they read back exactly.
/// @throws Error bad_argument  where a camera or light is not finite
[[nodiscard]] std::string encode_metadata(const Metadata& metadata);

/// Reads what encode_metadata wrote. Every field is checked for its type and range: depth 2 to 17,
/// a finite transform, one entry for each level, no more voxels and nodes than the depth allows.
/// Fields it does not know are passed over.
///
/// @throws Error bad_input  naming the field, or the byte of the text where it is not JSON
/// Cost: bounded by the text's length; at most a million values, nested at most 8 deep
[[nodiscard]] Metadata decode_metadata(std::string_view json);

/// The level begins of the DAG that this metadata describes, as Dag wants them.
[[nodiscard]] std::vector<std::uint64_t> level_begins(const Statistics& statistics);

}  // namespace octavo
