// SPDX-License-Identifier: MIT
#pragma once

#include "summary.h"

namespace octavo::cli {

/// What must stand beside a figure: the program's version and commit, the time, and the machine's
/// processor, threads, memory and best vector instructions.
[[nodiscard]] Json circumstances_json(int threads);

}  // namespace octavo::cli
