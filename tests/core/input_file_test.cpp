// SPDX-License-Identifier: MIT
#include "octavo/core/input_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "octavo/core/error.h"
#include "octavo/core/file_bytes.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using test::TemporaryFolder;

Errc error_of(const std::filesystem::path& file, std::uint64_t max_bytes = 1000) {
    try {
        (void)read_file(file, max_bytes);
    } catch (const Error& error) {
        return error.code();
    }
    ADD_FAILURE() << file << " was read";
    return Errc::cancelled;
}

TEST(InputFile, IsARegularFileAndNothingElse) {
    const TemporaryFolder folder;
    ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::filesystem::create_symlink("pipe", folder / "to_pipe.hdr");
    std::filesystem::create_symlink("/dev/zero", folder / "to_zero.hdr");
    for (const char* name : {"pipe", "to_pipe.hdr", "to_zero.hdr", "."})
        EXPECT_EQ(error_of(folder / name), Errc::bad_input) << name;
    EXPECT_EQ(error_of(folder / "missing"), Errc::io);
    EXPECT_EQ(error_of(""), Errc::bad_argument);
}

TEST(InputFile, LongerThanAllowedIsNotRead) {
    const TemporaryFolder folder;
    const auto file = folder.write("a", "twelve bytes");
    EXPECT_EQ(read_file(file, 12).view(), "twelve bytes");
    EXPECT_EQ(error_of(file, 11), Errc::limit);
    // A hole takes no room on the disk, and would fill all memory.
    ASSERT_EQ(truncate(file.c_str(), off_t{1} << 42), 0);
    EXPECT_EQ(error_of(file, std::uint64_t{1} << 41), Errc::limit);
}

}  // namespace
}  // namespace octavo
