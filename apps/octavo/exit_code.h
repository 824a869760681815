// SPDX-License-Identifier: MIT
#pragma once

#include <exception>
#include <new>

#include "interrupt.h"
#include "octavo/core/error.h"

namespace octavo::cli {

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kUsage = 2;
inline constexpr int kBadInput = 3;
inline constexpr int kLimit = 4;

/// With which the program ends when this has been thrown.
[[nodiscard]] inline int exit_code(const std::exception& thrown) {
    if (dynamic_cast<const std::bad_alloc*>(&thrown) != nullptr) return kLimit;
    const auto* error = dynamic_cast<const Error*>(&thrown);
    if (error == nullptr) return kFailed;
    switch (error->code()) {
        case Errc::bad_argument:
            return kUsage;
        case Errc::bad_input:
            return kBadInput;
        case Errc::unsupported:  // of a file; else an option that this build or machine has not
            return error->file().empty() ? kUsage : kBadInput;
        case Errc::limit:
            return kLimit;
        case Errc::cancelled:
            return interrupted_exit_code();
        case Errc::io:
            break;
    }
    return kFailed;
}

}  // namespace octavo::cli
