// SPDX-License-Identifier: MIT
#include "octavo/io/octv.h"

#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "octavo/core/atomic_file.h"
#include "octavo/core/error.h"
#include "octavo/io/check.h"
#include "octavo/io/compression.h"
#include "octavo/io/container.h"
#include "octavo/io/mapped_file.h"

namespace octavo {
namespace {

using namespace octv;

// Room for some ten thousand cameras and lights; what bounds the memory that reading takes.
constexpr std::uint64_t kMaxMetadataBytes = std::uint64_t{16} << 20;
constexpr std::uint64_t kMaxDagBytes = std::uint64_t{16} << 30;
constexpr std::size_t kWriteBytes = std::size_t{4} << 20;

std::uint64_t round_up_to_page(std::uint64_t offset) {
    return (offset + kPageBytes - 1) / kPageBytes * kPageBytes;
}

/// Lays sections into a file one after the other.
class SectionWriter {
public:
    explicit SectionWriter(AtomicFile& file) : file_(file) {}

    void begin(std::uint32_t id, std::uint32_t flags, std::uint64_t raw_bytes) {
        end_ = round_up_to_page(end_);
        sections_.push_back({.id = id, .flags = flags, .offset = end_, .raw_bytes = raw_bytes});
        XXH3_64bits_reset(state_.get());
    }
    void append(std::span<const std::byte> bytes) {
        file_.write(end_, bytes);
        XXH3_64bits_update(state_.get(), bytes.data(), bytes.size());
        end_ += bytes.size();
    }
    void end() {
        sections_.back().stored_bytes = end_ - sections_.back().offset;
        sections_.back().checksum = XXH3_64bits_digest(state_.get());
    }
    void write_directory() {
        file_.write(0, encode_directory(end_, sections_));
        file_.resize(end_);  // an empty last section has an offset, and no byte that reaches it
    }

private:
    AtomicFile& file_;
    std::uint64_t end_ = kPageBytes;
    std::vector<Section> sections_;
    std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_{XXH3_createState(),
                                                                           XXH3_freeState};
};

/// A section of words, the DAG's or an attribute's.
void write_words(SectionWriter& writer, std::uint32_t id, std::uint32_t flags,
                 std::span<const std::uint32_t> words, const OctvWriteOptions& options) {
    const std::span<const std::byte> raw = std::as_bytes(words);
    const bool compress = options.compress && !raw.empty();
    writer.begin(id, flags | (compress ? kZstd : 0), raw.size());
    for (std::size_t done = 0; !compress && done < raw.size();) {
        const std::size_t count = std::min(kWriteBytes, raw.size() - done);
        writer.append(raw.subspan(done, count));
        done += count;
        report(options.progress, {.phase = "write", .done = done, .total = raw.size()});
    }
    if (compress) {
        zstd_compress(
            raw, [&](std::span<const std::byte> piece) { writer.append(piece); },
            [&](std::uint64_t done) {
                report(options.progress, {.phase = "write", .done = done, .total = raw.size()});
            });
    }
    writer.end();
}

const Section* find_optional(const std::vector<Section>& sections, std::uint32_t id) {
    const auto found = std::find_if(sections.begin(), sections.end(),
                                    [&](const Section& section) { return section.id == id; });
    return found == sections.end() ? nullptr : &*found;
}

const Section& find_section(const std::vector<Section>& sections, std::uint32_t id,
                            const std::filesystem::path& path) {
    const Section* found = find_optional(sections, id);
    if (!found)
        throw Error(Errc::bad_input, path, "section " + section_name(id) + " is missing",
                    sizeof(FileHeader));
    return *found;
}

/// The content of a compressed section, whose raw size has been checked against a limit.
std::shared_ptr<const Mapping> decompress(std::span<const std::byte> file, const Section& section,
                                          const std::filesystem::path& path) {
    const auto frame = stored_bytes(file, section);
    const auto refuse = [&](const std::string& reason) {
        throw Error(Errc::bad_input, path,
                    "section " + section_name(section.id) + " does not decompress: " + reason,
                    section.offset);
    };
    if (zstd_content_size(frame) != section.raw_bytes)
        refuse("it is not one zstd frame of the stated size");
    std::shared_ptr<Mapping> raw = allocate_mapping(section.raw_bytes);
    if (const auto reason = zstd_decompress(frame, raw->writable_bytes())) refuse(*reason);
    return raw;
}

Metadata read_metadata(std::span<const std::byte> file, const std::vector<Section>& sections,
                       const std::filesystem::path& path) {
    const Section& section = find_section(sections, kMetadataSection, path);
    if (section.raw_bytes > kMaxMetadataBytes)
        throw Error(Errc::bad_input, path, "the metadata is larger than 16 MiB", section.offset);
    verify_checksum(file, section, path);

    std::shared_ptr<const Mapping> decompressed;
    std::span<const std::byte> raw = stored_bytes(file, section);
    if (section.flags & kZstd) {
        decompressed = decompress(file, section, path);
        raw = decompressed->bytes();
    }
    try {
        return decode_metadata({reinterpret_cast<const char*>(raw.data()), raw.size()});
    } catch (const Error& error) {
        throw Error(error.code(), path, error.what(), section.offset);
    }
}

/// Words and what keeps them alive.
struct Words {
    std::span<const std::uint32_t> words;
    std::shared_ptr<const void> owner;
};

Words read_words(const std::shared_ptr<const Mapping>& file, const Section& section,
                 const std::filesystem::path& path) {
    std::shared_ptr<const Mapping> owner = file;
    std::span<const std::byte> raw = stored_bytes(file->bytes(), section);
    if (section.flags & kZstd) {
        owner = decompress(file->bytes(), section, path);
        raw = owner->bytes();
    }
    return {
        {reinterpret_cast<const std::uint32_t*>(raw.data()), raw.size() / sizeof(std::uint32_t)},
        std::move(owner)};
}

void check_nodes(const Section& section, std::span<const std::uint64_t> begins,
                 std::span<const std::uint32_t> words, const Statistics& statistics,
                 const std::filesystem::path& path) {
    std::vector<std::uint64_t> level_nodes;
    for (const LevelStatistics& level : statistics.levels) level_nodes.push_back(level.dag_nodes);
    const auto fault = find_fault(begins, words, level_nodes);
    if (!fault) return;
    if (section.flags & kZstd)
        throw Error(
            Errc::bad_input, path,
            fault->reason + " (word " + std::to_string(fault->word) + " of the decompressed DAG)",
            section.offset);
    throw Error(Errc::bad_input, path, fault->reason,
                section.offset + fault->word * sizeof(std::uint32_t));
}

CellValues read_channel(const std::shared_ptr<const Mapping>& file, const Section& section,
                        std::uint64_t cells, int value_bits, const OctvReadOptions& options,
                        const std::filesystem::path& path) {
    if (section.raw_bytes % sizeof(std::uint32_t) != 0)
        throw Error(Errc::bad_input, path,
                    "section " + section_name(section.id) + " is not a whole number of words",
                    section.offset);
    if (section.flags & kZstd && section.raw_bytes > options.max_dag_bytes)
        throw Error(Errc::limit, path,
                    "section " + section_name(section.id) + " takes " +
                        std::to_string(section.raw_bytes) + " bytes, and " +
                        std::to_string(options.max_dag_bytes) + " are allowed",
                    section.offset);
    if (!options.trusted) verify_checksum(file->bytes(), section, path);
    const Words words = read_words(file, section, path);
    if (!options.trusted)
        if (const auto fault = CellValues::find_fault(words.words, cells, value_bits))
            throw Error(Errc::bad_input, path,
                        "section " + section_name(section.id) + ": " + fault->reason + " (word " +
                            std::to_string(fault->word) + ")",
                        section.offset);
    return {words.words, cells, words.owner};
}

Attributes read_attributes(const std::shared_ptr<const Mapping>& file,
                           const std::vector<Section>& sections, const Dag& dag,
                           const AttributeSummary& summary, const OctvReadOptions& options,
                           const std::filesystem::path& path) {
    CellIndex cells(dag, summary.level);
    if (cells.count() != summary.cells)
        throw Error(Errc::bad_input, path,
                    "the attributes are of " + std::to_string(summary.cells) +
                        " cells, and the DAG has " + std::to_string(cells.count()),
                    find_section(sections, kMetadataSection, path).offset);
    std::array<CellValues, Attributes::kChannels> channels;
    for (std::size_t c = 0; c < channels.size(); ++c)
        if (const Section* section = find_optional(sections, kAttributeSections[c]))
            channels[c] = read_channel(file, *section, summary.cells, Attributes::kValueBits[c],
                                       options, path);
    return {std::move(cells), std::move(channels), summary.tolerance};
}

/// Every word has a meaning, so there is nothing to check but their number.
CellLight read_light(const std::shared_ptr<const Mapping>& file,
                     const std::vector<Section>& sections, const Model& model,
                     const OctvReadOptions& options, const std::filesystem::path& path) {
    const Section& section = find_section(sections, kLightSection, path);
    const std::uint64_t cells = model.attributes.cells().count();
    if (cells > CellLight::kMostCells || section.raw_bytes != 6 * sizeof(std::uint32_t) * cells)
        throw Error(Errc::bad_input, path,
                    "section LITE has " + std::to_string(section.raw_bytes) +
                        " bytes where its " + std::to_string(cells) + " cells need 24 each",
                    section.offset);
    if (section.flags & kZstd && section.raw_bytes > options.max_dag_bytes)
        throw Error(Errc::limit, path,
                    "section LITE takes " + std::to_string(section.raw_bytes) + " bytes, and " +
                        std::to_string(options.max_dag_bytes) + " are allowed",
                    section.offset);
    if (!options.trusted) verify_checksum(file->bytes(), section, path);
    const Words words = read_words(file, section, path);
    return {model.attributes.level(), model.metadata.light->bounces, words.words, words.owner};
}

}  // namespace

void write_octv(const std::filesystem::path& path, const Model& model,
                const OctvWriteOptions& options) {
    if (model.dag.depth() != model.metadata.grid.depth ||
        !std::ranges::equal(model.dag.level_begins(), level_begins(model.metadata.statistics)))
        throw Error(Errc::bad_argument, "the metadata does not describe this DAG");
    Metadata metadata = model.metadata;
    metadata.attributes.reset();
    const Attributes& attributes = model.attributes;
    if (!attributes.empty()) {
        if (attributes.cells().dag().words().data() != model.dag.words().data())
            throw Error(Errc::bad_argument, "the attributes are not of this DAG's cells");
        metadata.attributes = {attributes.level(), attributes.cells().count(),
                               attributes.tolerance()};
    }
    if (model.light.empty()) {
        metadata.light.reset();
    } else if (!metadata.light || model.light.count() != attributes.cells().count() ||
               model.light.level() != attributes.level()) {
        throw Error(Errc::bad_argument, "the light is not of the attributes' cells");
    }
    const std::string json = encode_metadata(metadata);
    if (json.size() > kMaxMetadataBytes)
        throw Error(Errc::limit, path, "the scene's cameras and lights take more than 16 MiB");

    AtomicFile file(path);
    SectionWriter writer(file);
    writer.begin(kMetadataSection, kRequired, json.size());
    writer.append(std::as_bytes(std::span(json)));
    writer.end();
    write_words(writer, kDagSection, kRequired, model.dag.words(), options);
    for (std::size_t c = 0; c < Attributes::kChannels; ++c) {
        const auto words = attributes.channel(static_cast<Attributes::Channel>(c)).words();
        if (!words.empty()) write_words(writer, kAttributeSections[c], 0, words, options);
    }
    if (!model.light.empty())
        write_words(writer, kLightSection, 0, model.light.words(), options);
    writer.write_directory();
    file.commit();
}

Model read_octv(const std::filesystem::path& path, const OctvReadOptions& options) {
    const std::shared_ptr<const Mapping> file =
        options.map ? map_file(path) : copy_file_to_memory(path);
    const std::vector<Section> sections = decode_directory(file->bytes(), path);

    Model model;
    model.metadata = read_metadata(file->bytes(), sections, path);
    const Statistics& statistics = model.metadata.statistics;

    const Section& section = find_section(sections, kDagSection, path);
    if (section.raw_bytes != statistics.dag_bytes || section.raw_bytes > kMaxDagBytes)
        throw Error(Errc::bad_input, path,
                    "section DAG has " + std::to_string(section.raw_bytes) +
                        " bytes where the metadata states " + std::to_string(statistics.dag_bytes),
                    section.offset);
    if (section.flags & kZstd && section.raw_bytes > options.max_dag_bytes)
        throw Error(Errc::limit, path,
                    "the DAG takes " + std::to_string(section.raw_bytes) + " bytes, and " +
                        std::to_string(options.max_dag_bytes) + " are allowed",
                    section.offset);
    if (!options.trusted) verify_checksum(file->bytes(), section, path);

    const std::vector<std::uint64_t> begins = level_begins(statistics);
    const Words words = read_words(file, section, path);
    if (!options.trusted) check_nodes(section, begins, words.words, statistics, path);
    model.dag = Dag(model.metadata.grid.depth, begins, words.words, words.owner);
    if (options.attributes && model.metadata.attributes)
        model.attributes =
            read_attributes(file, sections, model.dag, *model.metadata.attributes, options, path);
    if (!model.attributes.empty() && model.metadata.light)
        model.light = read_light(file, sections, model, options, path);
    return model;
}

OctvSummary read_octv_summary(const std::filesystem::path& path) {
    const std::shared_ptr<const Mapping> file = map_file(path);
    const std::vector<Section> sections = decode_directory(file->bytes(), path);
    OctvSummary summary;
    summary.metadata = read_metadata(file->bytes(), sections, path);
    summary.file_bytes = file->bytes().size();
    summary.compressed = find_section(sections, kDagSection, path).flags & kZstd;
    for (std::size_t c = 0; c < Attributes::kChannels; ++c)
        if (const Section* section = find_optional(sections, kAttributeSections[c]))
            summary.attribute_bytes[c] = section->raw_bytes;
    if (const Section* section = find_optional(sections, kLightSection))
        summary.light_bytes = section->raw_bytes;
    return summary;
}

}  // namespace octavo
