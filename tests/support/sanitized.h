// SPDX-License-Identifier: MIT
#pragma once

namespace octavo::test {

/// Whether this is compiled with a sanitizer, under which brute force takes 10 to 100 times as
/// long: tests that only gain by numbers take fewer.
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// Whether a failed allocation ends the program, as it does under the thread sanitizer, and throws
/// nothing.
#if defined(__SANITIZE_THREAD__)
inline constexpr bool kAllocationsMayNotFail = true;
#else
inline constexpr bool kAllocationsMayNotFail = false;
#endif

}  // namespace octavo::test
