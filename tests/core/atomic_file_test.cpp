// SPDX-License-Identifier: MIT
#include "octavo/core/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <string>

#include "octavo/core/error.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using test::file_content;
using test::TemporaryFolder;
using test::write_file;

void write_text(AtomicFile& file, const std::string& text, std::uint64_t offset = 0) {
    file.write(offset, std::as_bytes(std::span(text)));
}

TEST(AtomicFile, LeavesTheOldFileUntilCommitted) {
    const TemporaryFolder folder;
    write_file(folder / "a", "old");
    {
        AtomicFile file(folder / "a");
        write_text(file, "new content");
        EXPECT_EQ(file_content(folder / "a"), "old");
    }
    EXPECT_EQ(file_content(folder / "a"), "old");
    EXPECT_EQ(folder.entries(), 1u) << "the temporary file is still there";
}

TEST(AtomicFile, ReplacesTheOldFileOnCommit) {
    const TemporaryFolder folder;
    write_file(folder / "a", "an old and longer one");
    AtomicFile file(folder / "a");
    write_text(file, "tail", 4);
    write_text(file, "head");
    file.commit();
    EXPECT_EQ(file_content(folder / "a"), "headtail");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, GivesTheUsualPermissions) {
    const TemporaryFolder folder;
    const mode_t old_mask = umask(022);
    AtomicFile file(folder / "a");
    file.commit();
    umask(old_mask);
    struct stat status {};
    ASSERT_EQ(stat((folder / "a").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0644u);
}

TEST(AtomicFile, MakesTheTargetOfALinkThatLeadsToNothing) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("second", folder / "first");
    std::filesystem::create_symlink("target", folder / "second");
    AtomicFile file(folder / "first");
    write_text(file, "text");
    file.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "first"));
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "second"));
    EXPECT_EQ(file_content(folder / "target"), "text");
}

TEST(AtomicFile, LinksInACircleAreAnError) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("b", folder / "a");
    std::filesystem::create_symlink("a", folder / "b");
    EXPECT_THROW(AtomicFile(folder / "a"), Error);
}

TEST(AtomicFile, ReplacesTheTargetOfALink) {
    const TemporaryFolder folder;
    write_file(folder / "target", "old");
    std::filesystem::create_symlink("target", folder / "link");
    AtomicFile file(folder / "link");
    write_text(file, "new");
    file.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
    EXPECT_EQ(file_content(folder / "target"), "new");
}

TEST(AtomicFile, RefusesWhatIsNoRegularFile) {
    const TemporaryFolder folder;
    EXPECT_THROW(AtomicFile(folder.path()), Error);
    EXPECT_THROW(AtomicFile("/dev/null"), Error);
    EXPECT_THROW(AtomicFile(folder / "missing" / "a"), Error);
}

TEST(AtomicFile, LeavesTheOldFileWhenTheDiskIsFull) {
    const TemporaryFolder folder;
    write_file(folder / "a", "old");
    // A limit on file size stands in for the full disk: pwrite fails after so many bytes.
    struct rlimit old_limit {};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    struct rlimit limit = old_limit;
    limit.rlim_cur = 5;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
    Errc code = Errc::cancelled;
    try {
        AtomicFile file(folder / "a");
        write_text(file, "longer than five");
        file.commit();
    } catch (const Error& error) {
        code = error.code();
    }
    setrlimit(RLIMIT_FSIZE, &old_limit);
    (void)std::signal(SIGXFSZ, old_handler);
    EXPECT_EQ(code, Errc::io);
    EXPECT_EQ(file_content(folder / "a"), "old");
    EXPECT_EQ(folder.entries(), 1u);
}

}  // namespace
}  // namespace octavo
