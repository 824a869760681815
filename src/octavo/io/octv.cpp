// SPDX-License-Identifier: MIT
#include "octavo/io/octv.h"

#include <xxhash.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "octavo/core/atomic_file.h"
#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "octavo/io/check.h"
#include "octavo/io/compression.h"
#include "octavo/io/container.h"
#include "octavo/io/finding.h"
#include "octavo/io/mapped_file.h"
#include "octavo/io/reading.h"

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

/// Says that these words, from the first on, are written and so not needed for a while.
using Release = std::function<void(std::uint64_t first, std::uint64_t count)>;

/// A section of words, the DAG's or an attribute's.
void write_words(SectionWriter& writer, std::uint32_t id, std::uint32_t flags,
                 std::span<const std::uint32_t> words, const Release& release_words,
                 const OctvWriteOptions& options) {
    const auto release = [&](std::uint64_t first, std::uint64_t last) {
        release_words(first / sizeof(std::uint32_t), (last - first) / sizeof(std::uint32_t));
    };
    const std::span<const std::byte> raw = std::as_bytes(words);
    const bool compress = options.compress && !raw.empty();
    writer.begin(id, flags | (compress ? kZstd : 0), raw.size());
    for (std::size_t done = 0; !compress && done < raw.size();) {
        const std::size_t count = std::min(kWriteBytes, raw.size() - done);
        writer.append(raw.subspan(done, count));
        release(done, done + count);
        done += count;
        report(options.progress, {.phase = "write", .done = done, .total = raw.size()});
    }
    if (compress) {
        zstd_compress(
            raw, [&](std::span<const std::byte> piece) { writer.append(piece); },
            [&, before = std::uint64_t{0}](std::uint64_t done) mutable {
                release(before, done);
                before = done;
                report(options.progress, {.phase = "write", .done = done, .total = raw.size()});
            });
    }
    writer.end();
}

/// The file's bytes, from where they may change or in a copy where they cannot.
class Source {
public:
    Source(const std::filesystem::path& path, bool map) {
        if (map)
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

/// The JSON text of a file's metadata, and its meaning.
Metadata decode_metadata_section(std::span<const std::byte> file, const Section& section,
                                 const std::filesystem::path& path) {
    std::shared_ptr<const Mapping> decompressed;
    std::span<const std::byte> raw = stored_bytes(file, section);
    if (section.flags & kZstd) {
        decompressed = decompress(file, section, path);
        raw = decompressed->bytes();
    }
    try {
        return decode_metadata({reinterpret_cast<const char*>(raw.data()), raw.size()});
    } catch (const Error& error) {
        throw FormatError(error.code(), "metadata", path, error.what(), section.offset);
    }
}

std::optional<Metadata> read_metadata(Source& source, const Section& section, Reading& reading) {
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
    reading.check(reading.times.validate, [&] {
        metadata = decode_metadata_section(source.bytes(), section, reading.path);
    });
    return metadata;
}

/// Words and what keeps them alive.
struct Words {
    std::span<const std::uint32_t> words;
    std::shared_ptr<const void> owner;
};

Words read_words(const Source& source, const Section& section, const std::filesystem::path& path) {
    std::shared_ptr<const Mapping> owner = source.owner();
    std::span<const std::byte> raw = stored_bytes(source.bytes(), section);
    if (section.flags & kZstd) {
        owner = decompress(source.bytes(), section, path);
        raw = owner->bytes();
    }
    return {
        {reinterpret_cast<const std::uint32_t*>(raw.data()), raw.size() / sizeof(std::uint32_t)},
        std::move(owner)};
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

/// A few bytes can stand for very many, so what all sections claim is added up before any of them
/// is given memory.
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

void check_dag_size(const Section& section, const Statistics& statistics, Reading& reading) {
    if (section.raw_bytes != statistics.dag_bytes || section.raw_bytes > kMaxDagBytes)
        throw FormatError(Errc::bad_input, "dag-size", reading.path,
                          "section DAG has " + std::to_string(section.raw_bytes) +
                              " bytes where the metadata states " +
                              std::to_string(statistics.dag_bytes),
                          section.offset);
    allow_decompressed(section, reading);
}

std::vector<Section> read_directory(Source& source, Reading& reading) {
    std::vector<Section> sections;
    reading.check(reading.times.read, [&] {
        source.fetch(0, kPageBytes);
        sections = decode_directory(source.bytes(), reading.path);
        find_section(sections, kMetadataSection, reading.path);
        find_section(sections, kDagSection, reading.path);
    });
    return sections;
}

CellValues read_channel(Source& source, const Section& section, std::uint64_t cells, int value_bits,
                        Reading& reading) {
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

Attributes read_attributes(Source& source, const std::vector<Section>& sections, const Dag& dag,
                           const AttributeSummary& summary, Reading& reading) {
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
CellLight read_light(Source& source, const std::vector<Section>& sections, const Model& model,
                     Reading& reading) {
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
    if (!options.compress)
        file.reserve(kPageBytes + round_up_to_page(json.size()) + model.dag.size_bytes());
    SectionWriter writer(file);
    writer.begin(kMetadataSection, kRequired, json.size());
    writer.append(std::as_bytes(std::span(json)));
    writer.end();
    const auto release_nodes = [&](std::uint64_t first, std::uint64_t count) {
        model.dag.release(first, count);
    };
    write_words(writer, kDagSection, kRequired, model.dag.words(), release_nodes, options);
    for (std::size_t c = 0; c < Attributes::kChannels; ++c) {
        const CellValues& values = attributes.channel(static_cast<Attributes::Channel>(c));
        const auto release_values = [&](std::uint64_t first, std::uint64_t count) {
            values.release(first, count);
        };
        if (!values.words().empty())
            write_words(writer, kAttributeSections[c], 0, values.words(), release_values, options);
    }
    const auto keep = [](std::uint64_t, std::uint64_t) {};
    if (!model.light.empty())
        write_words(writer, kLightSection, 0, model.light.words(), keep, options);
    writer.write_directory();
    file.commit();
}

Model read_model(Reading& reading) {
    const std::filesystem::path& path = reading.path;
    const bool trusted = reading.options.trusted;
    OctvReadTimes& times = reading.times;
    Model model;

    Source source(path, trusted || reading.options.map);
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
    Source source(path, false);
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
