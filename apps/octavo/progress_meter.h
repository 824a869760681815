// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

#include "octavo/core/progress.h"

namespace octavo::cli {

/// Shows on standard error how far work has come: a bar where that is a terminal, else a line when
/// a phase begins and one every so often; or for programs an object of JSON in each line. Also
/// where work learns of an interrupt.
class ProgressMeter {
public:
    enum class Style {
        quiet,   // nothing; interrupts are still reported
        people,  // a bar, or lines of text
        json,    // lines with the keys phase, seconds, done, total, voxels, voxels_per_second and
                 // seconds_left, of which those that are not known are left out: when a phase
                 // begins, every second, and when it has come to its end
    };
    explicit ProgressMeter(Style style);
    explicit ProgressMeter(bool quiet) : ProgressMeter(quiet ? Style::quiet : Style::people) {}
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
    void show_json(const Progress& progress, double seconds);
    void clear_bar();

    Style style_;
    bool terminal_;
    bool bar_shown_ = false;
    std::string phase_;
    Clock::time_point phase_began_;
    Clock::time_point shown_;
};

}  // namespace octavo::cli
