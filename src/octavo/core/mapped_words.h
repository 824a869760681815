// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "octavo/core/spill_file.h"

namespace octavo {

/// Gives the pages of these words back, but for the last where they end inside it: they take no
/// memory until they are next looked at, and read the same then.
/// @param words  of a file that is mapped for reading
void release_pages(std::span<const std::uint32_t> words);

/// Words of a spill file, read as if they were in memory, as long as somebody needs them.
class MappedWords {
public:
    /// @param file  may be closed afterwards, and must not become shorter
    /// @throws Error io  where the system does not map it
    MappedWords(const SpillFile& file, std::uint64_t words);
    ~MappedWords();
    MappedWords(const MappedWords&) = delete;
    MappedWords& operator=(const MappedWords&) = delete;

    [[nodiscard]] std::span<const std::uint32_t> words() const {
        return {static_cast<const std::uint32_t*>(address_), size_ / sizeof(std::uint32_t)};
    }

private:
    void* address_ = nullptr;
    std::size_t size_;
};

}  // namespace octavo
