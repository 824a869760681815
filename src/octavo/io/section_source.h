// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "octavo/io/container.h"
#include "octavo/io/mapped_file.h"
#include "octavo/io/reading.h"

namespace octavo::octv {

/// The file's bytes, from where they may change or in a copy where they cannot.
class SectionSource {
public:
    enum class Access { copy, map };

    /// @throws Error  as map_file() or FileCopy
    SectionSource(const std::filesystem::path& path, Access access) {
        if (access == Access::map)
            mapped_ = map_file(path);
        else
            copy_.emplace(path);
    }
    /// Of a copy, only what has been fetched is there; the rest is zero.
    [[nodiscard]] std::span<const std::byte> bytes() const {
        return mapped_ ? mapped_->bytes() : copy_->bytes();
    }
    void fetch(std::uint64_t offset, std::uint64_t size) {
        if (copy_) copy_->fetch(offset, size);
    }
    void fetch(const Section& section) { fetch(section.offset, section.stored_bytes); }
    [[nodiscard]] std::shared_ptr<const Mapping> owner() const {
        return mapped_ ? mapped_ : copy_->memory();
    }

private:
    std::shared_ptr<const Mapping> mapped_;
    std::optional<FileCopy> copy_;
};

/// The section of that id. @return nullptr where the file has none
[[nodiscard]] const Section* find_optional(const std::vector<Section>& sections, std::uint32_t id);

/// The same. @throws FormatError "section-missing"
[[nodiscard]] const Section& find_section(const std::vector<Section>& sections, std::uint32_t id,
                                          const std::filesystem::path& path);

/// Bytes of a section as they were before they were written, and what keeps them alive.
struct RawBytes {
    std::span<const std::byte> bytes;
    std::shared_ptr<const void> owner;
};

/// Adds what a compressed section claims to take to what all of them do. A few bytes can stand for
/// very many, so this comes before any of them is given memory.
/// @throws FormatError  limit, where together they take more than the options allow
void allow_decompressed(const Section& section, Reading& reading);

/// The content of a section that has been fetched and allowed: the source's own bytes, or what they
/// decompress to.
/// @throws FormatError  where it does not decompress to the stated size
[[nodiscard]] RawBytes raw_bytes(const SectionSource& source, const Section& section,
                                 const std::filesystem::path& path);

/// The same, as words.
struct Words {
    std::span<const std::uint32_t> words;
    std::shared_ptr<const void> owner;
};
[[nodiscard]] Words read_words(const SectionSource& source, const Section& section,
                               const std::filesystem::path& path);

}  // namespace octavo::octv
