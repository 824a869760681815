// SPDX-License-Identifier: MIT
#include "octavo/io/mapped_file.h"

#include <sys/mman.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>

#include "octavo/core/error.h"

namespace octavo {
Mapping::~Mapping() {
    if (size_ > 0) munmap(address_, size_);
}

std::shared_ptr<const Mapping> map_file(const std::filesystem::path& path) {
    const InputFile file(path);
    if (file.size() == 0) return std::make_shared<Mapping>(nullptr, 0);
    void* address = mmap(nullptr, file.size(), PROT_READ, MAP_PRIVATE, file.descriptor(), 0);
    if (address == MAP_FAILED) throw io_error(path, "map");
    return std::make_shared<Mapping>(address, file.size());
}

FileCopy::FileCopy(const std::filesystem::path& path)
    : path_(path), file_(path), memory_(allocate_mapping(file_.size())) {}

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
            const ssize_t count = pread(file_.descriptor(), rest.data(), rest.size(), at);
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
