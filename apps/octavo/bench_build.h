// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

namespace octavo::cli {

/// `octavo bench build`: the rows of [K13] tables 1 and 2, measured on this machine.
void add_bench_build(CLI::App& bench);

}  // namespace octavo::cli
