// SPDX-License-Identifier: MIT
#include "octavo/io/container.h"

#include <xxhash.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <set>

#include "octavo/io/finding.h"

namespace octavo::octv {
namespace {

constexpr std::uint64_t kVersionOffset = offsetof(FileHeader, version);

std::uint64_t directory_bytes(std::size_t sections) {
    return sizeof(FileHeader) + sections * sizeof(Section);
}

std::vector<std::byte> join(const FileHeader& header, std::span<const Section> sections) {
    std::vector<std::byte> bytes(directory_bytes(sections.size()));
    std::memcpy(bytes.data(), &header, sizeof header);
    // An empty table has no address to copy from.
    if (!sections.empty())
        std::memcpy(bytes.data() + sizeof header, sections.data(), sections.size_bytes());
    return bytes;
}

std::uint64_t directory_checksum(FileHeader header, std::span<const Section> sections) {
    header.checksum = 0;
    const std::vector<std::byte> bytes = join(header, sections);
    return XXH3_64bits(bytes.data(), bytes.size());
}

FileHeader decode_header(std::span<const std::byte> file, const std::filesystem::path& path) {
    FileHeader header;
    const std::size_t have = std::min(file.size(), sizeof header);
    // An empty file has no address to copy from.
    if (have > 0) std::memcpy(&header, file.data(), have);
    const auto refuse = [&](std::string_view code, const std::string& reason, std::uint64_t at) {
        throw FormatError(Errc::bad_input, code, path, reason, at);
    };
    if (have < sizeof kMagic || header.magic != kMagic)
        refuse("magic", "this is not an .octv file", 0);
    if (have < sizeof header) refuse("header-cut", "the file ends in its header", have);

    if (header.endianness == std::uint32_t{0x04030201})
        refuse("byte-order", "the file's bytes are in big-endian order",
               offsetof(FileHeader, endianness));
    if (header.endianness != kEndiannessMark)
        refuse("byte-order", "the byte order mark is damaged", offsetof(FileHeader, endianness));
    // The version decides what everything below means, so it comes first.
    if (header.version > kFormatVersion)
        throw FormatError(Errc::unsupported, "version-newer", path,
                          "format version " + std::to_string(header.version) +
                              "; this program reads up to " + std::to_string(kFormatVersion),
                          kVersionOffset);
    if (header.version == 0)
        refuse("version-zero", "format version 0 does not exist", kVersionOffset);

    if (header.file_bytes != file.size())
        refuse("file-size",
               "the file has " + std::to_string(file.size()) + " bytes and should have " +
                   std::to_string(header.file_bytes) + "; is it cut off?",
               offsetof(FileHeader, file_bytes));
    if (header.section_count > kMaxSections)
        refuse("section-count",
               std::to_string(header.section_count) + " sections; at most " +
                   std::to_string(kMaxSections) + " fit",
               offsetof(FileHeader, section_count));
    if (file.size() < directory_bytes(header.section_count))
        refuse("table-cut", "the file ends in its section table", file.size());
    if (header.zero != 0 || header.zeros != decltype(header.zeros){})
        refuse("header-reserved", "reserved bytes of the header are not zero",
               header.zero != 0 ? offsetof(FileHeader, zero) : offsetof(FileHeader, zeros));
    return header;
}

/// @param previous_end  where the section before ends; the table for the first
void check_section(const Section& section, std::uint64_t at, std::uint64_t previous_end,
                   std::uint64_t file_bytes, const std::filesystem::path& path) {
    const auto refuse = [&](std::string_view code, const std::string& reason, std::uint64_t field) {
        throw FormatError(Errc::bad_input, code, path,
                          "section " + section_name(section.id) + " " + reason, at + field);
    };
    if (section.flags & ~(kRequired | kZstd) || section.zero != 0)
        refuse("section-flags", "has flags that format version 1 does not know",
               offsetof(Section, flags));
    if (section.offset % kPageBytes != 0)
        refuse("section-unaligned", "does not begin at a multiple of 4096",
               offsetof(Section, offset));
    if (section.offset < previous_end)
        refuse("section-overlap", "overlaps what comes before it", offsetof(Section, offset));
    // Subtract, never add: offset + stored_bytes may pass 2^64.
    if (section.offset > file_bytes || section.stored_bytes > file_bytes - section.offset)
        refuse("section-outside", "reaches past the end of the file",
               offsetof(Section, stored_bytes));
    if (!(section.flags & kZstd) && section.raw_bytes != section.stored_bytes)
        refuse("section-size", "is not compressed, yet has two sizes",
               offsetof(Section, raw_bytes));
    const bool known = section.id == kMetadataSection || section.id == kDagSection ||
                       std::ranges::count(kAttributeSections, section.id) > 0 ||
                       section.id == kLightSection;
    if (!known && section.flags & kRequired)
        throw FormatError(
            Errc::unsupported, "section-unknown", path,
            "section " + section_name(section.id) +
                " is needed to understand the file, and this program does not know it",
            at);
}

}  // namespace

std::string section_name(std::uint32_t id) {
    std::string letters(4, ' ');
    std::memcpy(letters.data(), &id, 4);
    const bool printable = std::all_of(letters.begin(), letters.end(),
                                       [](unsigned char c) { return c >= 0x20 && c < 0x7f; });
    if (printable) return letters.substr(0, letters.find_last_not_of(' ') + 1);
    char digits[11];
    std::snprintf(digits, sizeof digits, "0x%08x", static_cast<unsigned>(id));
    return digits;
}

std::vector<std::byte> encode_directory(std::uint64_t file_bytes,
                                        std::span<const Section> sections) {
    FileHeader header;
    header.file_bytes = file_bytes;
    header.section_count = static_cast<std::uint32_t>(sections.size());
    header.checksum = directory_checksum(header, sections);
    return join(header, sections);
}

std::vector<Section> decode_directory(std::span<const std::byte> file,
                                      const std::filesystem::path& path) {
    const FileHeader header = decode_header(file, path);
    std::vector<Section> sections(header.section_count);
    if (!sections.empty())
        std::memcpy(sections.data(), file.data() + sizeof header,
                    sections.size() * sizeof(Section));
    if (directory_checksum(header, sections) != header.checksum)
        throw FormatError(Errc::bad_input, "table-checksum", path,
                          "the header or the section table is damaged",
                          offsetof(FileHeader, checksum));

    std::set<std::uint32_t> seen;
    std::uint64_t end = directory_bytes(sections.size());
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const std::uint64_t at = directory_bytes(i);
        check_section(sections[i], at, end, file.size(), path);
        if (!seen.insert(sections[i].id).second)
            throw FormatError(Errc::bad_input, "section-twice", path,
                              "section " + section_name(sections[i].id) + " is there twice", at);
        end = sections[i].offset + sections[i].stored_bytes;
    }
    return sections;
}

void verify_checksum(std::span<const std::byte> file, const Section& section,
                     const std::filesystem::path& path) {
    const auto bytes = stored_bytes(file, section);
    if (XXH3_64bits(bytes.data(), bytes.size()) != section.checksum)
        throw FormatError(Errc::bad_input, "section-checksum", path,
                          "section " + section_name(section.id) + " is damaged: wrong checksum",
                          section.offset);
}

}  // namespace octavo::octv
