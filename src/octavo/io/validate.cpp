// SPDX-License-Identifier: MIT
#include "octavo/io/validate.h"

#include <algorithm>
#include <string>

#include "octavo/core/input_file.h"
#include "octavo/io/container.h"
#include "octavo/io/mapped_file.h"
#include "octavo/io/reading.h"

namespace octavo {
namespace {

using namespace octv;

/// Counts what the metadata states of the octree. A reader does without: no pointer depends on it.
void compare_octree_nodes(const Statistics& stated, const Statistics& counted, Reading& reading) {
    for (std::size_t level = 0; level < stated.levels.size(); ++level) {
        const std::uint64_t found = counted.levels[level].svo_nodes;
        if (found != stated.levels[level].svo_nodes)
            reading.add({"octree-count", reading.metadata_offset,
                         "level " + std::to_string(level) + " stands for " + std::to_string(found) +
                             " nodes of the octree where " +
                             std::to_string(stated.levels[level].svo_nodes) + " are stated"});
    }
}

/// Every byte that belongs to no section is zero, and the last section ends the file.
void check_padding(const FileCopy& file, const std::vector<Section>& sections, Reading& reading) {
    const auto bytes = file.bytes();
    std::uint64_t end = sizeof(FileHeader) + sections.size() * sizeof(Section);
    const auto check_zero = [&](std::uint64_t next) {
        const auto gap = bytes.subspan(end, next - end);
        const auto found = std::ranges::find_if(gap, [](std::byte b) { return b != std::byte{0}; });
        if (found != gap.end())
            reading.add({"padding", end + static_cast<std::uint64_t>(found - gap.begin()),
                         "a byte between sections is not zero"});
    };
    for (const Section& section : sections) {
        check_zero(section.offset);
        // Whoever writes a gap of pages hides something in the file, or wastes room.
        if (section.offset - end >= kPageBytes && end > kPageBytes)
            reading.add(
                {"gap", end, "more than a page before section " + section_name(section.id)});
        end = section.offset + section.stored_bytes;
    }
    if (end < bytes.size())
        reading.add({"trailing-bytes", end,
                     std::to_string(bytes.size() - end) + " bytes after the last section"});
}

/// What is left of the file: sections that this program passes over, and what lies between.
void check_rest(Reading& reading) {
    FileCopy file(reading.path);
    file.fetch(0, kPageBytes);
    std::vector<Section> sections;
    reading.check(reading.times.read,
                  [&] { sections = decode_directory(file.bytes(), reading.path); });
    for (const Section& section : sections) {
        if (section.id == kMetadataSection || section.id == kDagSection) continue;
        file.fetch(section.offset, section.stored_bytes);
        reading.check(reading.times.checksum,
                      [&] { verify_checksum(file.bytes(), section, reading.path); });
    }
    if (!reading.strict || sections.empty()) return;
    file.fetch(0, file.bytes().size());
    check_padding(file, sections, reading);
}

}  // namespace

Validation validate_octv(const std::filesystem::path& path, const ValidateOptions& options) {
    Reading reading{.path = path,
                    .options = {.max_dag_bytes = options.max_dag_bytes},
                    .collect = true,
                    .strict = options.strict,
                    .max_findings = options.max_findings};
    Validation validation;
    validation.file_bytes = InputFile(path).size();  // what is no file has no findings
    Model model;
    double ignored_seconds = 0.0;
    reading.check(ignored_seconds, [&] { model = read_model(reading); });
    validation.times = reading.times;

    const auto begin = std::chrono::steady_clock::now();
    if (reading.usable) {
        validation.statistics = compute_statistics(model.dag);
        compare_octree_nodes(model.metadata.statistics, validation.statistics, reading);
        check_rest(reading);
    }
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    validation.extra_seconds = passed.count();

    validation.findings = std::move(reading.findings);
    return validation;
}

}  // namespace octavo
