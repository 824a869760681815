// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/voxelize/voxel_source.h"

namespace octavo::bench {

/// Reduction as [K13] section 3 describes it: every level's nodes are sorted, equal ones merged and
/// the parents' pointers set anew. What unique tables are measured against.
///
/// @param leaves  of a whole region of 2^depth voxels a side, in Morton order
/// @return        the number of unique nodes, leaves included
[[nodiscard]] std::uint64_t reduce_by_sorting(const std::vector<LeafBlock>& leaves, int depth);

}  // namespace octavo::bench
