// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

namespace octavo {

/// Which voxels a triangle marks. Both are exact; docs/voxel-rules.md states them in full.
enum class VoxelRule {
    conservative,  // the closed triangle meets the closed cube of the voxel
    thin,          // 6-separating, Schwarz and Seidel 2010, with their one-sided edge test
};

[[nodiscard]] constexpr std::string_view name(VoxelRule rule) {
    return rule == VoxelRule::conservative ? "conservative" : "thin";
}

[[nodiscard]] constexpr std::optional<VoxelRule> voxel_rule_from_name(std::string_view text) {
    if (text == "conservative") return VoxelRule::conservative;
    if (text == "thin") return VoxelRule::thin;
    return std::nullopt;
}

}  // namespace octavo
