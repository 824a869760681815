// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "octavo/construct/part_builder.h"
#include "octavo/construct/part_file.h"
#include "octavo/construct/scratch.h"
#include "octavo/core/progress.h"

namespace octavo {

struct MergeOptions {
    std::uint64_t max_bytes = 0;  // of memory for the nodes of a level; 0: no limit
    WordLimits words = {};
    std::filesystem::path scratch;  // a folder for what does not fit; temporary files
    ProgressFunction progress;      // phase "merge", in words
};

/// Joins the parts of neighbouring runs of tiles, given in the order of their tiles, and writes one
/// closed part: what a single store would hold if the tiles had been merged into it one by one, in
/// the same order. Goes up level by level: the nodes of each part, with the new ids of their
/// children, are looked up among those seen so far. A level that the memory cannot hold is cut by
/// hash into pieces that it can, and each piece is done on its own; docs/adr/0008-spilling.md.
///
/// @param out  empty
/// @throws Error  bad_input where a part contradicts itself; io; limit where a level would have
///                too many words; cancelled
void merge_parts(std::span<const std::unique_ptr<PartFile>> parts, PartFile& out,
                 const MergeOptions& options);

/// The same for a list of parts, at least one: a single one is the result itself.
[[nodiscard]] std::unique_ptr<PartFile> merge_into_one(std::vector<std::unique_ptr<PartFile>> parts,
                                                       const Scratch& scratch,
                                                       const MemoryLimits& limits,
                                                       const ProgressFunction& progress);

}  // namespace octavo
