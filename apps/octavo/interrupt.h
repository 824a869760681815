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

/// While there is one, an interrupt ends the program there and then: for work that cannot be asked
/// to stop and leaves nothing behind.
class EndAtOnce {
public:
    EndAtOnce();
    ~EndAtOnce();
    EndAtOnce(const EndAtOnce&) = delete;
    EndAtOnce& operator=(const EndAtOnce&) = delete;
};

}  // namespace octavo::cli
