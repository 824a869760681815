// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

namespace octavo::cli {

/// `octavo bench picture`: whole pictures a second on a device, and what its passes take.
void add_bench_picture(CLI::App& bench);

}  // namespace octavo::cli
