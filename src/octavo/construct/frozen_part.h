// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "octavo/construct/construct.h"
#include "octavo/construct/part_file.h"

namespace octavo {

/// Makes the finished DAG of a part that has all tiles, without holding it in memory: its words are
/// a mapped temporary file, which goes away with the last Dag that shares it.
///
/// @param depth    the grid's
/// @param scratch  folder for that file
/// @throws Error   limit where the DAG has too many words; io; bad_input; cancelled
[[nodiscard]] Constructed freeze_part(const PartFile& part, int depth,
                                      const std::filesystem::path& scratch,
                                      const ProgressFunction& progress,
                                      const WordLimits& limits = {});

}  // namespace octavo
