// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "octavo/mesh/scene.h"

namespace octavo {

/// Triangles that the lamps of one scene hold together: a few MB in a file's metadata.
inline constexpr std::size_t kMostLampTriangles = 16384;

/// The scene's surfaces that shine: for each material with an emission a lamp of kind mesh, of its
/// name, with its triangles. Triangles without area or that are not finite are left out, and so are
/// materials whose emission comes from a texture, since most of such a surface may be dark.
///
/// A lamp keeps its share of `most` triangles, the largest ones. Where it has more, its radiance
/// goes up by as much as its area goes down, so that it gives the same light.
///
/// Cost: one pass over the triangles, and a sort of those that shine.
[[nodiscard]] std::vector<Light> mesh_lamps(const Scene& scene,
                                            std::size_t most = kMostLampTriangles);

}  // namespace octavo
