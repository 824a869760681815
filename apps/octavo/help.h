// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace octavo::cli {

/// Makes the help of a command begin with examples, one a line, each indented by two blanks.
void set_help(CLI::App& command, std::string examples);

/// The options that are added to a command from here on stand below this heading in its help.
void begin_group(CLI::App& command, const std::string& heading);

}  // namespace octavo::cli
