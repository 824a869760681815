// SPDX-License-Identifier: MIT
#include "octavo/core/mapped_words.h"

#include <sys/mman.h>
#include <unistd.h>

#include "octavo/core/error.h"

namespace octavo {

void release_pages(std::span<const std::uint32_t> words) {
    const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    const auto begin = reinterpret_cast<std::uintptr_t>(words.data()) / page * page;
    const auto end = reinterpret_cast<std::uintptr_t>(words.data() + words.size()) / page * page;
    // Advice; the pages are the file's and unchanged, so they read the same afterwards.
    if (begin < end) (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
}

MappedWords::MappedWords(const SpillFile& file, std::uint64_t words)
    : size_(words * sizeof(std::uint32_t)) {
    if (size_ == 0) return;
    address_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.descriptor(), 0);
    if (address_ == MAP_FAILED) throw io_error(file.path(), "map");
}

MappedWords::~MappedWords() {
    if (size_ > 0) munmap(address_, size_);
}

}  // namespace octavo
