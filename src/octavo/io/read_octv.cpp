// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "octavo/core/error.h"
#include "octavo/io/check.h"
#include "octavo/io/container.h"
#include "octavo/io/finding.h"
#include "octavo/io/octv.h"
#include "octavo/io/read_cells.h"
#include "octavo/io/reading.h"
#include "octavo/io/section_source.h"

namespace octavo {
namespace {

using namespace octv;

constexpr std::uint64_t kMaxDagBytes = std::uint64_t{16} << 30;

/// The JSON text of a file's metadata, and its meaning.
Metadata decode_metadata_section(const SectionSource& source, const Section& section,
                                 const std::filesystem::path& path) {
    const RawBytes raw = raw_bytes(source, section, path);
    try {
        return decode_metadata({reinterpret_cast<const char*>(raw.bytes.data()), raw.bytes.size()});
    } catch (const Error& error) {
        throw FormatError(error.code(), "metadata", path, error.what(), section.offset);
    }
}

std::optional<Metadata> read_metadata(SectionSource& source, const Section& section,
                                      Reading& reading) {
    std::optional<Metadata> metadata;
    reading.check(reading.times.read, [&] {
        if (std::max(section.raw_bytes, section.stored_bytes) > kMaxMetadataBytes)
            throw FormatError(Errc::bad_input, "metadata-size", reading.path,
                              "the metadata is larger than 16 MiB", section.offset);
        source.fetch(section);
    });
    if (!reading.usable) return metadata;
    reading.check(reading.times.checksum,
                  [&] { verify_checksum(source.bytes(), section, reading.path); });
    reading.check(reading.times.validate,
                  [&] { metadata = decode_metadata_section(source, section, reading.path); });
    return metadata;
}

/// @throws FormatError where findings are not collected
void check_nodes(const Section& section, std::span<const std::uint64_t> begins,
                 std::span<const std::uint32_t> words, const Statistics& statistics,
                 Reading& reading) {
    std::vector<std::uint64_t> level_nodes;
    for (const LevelStatistics& level : statistics.levels) level_nodes.push_back(level.dag_nodes);
    const std::vector<DagFault> faults =
        find_faults(begins, words, {.level_nodes = level_nodes, .voxels = statistics.voxels},
                    {.strict = reading.strict, .max_faults = reading.max_findings});
    for (const DagFault& fault : faults) {
        Finding finding{std::string(fault.code),
                        section.offset + fault.word * sizeof(std::uint32_t), fault.reason};
        if (section.flags & kZstd) {
            finding.offset = section.offset;
            finding.message += " (word " + std::to_string(fault.word) + " of the decompressed DAG)";
        }
        if (!reading.collect)
            throw FormatError(Errc::bad_input, fault.code, reading.path, finding.message,
                              finding.offset);
        reading.add(std::move(finding), fault.strict_only);
    }
}

void check_dag_size(const Section& section, const Statistics& statistics, Reading& reading) {
    if (section.raw_bytes != statistics.dag_bytes || section.raw_bytes > kMaxDagBytes)
        throw FormatError(Errc::bad_input, "dag-size", reading.path,
                          "section DAG has " + std::to_string(section.raw_bytes) +
                              " bytes where the metadata states " +
                              std::to_string(statistics.dag_bytes),
                          section.offset);
    allow_decompressed(section, reading);
}

std::vector<Section> read_directory(SectionSource& source, Reading& reading) {
    std::vector<Section> sections;
    reading.check(reading.times.read, [&] {
        source.fetch(0, kPageBytes);
        sections = decode_directory(source.bytes(), reading.path);
        for (const std::uint32_t needed : {kMetadataSection, kDagSection})
            (void)find_section(sections, needed, reading.path);
    });
    return sections;
}

}  // namespace

Model read_model(Reading& reading) {
    const std::filesystem::path& path = reading.path;
    const bool trusted = reading.options.trusted;
    OctvReadTimes& times = reading.times;
    Model model;

    using Access = SectionSource::Access;
    SectionSource source(path, trusted || reading.options.map ? Access::map : Access::copy);
    const std::vector<Section> sections = read_directory(source, reading);
    if (!reading.usable) return model;
    auto metadata = read_metadata(source, find_section(sections, kMetadataSection, path), reading);
    if (!metadata) return model;
    model.metadata = std::move(*metadata);
    reading.metadata_offset = find_section(sections, kMetadataSection, path).offset;
    const Statistics& statistics = model.metadata.statistics;

    const Section& section = find_section(sections, kDagSection, path);
    const std::size_t findings = reading.findings.size();
    reading.check(times.read, [&] {
        check_dag_size(section, statistics, reading);
        source.fetch(section);
    });
    if (reading.findings.size() > findings) return model;
    if (!trusted)
        reading.check(times.checksum, [&] { verify_checksum(source.bytes(), section, path); });

    Words words;
    reading.check(section.flags & kZstd ? times.decompress : times.read,
                  [&] { words = read_words(source, section, path); });
    if (reading.findings.size() > findings && words.words.size_bytes() != section.raw_bytes)
        return model;
    const std::vector<std::uint64_t> begins = level_begins(statistics);
    if (!trusted)
        reading.check(times.validate,
                      [&] { check_nodes(section, begins, words.words, statistics, reading); });
    if (!reading.usable) return model;
    model.dag = Dag(model.metadata.grid.depth, begins, words.words, words.owner);
    if (reading.options.attributes && model.metadata.attributes)
        model.attributes =
            read_attributes(source, sections, model.dag, *model.metadata.attributes, reading);
    if (!reading.usable) return model;
    if (!model.attributes.empty() && model.metadata.light)
        model.light = read_light(source, sections, model, reading);
    return model;
}

Model read_octv(const std::filesystem::path& path, const OctvReadOptions& options) {
    Reading reading{.path = path, .options = options};
    Model model = read_model(reading);
    if (options.times) *options.times = reading.times;
    return model;
}

OctvSummary read_octv_summary(const std::filesystem::path& path) {
    Reading reading{.path = path};
    SectionSource source(path, SectionSource::Access::copy);
    const std::vector<Section> sections = read_directory(source, reading);
    OctvSummary summary;
    summary.metadata =
        *read_metadata(source, find_section(sections, kMetadataSection, path), reading);
    summary.file_bytes = source.bytes().size();
    summary.compressed = find_section(sections, kDagSection, path).flags & kZstd;
    for (std::size_t c = 0; c < Attributes::kChannels; ++c)
        if (const Section* section = find_optional(sections, kAttributeSections[c]))
            summary.attribute_bytes[c] = section->raw_bytes;
    if (const Section* section = find_optional(sections, kLightSection))
        summary.light_bytes = section->raw_bytes;
    return summary;
}

}  // namespace octavo
