// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace octavo::cli {

/// Makes the help of a command begin with examples, one a line, each indented by two blanks.
void set_help(CLI::App& command, std::string examples);

}  // namespace octavo::cli
