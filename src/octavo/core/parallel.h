// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

namespace octavo {

/// Hardware threads that this process may use (its affinity mask, not the machine's count).
[[nodiscard]] int available_threads();

/// Runs the work so that every oneTBB algorithm inside it uses at most this many threads.
///
/// @param threads  1 or more; 0 means all that are available
void with_threads(int threads, const std::function<void()>& work);

}  // namespace octavo
