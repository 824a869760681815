// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

namespace octavo::cli {

/// `octavo bench trace`: rays a second on a flight through a DAG, as in [K13] figures 6 to 8,
/// against the triangles and against NanoVDB.
void add_bench_trace(CLI::App& bench);

}  // namespace octavo::cli
