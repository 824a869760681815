// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

#include "octavo/core/progress.h"

namespace octavo::cli {

/// Shows how far work has come: a bar on standard error where that is a terminal, else a line when
/// a phase begins and one every so often. Also where work learns of an interrupt.
class ProgressMeter {
public:
    /// @param quiet  shows nothing, and still reports interrupts
    explicit ProgressMeter(bool quiet);
    ~ProgressMeter();
    ProgressMeter(const ProgressMeter&) = delete;
    ProgressMeter& operator=(const ProgressMeter&) = delete;

    /// For the options of the library; the meter must outlive it.
    [[nodiscard]] ProgressFunction function();

    /// A phase that reports nothing while it runs.
    void begin_phase(const std::string& phase);

    /// Removes the bar, so that something else can be printed. Also done at the end.
    void finish() { clear_bar(); }

private:
    using Clock = std::chrono::steady_clock;

    bool update(const Progress& progress);
    void show(const Progress& progress, double seconds);
    void clear_bar();

    bool quiet_;
    bool terminal_;
    bool bar_shown_ = false;
    std::string phase_;
    Clock::time_point phase_began_;
    Clock::time_point shown_;
};

}  // namespace octavo::cli
