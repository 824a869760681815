// SPDX-License-Identifier: MIT
#include "octavo/io/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <utility>

#include "octavo/core/error.h"

namespace octavo {
namespace {

class OpenFile {
public:
    explicit OpenFile(const std::filesystem::path& path)
        // Without O_NONBLOCK, opening a named pipe would wait for a writer for ever.
        : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
        struct stat status {};
        if (descriptor_ < 0 || fstat(descriptor_, &status) != 0) throw io_error(path, "read");
        if (!S_ISREG(status.st_mode)) {
            close(descriptor_);
            throw Error(Errc::io, path, "cannot read: it is not a regular file");
        }
        size_ = static_cast<std::size_t>(status.st_size);
    }
    ~OpenFile() {
        if (descriptor_ >= 0) close(descriptor_);
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;

    [[nodiscard]] int descriptor() const { return descriptor_; }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] int release() { return std::exchange(descriptor_, -1); }

private:
    int descriptor_;
    std::size_t size_ = 0;
};

}  // namespace

Mapping::~Mapping() {
    if (size_ > 0) munmap(address_, size_);
}

std::shared_ptr<const Mapping> map_file(const std::filesystem::path& path) {
    const OpenFile file(path);
    if (file.size() == 0) return std::make_shared<Mapping>(nullptr, 0);
    void* address = mmap(nullptr, file.size(), PROT_READ, MAP_PRIVATE, file.descriptor(), 0);
    if (address == MAP_FAILED) throw io_error(path, "map");
    return std::make_shared<Mapping>(address, file.size());
}

FileCopy::FileCopy(const std::filesystem::path& path) : path_(path) {
    OpenFile file(path);
    memory_ = allocate_mapping(file.size());
    descriptor_ = file.release();
}

FileCopy::~FileCopy() {
    close(descriptor_);
}

void FileCopy::fetch(std::uint64_t offset, std::uint64_t size) {
    const std::span<std::byte> all = memory_->writable_bytes();
    offset = std::min<std::uint64_t>(offset, all.size());
    const std::span<std::byte> part =
        all.subspan(offset, std::min<std::uint64_t>(size, all.size() - offset));
    // Most of the time goes into the kernel's copy and into the pages that it fills.
    constexpr std::size_t kPiece = std::size_t{8} << 20;
    tbb::parallel_for(std::size_t{0}, (part.size() + kPiece - 1) / kPiece, [&](std::size_t piece) {
        const std::size_t first = piece * kPiece;
        std::span<std::byte> rest = part.subspan(first, std::min(kPiece, part.size() - first));
        auto at = static_cast<off_t>(offset + first);
        while (!rest.empty()) {
            const ssize_t count = pread(descriptor_, rest.data(), rest.size(), at);
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) throw io_error(path_, "read");
            if (count == 0)
                throw Error(Errc::io, path_, "cannot read: it became shorter meanwhile");
            rest = rest.subspan(static_cast<std::size_t>(count));
            at += count;
        }
    });
}

std::shared_ptr<Mapping> allocate_mapping(std::uint64_t size_bytes) {
    if (size_bytes == 0) return std::make_shared<Mapping>(nullptr, 0);
    void* address = mmap(nullptr, size_bytes, PROT_READ | PROT_WRITE,
                         MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (address == MAP_FAILED)
        throw Error(Errc::limit, "no memory for " + std::to_string(size_bytes) + " bytes");
    // Fewer page faults while it is filled, and fewer misses of the TLB when rays read it; where
    // the system has no huge pages the advice does nothing.
    madvise(address, size_bytes, MADV_HUGEPAGE);
    return std::make_shared<Mapping>(address, size_bytes);
}

}  // namespace octavo
