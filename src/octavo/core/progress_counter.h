// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <mutex>
#include <string_view>

#include "octavo/core/progress.h"

namespace octavo {

/// Adds up what many threads have done, and reports it now and then, one thread at a time.
class ProgressCounter {
public:
    /// @param function  outlives this; may be empty
    /// @param total     of the whole work; 0 where it is not known: then every step is reported
    /// @param times     how often at most
    ProgressCounter(const ProgressFunction& function, std::string_view phase, std::uint64_t total,
                    std::uint64_t times = 200)
        : function_(function), phase_(phase), total_(total), step_(total / times) {}

    /// @throws Error cancelled where the function asks to stop
    void add(std::uint64_t done) {
        if (!function_) return;
        const std::lock_guard lock(mutex_);
        done_ += done;
        if (done_ < next_ && done_ < total_) return;
        next_ = done_ + step_;
        report(function_, {phase_, done_, total_});
    }

private:
    const ProgressFunction& function_;
    std::string_view phase_;
    std::uint64_t total_, step_;
    std::mutex mutex_;
    std::uint64_t done_ = 0, next_ = 0;
};

}  // namespace octavo
