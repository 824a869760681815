// SPDX-License-Identifier: MIT
#include "interrupt.h"

#include <unistd.h>

#include <csignal>

#include "octavo/core/error.h"

namespace octavo::cli {
namespace {

// Read from worker threads as well; a lock-free atomic int would do the same, less portably to say.
volatile std::sig_atomic_t received_signal = 0;

volatile std::sig_atomic_t end_at_once = 0;

extern "C" void remember_signal(int signal) {
    received_signal = signal;
    if (end_at_once == 0) return;
    constexpr char kMessage[] = "octavo: interrupted\n";
    // Nothing can be done where even this fails.
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
    _exit(128 + signal);
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

EndAtOnce::EndAtOnce() {
    end_at_once = 1;
    throw_if_interrupted();
}

EndAtOnce::~EndAtOnce() {
    end_at_once = 0;
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
