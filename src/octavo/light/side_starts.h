// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "octavo/light/lit_scene.h"
#include "octavo/trace/dag_view.h"

namespace octavo {

/// The places on a side of a cell from which its rays start: on faces of voxels that open space
/// lies before, and that are seen from the cell's face in this direction.
struct SideStarts {
    static constexpr int kMost = 4;

    std::array<shared::GridRay, kMost> rays{};  // without a direction
    int count = 0;                              // 0: nothing of the cell is seen from there

    /// @param cell       of the object's attributes
    /// @param direction  2 * axis + (1 for +axis)
    SideStarts(const LitObject& object, const uvec3& cell, int direction);
};

/// For the random numbers of a side of a cell.
[[nodiscard]] std::uint32_t side_seed(const uvec3& cell, int direction, int pass);

/// The smoothed normal of the surface that is seen from a direction; none where there is none.
[[nodiscard]] std::optional<vec3> side_normal(const LitObject& object, const uvec3& cell,
                                              int direction);

}  // namespace octavo
