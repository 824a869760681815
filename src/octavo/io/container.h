// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// The outer shape of an .octv file: a header, a table of sections, and page-aligned sections.
/// docs/file-format.md has the same as a table of bytes with a worked example.
namespace octavo::octv {

static_assert(std::endian::native == std::endian::little,
              "the file is little-endian and mapped without a copy");

inline constexpr std::uint32_t kFormatVersion = 1;
inline constexpr std::uint64_t kPageBytes = 4096;

/// 89 'O' 'C' 'T' 'V' 0D 0A 1A: not text, and damaged by every transfer that takes it for text.
inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'O', 'C', 'T', 'V', 0x0d, 0x0a, 0x1a};
inline constexpr std::uint32_t kEndiannessMark = 0x01020304;

/// The first 64 bytes of the file.
struct FileHeader {
    std::array<std::uint8_t, 8> magic = kMagic;
    std::uint32_t version = kFormatVersion;
    std::uint32_t endianness = kEndiannessMark;
    std::uint64_t file_bytes = 0;
    std::uint32_t section_count = 0;
    std::uint32_t zero = 0;
    std::uint64_t checksum = 0;  // XXH3-64 of header and table, with this field zero
    std::array<std::uint64_t, 3> zeros = {};
};
static_assert(sizeof(FileHeader) == 64);

/// Four letters as they stand in the file.
[[nodiscard]] constexpr std::uint32_t section_id(const char (&letters)[5]) {
    std::uint32_t id = 0;
    for (int i = 3; i >= 0; --i) id = id << 8 | static_cast<std::uint8_t>(letters[i]);
    return id;
}
inline constexpr std::uint32_t kMetadataSection = section_id("META");
inline constexpr std::uint32_t kDagSection = section_id("DAG ");
/// One for each channel of Attributes, in that order. A reader may do without them.
inline constexpr std::array<std::uint32_t, 6> kAttributeSections = {
    section_id("ACOL"), section_id("ABCK"), section_id("AEMI"),
    section_id("AEMB"), section_id("ANRM"), section_id("ANRB")};
/// The light of cells; a reader may do without it.
inline constexpr std::uint32_t kLightSection = section_id("LITE");

/// A reader that does not know the section's id must refuse the file.
inline constexpr std::uint32_t kRequired = 1;
/// The stored bytes are one zstd frame.
inline constexpr std::uint32_t kZstd = 2;

/// One entry of the table, which follows the header at byte 64.
struct Section {
    std::uint32_t id = 0;
    std::uint32_t flags = 0;
    std::uint64_t offset = 0;        // in the file; a multiple of kPageBytes
    std::uint64_t stored_bytes = 0;  // in the file
    std::uint64_t raw_bytes = 0;  // after decompression; equal to stored_bytes where not compressed
    std::uint64_t checksum = 0;   // XXH3-64 of the stored bytes
    std::uint64_t zero = 0;
};
static_assert(sizeof(Section) == 48);

/// Header and table fit in the first page, so that both are read at once and bounded.
inline constexpr std::uint32_t kMaxSections = (kPageBytes - sizeof(FileHeader)) / sizeof(Section);

/// What the metadata may take: room for some ten thousand cameras and lights. It bounds the memory
/// that reading takes.
inline constexpr std::uint64_t kMaxMetadataBytes = std::uint64_t{16} << 20;

/// The id as a person reads it: META, or hexadecimal digits where it is not four printable letters.
[[nodiscard]] std::string section_name(std::uint32_t id);

/// The bytes that the file begins with; the caller has placed the sections.
[[nodiscard]] std::vector<std::byte> encode_directory(std::uint64_t file_bytes,
                                                      std::span<const Section> sections);

/// Reads header and table, and checks them: magic, version, byte order, size of the file, checksum,
/// and of every section that it is aligned, inside the file and after the one before. Reads nothing
/// past the first page and allocates at most a page.
///
/// @param file  the whole file; its content is not trusted
/// @param path  for messages only
/// @throws Error  bad_input; unsupported where the version is newer or a required section is not
///                known
[[nodiscard]] std::vector<Section> decode_directory(std::span<const std::byte> file,
                                                    const std::filesystem::path& path);

/// The stored bytes of a section that `decode_directory` returned for this file.
[[nodiscard]] inline std::span<const std::byte> stored_bytes(std::span<const std::byte> file,
                                                             const Section& section) {
    return file.subspan(section.offset, section.stored_bytes);
}

/// @throws Error bad_input where the stored bytes are not those that were written
void verify_checksum(std::span<const std::byte> file, const Section& section,
                     const std::filesystem::path& path);

}  // namespace octavo::octv
