// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "octavo/io/octv.h"

/// What `info` and `build` print about a file, for people and for programs.
namespace octavo::cli {

using Json = nlohmann::ordered_json;

/// The keys are part of the interface: they may be added to, not renamed.
[[nodiscard]] Json summary_json(const OctvSummary& summary);

/// How many nodes and bytes each level has.
[[nodiscard]] Json levels_json(const Statistics& statistics);

/// A table for people, ending in a new line.
[[nodiscard]] std::string summary_table(const OctvSummary& summary);

/// One row for each level.
[[nodiscard]] std::string level_table(const Statistics& statistics);

/// 1234567 -> "1,234,567"
[[nodiscard]] std::string grouped(std::uint64_t number);

/// 1234567 -> "1.23 M"
[[nodiscard]] std::string short_count(double number);

}  // namespace octavo::cli
