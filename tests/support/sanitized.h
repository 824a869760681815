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

}  // namespace octavo::test
