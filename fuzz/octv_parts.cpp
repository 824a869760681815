// SPDX-License-Identifier: MIT
#include "octv_parts.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace octavo::fuzz {

using octv::FileHeader;
using octv::Section;

OctvParts::OctvParts(std::span<const std::uint8_t> file) {
    FileHeader header;
    if (file.size() < sizeof header) return;
    std::memcpy(&header, file.data(), sizeof header);
    const std::size_t count = std::min({std::size_t{header.section_count}, std::size_t{8},
                                        (file.size() - sizeof header) / sizeof(Section)});
    for (std::size_t i = 0; i < count; ++i) {
        Part part;
        std::memcpy(&part.section, file.data() + sizeof header + i * sizeof(Section),
                    sizeof(Section));
        const std::uint64_t begin = std::min<std::uint64_t>(part.section.offset, file.size());
        const std::uint64_t size =
            std::min<std::uint64_t>(part.section.stored_bytes, file.size() - begin);
        part.content.assign(reinterpret_cast<const char*>(file.data() + begin), size);
        parts.push_back(std::move(part));
    }
}

OctvParts::Part* OctvParts::find(std::uint32_t id) {
    const auto found =
        std::ranges::find(parts, id, [](const Part& part) { return part.section.id; });
    return found == parts.end() ? nullptr : &*found;
}

void OctvParts::set(std::uint32_t id, std::uint32_t flags, std::string content) {
    Part* part = find(id);
    if (!part) part = &parts.emplace_back();
    part->section.id = id;
    part->section.flags = flags;
    part->content = std::move(content);
}

std::vector<std::uint8_t> OctvParts::sealed(
    const std::function<void(std::vector<Section>&)>& distort) const {
    std::vector<std::uint8_t> file(octv::kPageBytes);
    std::vector<Section> sections;
    for (const Part& part : parts) {
        file.resize((file.size() + octv::kPageBytes - 1) / octv::kPageBytes * octv::kPageBytes);
        Section section = part.section;
        section.offset = file.size();
        section.stored_bytes = part.content.size();
        if (!(section.flags & octv::kZstd)) section.raw_bytes = part.content.size();
        section.checksum = XXH3_64bits(part.content.data(), part.content.size());
        sections.push_back(section);
        file.insert(file.end(), part.content.begin(), part.content.end());
    }
    if (distort) distort(sections);
    const auto directory = octv::encode_directory(file.size(), sections);
    std::memcpy(file.data(), directory.data(), directory.size());
    return file;
}

void seal_directory(std::vector<std::uint8_t>& file) {
    FileHeader header;
    if (file.size() < sizeof header) return;
    std::memcpy(&header, file.data(), sizeof header);
    const std::uint64_t size =
        sizeof header + std::uint64_t{header.section_count} * sizeof(Section);
    if (size > file.size()) return;
    std::memset(file.data() + offsetof(FileHeader, checksum), 0, 8);
    const std::uint64_t checksum = XXH3_64bits(file.data(), size);
    std::memcpy(file.data() + offsetof(FileHeader, checksum), &checksum, 8);
}

}  // namespace octavo::fuzz
