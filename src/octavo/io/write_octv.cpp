// SPDX-License-Identifier: MIT
#include <xxhash.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>

#include "octavo/core/atomic_file.h"
#include "octavo/core/error.h"
#include "octavo/io/compression.h"
#include "octavo/io/container.h"
#include "octavo/io/octv.h"

namespace octavo {
namespace {

using namespace octv;

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

}  // namespace octavo
