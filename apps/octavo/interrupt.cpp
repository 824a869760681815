// SPDX-License-Identifier: MIT
#include "interrupt.h"

#include <csignal>

#include "octavo/core/error.h"

namespace octavo::cli {
namespace {

// Read from worker threads as well; a lock-free atomic int would do the same, less portably to say.
volatile std::sig_atomic_t received_signal = 0;

extern "C" void remember_signal(int signal) {
    received_signal = signal;
}

}  // namespace

void catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = remember_signal;
    // The handler is for one signal only: the next one has the default effect.
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
    return received_signal != 0;
}

int interrupted_exit_code() {
    return 128 + (interrupted() ? received_signal : SIGINT);
}

void throw_if_interrupted() {
    if (interrupted()) throw Error(Errc::cancelled, "interrupted");
}

}  // namespace octavo::cli
