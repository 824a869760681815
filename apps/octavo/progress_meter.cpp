// SPDX-License-Identifier: MIT
#include "progress_meter.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "interrupt.h"
#include "summary.h"

namespace octavo::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto kBarInterval = 100ms;
constexpr auto kLineInterval = 10s;
constexpr auto kJsonInterval = 1s;
constexpr int kBarWidth = 24;

std::string bar(double fraction) {
    const int full = static_cast<int>(fraction * kBarWidth);
    return fmt::format("[{:#<{}}{:.<{}}]", "", full, "", kBarWidth - full);
}

std::string clock_text(double seconds) {
    const auto whole = static_cast<long>(std::ceil(seconds));
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

/// What is known beside the fraction: voxels and their rate, and the time left.
std::string details(const Progress& progress, double fraction, double seconds) {
    std::string text;
    if (progress.voxels > 0 && seconds > 0.0)
        text += fmt::format("  {} voxels  {}/s", short_count(static_cast<double>(progress.voxels)),
                            short_count(static_cast<double>(progress.voxels) / seconds));
    // An estimate from the first moments of a phase jumps about and helps nobody.
    if (fraction > 0.02 && fraction < 1.0 && seconds > 0.5)
        text += fmt::format("  {} left", clock_text(seconds / fraction * (1.0 - fraction)));
    return text;
}

}  // namespace

ProgressMeter::ProgressMeter(Style style)
    : style_(style),
      terminal_(style == Style::people && isatty(STDERR_FILENO) == 1),
      phase_began_(Clock::now()) {
    catch_interrupts();
}

ProgressMeter::~ProgressMeter() {
    clear_bar();
}

ProgressFunction ProgressMeter::function() {
    return [this](const Progress& progress) { return update(progress); };
}

void ProgressMeter::begin_phase(const std::string& phase) {
    update({.phase = phase});
}

bool ProgressMeter::update(const Progress& progress) {
    if (interrupted()) return false;
    if (style_ == Style::quiet) return true;
    const Clock::time_point now = Clock::now();
    const bool new_phase = phase_ != progress.phase;
    if (new_phase) {
        clear_bar();
        phase_ = progress.phase;
        phase_began_ = now;
    }
    const bool json = style_ == Style::json;
    const Clock::duration interval = json        ? Clock::duration(kJsonInterval)
                                     : terminal_ ? Clock::duration(kBarInterval)
                                                 : kLineInterval;
    const bool at_end = json && progress.total > 0 && progress.done == progress.total;
    if (new_phase || at_end || now - shown_ >= interval) {
        const double seconds = std::chrono::duration<double>(now - phase_began_).count();
        if (json) {
            show_json(progress, seconds);
        } else {
            show(progress, seconds);
        }
        shown_ = now;
    }
    return true;
}

void ProgressMeter::show(const Progress& progress, double seconds) {
    const double fraction = progress.total == 0
                                ? 0.0
                                : std::min(1.0, static_cast<double>(progress.done) /
                                                    static_cast<double>(progress.total));
    const std::string percent =
        progress.total == 0 ? "" : fmt::format("{:4.0f}%", 100.0 * fraction);
    const std::string more = details(progress, fraction, seconds);
    if (terminal_) {
        const std::string middle = progress.total == 0 ? "" : bar(fraction) + percent;
        // ESC [K removes what a longer line before left behind.
        fmt::print(stderr, "\r{:<10} {}{}\033[K", phase_, middle, more);
        bar_shown_ = true;
    } else {
        fmt::print(stderr, "{}{}\n", phase_, seconds > 0.0 ? percent + more : "");
    }
    std::fflush(stderr);
}

void ProgressMeter::show_json(const Progress& progress, double seconds) {
    Json line = {{"phase", phase_}, {"seconds", seconds}};
    if (progress.total > 0) {
        line["done"] = progress.done;
        line["total"] = progress.total;
    }
    if (progress.voxels > 0) {
        line["voxels"] = progress.voxels;
        if (seconds > 0.0)
            line["voxels_per_second"] = static_cast<double>(progress.voxels) / seconds;
    }
    if (progress.total > 0 && progress.done > 0)
        line["seconds_left"] =
            seconds / static_cast<double>(progress.done) *
            static_cast<double>(progress.total - std::min(progress.total, progress.done));
    fmt::print(stderr, "{}\n", line.dump());
    std::fflush(stderr);
}

void ProgressMeter::clear_bar() {
    if (bar_shown_) fmt::print(stderr, "\r\033[K");
    bar_shown_ = false;
}

}  // namespace octavo::cli
