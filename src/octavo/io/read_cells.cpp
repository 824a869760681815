// SPDX-License-Identifier: MIT
#include "octavo/io/read_cells.h"

#include <array>
#include <string>
#include <utility>

#include "octavo/core/error.h"
#include "octavo/io/finding.h"

namespace octavo::octv {
namespace {

CellValues read_channel(SectionSource& source, const Section& section, std::uint64_t cells,
                        int value_bits, Reading& reading) {
    const auto refuse = [&](std::string_view code, const std::string& reason) {
        throw FormatError(Errc::bad_input, code, reading.path,
                          "section " + section_name(section.id) + reason, section.offset);
    };
    Words words;
    reading.check(reading.times.read, [&] {
        if (section.raw_bytes % sizeof(std::uint32_t) != 0)
            refuse("attribute-size", " is not a whole number of words");
        allow_decompressed(section, reading);
        source.fetch(section);
    });
    if (!reading.usable) return {};
    const bool trusted = reading.options.trusted;
    if (!trusted)
        reading.check(reading.times.checksum,
                      [&] { verify_checksum(source.bytes(), section, reading.path); });
    if (!reading.usable) return {};
    reading.check(reading.times.decompress,
                  [&] { words = read_words(source, section, reading.path); });
    if (!trusted)
        reading.check(reading.times.validate, [&] {
            if (const auto fault = CellValues::find_fault(words.words, cells, value_bits))
                refuse("attribute-values",
                       ": " + fault->reason + " (word " + std::to_string(fault->word) + ")");
        });
    if (!reading.usable) return {};
    return {words.words, cells, words.owner};
}

}  // namespace

Attributes read_attributes(SectionSource& source, const std::vector<Section>& sections,
                           const Dag& dag, const AttributeSummary& summary, Reading& reading) {
    CellIndex cells(dag, summary.level);
    reading.check(reading.times.validate, [&] {
        if (cells.count() != summary.cells)
            throw FormatError(Errc::bad_input, "attribute-cells", reading.path,
                              "the attributes are of " + std::to_string(summary.cells) +
                                  " cells, and the DAG has " + std::to_string(cells.count()),
                              find_section(sections, kMetadataSection, reading.path).offset);
    });
    if (!reading.usable) return {};
    std::array<CellValues, Attributes::kChannels> channels;
    for (std::size_t c = 0; c < channels.size(); ++c)
        if (const Section* section = find_optional(sections, kAttributeSections[c]))
            channels[c] =
                read_channel(source, *section, summary.cells, Attributes::kValueBits[c], reading);
    if (!reading.usable) return {};
    return {std::move(cells), std::move(channels), summary.tolerance};
}

/// Every word has a meaning, so there is nothing to check but their number.
CellLight read_light(SectionSource& source, const std::vector<Section>& sections,
                     const Model& model, Reading& reading) {
    const Section& section = find_section(sections, kLightSection, reading.path);
    const std::uint64_t cells = model.attributes.cells().count();
    Words words;
    reading.check(reading.times.read, [&] {
        if (cells > CellLight::kMostCells || section.raw_bytes != 6 * sizeof(std::uint32_t) * cells)
            throw FormatError(Errc::bad_input, "light-size", reading.path,
                              "section LITE has " + std::to_string(section.raw_bytes) +
                                  " bytes where its " + std::to_string(cells) +
                                  " cells need 24 each",
                              section.offset);
        allow_decompressed(section, reading);
        source.fetch(section);
    });
    if (!reading.usable) return {};
    if (!reading.options.trusted)
        reading.check(reading.times.checksum,
                      [&] { verify_checksum(source.bytes(), section, reading.path); });
    reading.check(reading.times.decompress,
                  [&] { words = read_words(source, section, reading.path); });
    if (!reading.usable) return {};
    return {model.attributes.level(), model.metadata.light->bounces, words.words, words.owner};
}

}  // namespace octavo::octv
