// SPDX-License-Identifier: MIT
#pragma once

namespace octavo::cli {

/// From here on the first SIGINT or SIGTERM only sets a flag, so that work can stop in good order;
/// a second one ends the process at once.
void catch_interrupts();

/// Has a signal come?
[[nodiscard]] bool interrupted();

/// 128 + the signal that came: 130 for SIGINT.
[[nodiscard]] int interrupted_exit_code();

/// @throws Error cancelled where a signal has come
void throw_if_interrupted();

}  // namespace octavo::cli
