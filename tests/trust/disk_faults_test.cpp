// SPDX-License-Identifier: MIT
// The system's file functions, replaced by ones that fail, stop short, or end the process.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include "io/small_model.h"
#include "octavo/core/error.h"
#include "octavo/io/octv.h"
#include "support/temporary_folder.h"

namespace {

struct Faults {
    int fail_at = -1;  // this call fails with `error`
    int error = EIO;
    bool kill = false;                   // instead of failing, the process ends
    std::size_t most = ~std::size_t{0};  // bytes that one call moves
    bool interrupt = false;              // every other call is interrupted first
    bool recording = false;

    int calls = 0;
    bool interrupted_last = false;
    std::string record = {};  // w: pwrite, t: ftruncate, s: fsync, r: rename, R: pread
};
Faults faults;

/// @return whether the call fails, with errno set
bool fault(char call) {
    if (!faults.recording) return false;
    faults.record += call;
    if (faults.interrupt && call != 's' && call != 'r' && call != 't') {
        faults.interrupted_last = !faults.interrupted_last;
        if (faults.interrupted_last) {
            errno = EINTR;
            return true;
        }
    }
    if (faults.calls++ != faults.fail_at) return false;
    if (faults.kill) raise(SIGKILL);
    errno = faults.error;
    return true;
}

}  // namespace

// The program's own definitions come before the C library's.
extern "C" {
ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t offset) {
    if (fault('w')) return -1;
    return syscall(SYS_pwrite64, descriptor, bytes, std::min(count, faults.most), offset);
}
ssize_t pread(int descriptor, void* bytes, size_t count, off_t offset) {
    if (fault('R')) return -1;
    return syscall(SYS_pread64, descriptor, bytes, std::min(count, faults.most), offset);
}
int ftruncate(int descriptor, off_t size) noexcept {
    return fault('t') ? -1 : static_cast<int>(syscall(SYS_ftruncate, descriptor, size));
}
int fsync(int descriptor) {
    return fault('s') ? -1 : static_cast<int>(syscall(SYS_fsync, descriptor));
}
int rename(const char* from, const char* to) noexcept {
    return fault('r') ? -1 : static_cast<int>(syscall(SYS_rename, from, to));
}
}

namespace octavo {
namespace {

using test::file_content;
using test::TemporaryFolder;

class DiskFaults : public testing::Test {
protected:
    DiskFaults() {
        faults = {};
        write_octv(folder / "whole", model);
        whole = file_content(folder / "whole");
        std::filesystem::remove(folder / "whole");
        test::write_file(file, "old");
    }
    ~DiskFaults() override { faults = {}; }

    void write() {
        faults.recording = true;
        write_octv(file, model);
        faults.recording = false;
    }

    TemporaryFolder folder;
    Model model = test::small_model();
    std::filesystem::path file = folder / "a.octv";
    std::string whole;
};

TEST_F(DiskFaults, WritesAreSyncedBeforeTheRenameAndTheFolderAfterIt) {
    write();
    // After a loss of power a file holds what was synced: everything, before it gets its name.
    const std::size_t last_write = faults.record.find_last_of("wt");
    EXPECT_EQ(faults.record.substr(last_write + 1), "srs") << faults.record;
    EXPECT_EQ(file_content(file), whole);
}

TEST_F(DiskFaults, EveryFailingCallLeavesTheOldFileOrTheWholeNewOne) {
    for (const int error : {EIO, ENOSPC}) {
        for (int n = 0;; ++n) {
            test::write_file(file, "old");
            faults = {.fail_at = n, .error = error};
            try {
                write();
                // Only the sync of the folder may fail without a word: the file is there.
                EXPECT_EQ(file_content(file), whole);
                if (faults.calls <= n) break;
            } catch (const Error& caught) {
                EXPECT_EQ(caught.code(), Errc::io);
                EXPECT_EQ(file_content(file), "old") << "call " << n;
            }
            faults = {};
            ASSERT_EQ(folder.entries(), 1u) << "call " << n << " left a temporary file";
        }
    }
}

TEST_F(DiskFaults, BeingKilledAtEveryCallLeavesTheOldFileOrTheWholeNewOne) {
    int killed = 0;
    int old_files = 0;
    for (int n = 0;; ++n) {
        test::write_file(file, "old");
        const pid_t child = fork();
        if (child == 0) {
            faults = {.fail_at = n, .kill = true};
            write();
            _exit(0);
        }
        int status = 0;
        waitpid(child, &status, 0);
        const std::string content = file_content(file);
        ASSERT_TRUE(content == "old" || content == whole) << "killed at call " << n;
        if (!WIFSIGNALED(status)) break;
        ++killed;
        old_files += content == "old";
    }
    EXPECT_GE(killed, 5);
    EXPECT_GE(old_files, 4);
    // What was killed could not tidy up: its temporary file is hidden, and no later write minds it.
    write();
    EXPECT_EQ(file_content(file), whole);
}

TEST_F(DiskFaults, ShortAndInterruptedWritesGoOn) {
    faults.most = 100;
    faults.interrupt = true;
    write();
    EXPECT_EQ(file_content(file), whole);
}

TEST_F(DiskFaults, ShortAndInterruptedReadsGoOn) {
    write();
    faults = {.most = 100, .interrupt = true, .recording = true};
    const Model read = read_octv(file);
    faults.recording = false;
    EXPECT_GT(faults.record.size(), 20u);
    EXPECT_TRUE(std::ranges::equal(read.dag.words(), model.dag.words()));
}

TEST_F(DiskFaults, EveryFailingReadIsAnErrorOfTheDisk) {
    write();
    int failed = 0;
    for (int n = 0;; ++n) {
        faults = {.fail_at = n, .recording = true};
        try {
            (void)read_octv(file);
            if (faults.calls <= n) break;
            ADD_FAILURE() << "call " << n << " failed and nobody noticed";
        } catch (const Error& error) {
            faults.recording = false;
            EXPECT_EQ(error.code(), Errc::io) << error.what();
            EXPECT_EQ(error.file(), file);
            ++failed;
        }
    }
    EXPECT_GE(failed, 3);
}

TEST_F(DiskFaults, FileThatIsCutOffAfterItWasReadChangesNothing) {
    write();
    const Model read = read_octv(file);
    ASSERT_EQ(::truncate(file.c_str(), 0), 0);
    EXPECT_TRUE(std::ranges::equal(read.dag.words(), model.dag.words()));
    test::write_file(file, std::string(whole.size(), '\xff'));
    EXPECT_TRUE(std::ranges::equal(read.dag.words(), model.dag.words()));
}

}  // namespace
}  // namespace octavo
