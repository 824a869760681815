// SPDX-License-Identifier: MIT
#include "octavo/core/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <string>
#include <system_error>

#include "octavo/core/error.h"

namespace octavo {
namespace {

std::filesystem::path folder_of(const std::filesystem::path& file) {
    const std::filesystem::path folder = file.parent_path();
    return folder.empty() ? std::filesystem::path(".") : folder;
}

/// Creates a file that did not exist, hidden, beside the destination. The permissions are what the
/// umask makes of 0666, as for any new file; mkstemp would give 0600.
int create_beside(const std::filesystem::path& destination, std::filesystem::path& created) {
    std::random_device random;
    for (int attempt = 0; attempt < 100; ++attempt) {
        std::string name = ".";
        name += destination.filename().string();
        name += '.';
        name += std::to_string(random());
        name += ".tmp";
        created = folder_of(destination) / name;
        const int descriptor = open(created.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0 || errno != EEXIST) return descriptor;
    }
    return -1;
}

}  // namespace

std::filesystem::path write_destination(const std::filesystem::path& file) {
    constexpr int kMostLinks = 40;  // as the system itself follows
    std::filesystem::path at = file;
    std::error_code failed;
    for (int links = 0; std::filesystem::is_symlink(at, failed); ++links) {
        if (links == kMostLinks)
            throw Error(Errc::io, file, "cannot write: its symbolic links lead in a circle");
        const std::filesystem::path target = std::filesystem::read_symlink(at, failed);
        if (failed) throw Error(Errc::io, file, "cannot write: " + failed.message());
        at = at.parent_path() / target;
    }
    return at;
}

AtomicFile::AtomicFile(const std::filesystem::path& destination)
    : shown_(destination), destination_(write_destination(destination)) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(destination_, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw Error(Errc::io, shown_, "cannot write: it is not a regular file");

    descriptor_ = create_beside(destination_, temporary_);
    if (descriptor_ < 0) throw io_error(shown_, "write");
}

AtomicFile::~AtomicFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::reserve(std::uint64_t size_bytes) {
    if (size_bytes == 0 || fallocate(descriptor_, 0, 0, static_cast<off_t>(size_bytes)) == 0)
        return;
    if (errno == ENOSPC || errno == EDQUOT || errno == EFBIG)
        throw io_error(shown_, "write the " + std::to_string(size_bytes) + " bytes it needs");
}

void AtomicFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
    const std::size_t size = bytes.size();
    while (!bytes.empty()) {
        const ssize_t written =
            pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0)
            throw io_error(shown_, "write " + std::to_string(size) + " bytes after the first " +
                                       std::to_string(offset));
        offset += static_cast<std::uint64_t>(written);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    // Now and then, so that commit() does not wait for gigabytes at once and cannot be stopped.
    constexpr std::uint64_t kSyncBytes = std::uint64_t{64} << 20;
    unsynced_bytes_ += size;
    if (unsynced_bytes_ < kSyncBytes) return;
    unsynced_bytes_ = 0;
    if (fdatasync(descriptor_) != 0) throw io_error(shown_, "write");
}

void AtomicFile::resize(std::uint64_t size_bytes) {
    if (ftruncate(descriptor_, static_cast<off_t>(size_bytes)) != 0)
        throw io_error(shown_, "write");
}

void AtomicFile::commit() {
    if (fsync(descriptor_) != 0) throw io_error(shown_, "write");
    const int closed = close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) throw io_error(shown_, "write");
    if (rename(temporary_.c_str(), destination_.c_str()) != 0) throw io_error(shown_, "replace");
    temporary_.clear();

    // The rename itself is only safe from a power cut once the folder is on disk. Some file systems
    // cannot sync a folder; the file is whole there all the same.
    const int folder = open(folder_of(destination_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return;
    fsync(folder);
    close(folder);
}

}  // namespace octavo
