// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "octavo/io/finding.h"
#include "octavo/io/octv.h"

namespace octavo {

struct ValidateOptions {
    /// Also what wastes room or time and harms nothing: equal nodes, nodes that nothing leads to,
    /// another order than docs/adr/0003-node-order.md says, padding that is not zero, trailing
    /// bytes.
    bool strict = false;
    std::size_t max_findings = 100;
    /// As in OctvReadOptions.
    std::uint64_t max_dag_bytes = std::uint64_t{16} << 30;
};

/// What there is to say about a file.
struct Validation {
    std::vector<Finding> findings;  // none: the file is what it says
    std::uint64_t file_bytes = 0;
    Statistics statistics;     // of the DAG, counted; where there are no findings
    OctvReadTimes times;       // of what read_octv does as well
    double extra_seconds = 0;  // for all that it does not do

    [[nodiscard]] bool valid() const { return findings.empty(); }
};

/// Says all that is wrong with a file. Whatever read_octv refuses has a finding, as its own reader
/// is what runs here; beyond that, the octree nodes that the metadata states for each level are
/// counted.
///
/// Reading ends at the first layer with findings: a damaged table says nothing about the nodes.
///
/// @throws Error  io where the file cannot be read. What is wrong with its content is a finding.
/// Cost           as read_octv; one more visit of every node; strict: a sort of every level
[[nodiscard]] Validation validate_octv(const std::filesystem::path& path,
                                       const ValidateOptions& options = {});

}  // namespace octavo
