// SPDX-License-Identifier: MIT
#include "octavo/core/error.h"

#include <gtest/gtest.h>

namespace octavo {
namespace {

TEST(Error, IsOneLineWhateverItsMessageAndFileHold) {
    EXPECT_STREQ(Error(Errc::bad_input, "no lamp 'a\nb\x7f'").what(), "no lamp 'a\\x0ab\\x7f'");
    const Error error(Errc::bad_input, "new\nline.obj", "a\ttab", 7);
    EXPECT_STREQ(error.what(), "new\\x0aline.obj at byte 7: a\\x09tab");
    EXPECT_EQ(error.file(), "new\nline.obj");
}

TEST(Error, LeavesLettersOfAnyLanguageAlone) {
    EXPECT_STREQ(Error(Errc::io, "Straße 東京 \xff").what(), "Straße 東京 \xff");
}

}  // namespace
}  // namespace octavo
