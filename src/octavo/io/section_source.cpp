// SPDX-License-Identifier: MIT
#include "octavo/io/section_source.h"

#include <algorithm>
#include <string>
#include <utility>

#include "octavo/core/memory.h"
#include "octavo/io/compression.h"
#include "octavo/io/finding.h"

namespace octavo::octv {
namespace {

/// The content of a compressed section, whose raw size has been checked against a limit.
std::shared_ptr<const Mapping> decompress(std::span<const std::byte> file, const Section& section,
                                          const std::filesystem::path& path) {
    const auto frame = stored_bytes(file, section);
    const auto refuse = [&](const std::string& reason) {
        throw FormatError(Errc::bad_input, "section-compression", path,
                          "section " + section_name(section.id) + " does not decompress: " + reason,
                          section.offset);
    };
    if (zstd_content_size(frame) != section.raw_bytes)
        refuse("it is not one zstd frame of the stated size");
    std::shared_ptr<Mapping> raw = allocate_mapping(section.raw_bytes);
    if (const auto reason = zstd_decompress(frame, raw->writable_bytes())) refuse(*reason);
    return raw;
}

}  // namespace

const Section* find_optional(const std::vector<Section>& sections, std::uint32_t id) {
    const auto found = std::find_if(sections.begin(), sections.end(),
                                    [&](const Section& section) { return section.id == id; });
    return found == sections.end() ? nullptr : &*found;
}

const Section& find_section(const std::vector<Section>& sections, std::uint32_t id,
                            const std::filesystem::path& path) {
    const Section* found = find_optional(sections, id);
    if (!found)
        throw FormatError(Errc::bad_input, "section-missing", path,
                          "section " + section_name(id) + " is missing", sizeof(FileHeader));
    return *found;
}

void allow_decompressed(const Section& section, Reading& reading) {
    if (!(section.flags & kZstd)) return;
    const std::uint64_t allowed =
        std::min(reading.options.max_dag_bytes, machine_memory_bytes() / 2);
    if (section.raw_bytes > allowed - std::min(allowed, reading.decompressed_bytes))
        throw FormatError(Errc::limit, "limit", reading.path,
                          "section " + section_name(section.id) + " takes " +
                              std::to_string(section.raw_bytes) + " bytes, and " +
                              std::to_string(allowed) + " are allowed for all that is compressed",
                          section.offset);
    reading.decompressed_bytes += section.raw_bytes;
}

RawBytes raw_bytes(const SectionSource& source, const Section& section,
                   const std::filesystem::path& path) {
    if (!(section.flags & kZstd)) return {stored_bytes(source.bytes(), section), source.owner()};
    const std::shared_ptr<const Mapping> raw = decompress(source.bytes(), section, path);
    return {raw->bytes(), raw};
}

Words read_words(const SectionSource& source, const Section& section,
                 const std::filesystem::path& path) {
    RawBytes raw = raw_bytes(source, section, path);
    return {{reinterpret_cast<const std::uint32_t*>(raw.bytes.data()),
             raw.bytes.size() / sizeof(std::uint32_t)},
            std::move(raw.owner)};
}

}  // namespace octavo::octv
