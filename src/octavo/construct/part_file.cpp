// SPDX-License-Identifier: MIT
#include "octavo/construct/part_file.h"

#include <array>
#include <cstddef>
#include <utility>

#include "octavo/core/error.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace octavo {
namespace {

constexpr std::uint64_t kMagic = 0x3254'5241'504f'564full;  // "OVOPART2"
constexpr int kMaxHeights = kMaxDepth - 1;

}  // namespace

/// Begins a segment. The blocks of each level follow, leaves first, then those of the tile roots.
struct PartFile::Header {
    std::uint64_t magic, key;
    std::uint64_t first_tile, end_tile;  // of the whole part so far, as are the counts
    std::uint64_t closed;
    OctreeCounts counts;
    std::uint64_t new_roots, roots_bytes;
    struct {
        std::uint64_t words, nodes, bytes;  // new in this segment
    } levels[kMaxHeights];
    std::uint64_t hash;  // of all above

    [[nodiscard]] std::uint64_t computed_hash() const {
        return XXH3_64bits(this, offsetof(Header, hash));
    }
};

PartFile::PartFile(std::shared_ptr<SpillFile> file, std::uint64_t key, int top)
    : file_(std::move(file)), key_(key), top_(top), levels_(static_cast<std::size_t>(top) + 1) {}

std::unique_ptr<PartFile> PartFile::create(const std::filesystem::path& path, std::uint64_t key,
                                           int top, SpillFile::Kind kind) {
    auto file = std::make_shared<SpillFile>(path, kind);
    return std::unique_ptr<PartFile>(new PartFile(std::move(file), key, top));
}

std::unique_ptr<PartFile> PartFile::open(const std::filesystem::path& path, std::uint64_t key,
                                         int top) {
    auto file = SpillFile::open(path);
    return file ? adopt(std::move(file), key, top) : nullptr;
}

std::unique_ptr<PartFile> PartFile::adopt(std::shared_ptr<SpillFile> file, std::uint64_t key,
                                          int top) {
    std::unique_ptr<PartFile> part(new PartFile(std::move(file), key, top));
    const std::uint64_t size = part->file_->size();
    while (part->read_segment(size)) {
    }
    if (part->end_ == 0) return nullptr;
    part->file_->cut_at(part->end_);
    return part;
}

bool PartFile::read_segment(std::uint64_t file_size) {
    Header header;
    if (closed_ || !file_->read(end_, &header, sizeof header) || header.magic != kMagic ||
        header.hash != header.computed_hash() || header.key != key_)
        return false;
    std::uint64_t bytes = sizeof header + header.roots_bytes;
    for (int h = 0; h <= top_; ++h) bytes += header.levels[h].bytes;
    if (bytes > file_size - end_ || !blocks_are_whole(*file_, {end_ + sizeof header, end_ + bytes}))
        return false;

    std::uint64_t at = end_ + sizeof header;
    for (int h = 0; h <= top_; ++h) {
        Level& level = levels_[static_cast<std::size_t>(h)];
        level.words += header.levels[h].words;
        level.nodes += header.levels[h].nodes;
        level.pieces.push_back({at, at + header.levels[h].bytes});
        at += header.levels[h].bytes;
    }
    root_pieces_.push_back({at, at + header.roots_bytes});
    root_count_ += header.new_roots;
    state_ = {header.first_tile, header.end_tile, header.counts};
    closed_ = header.closed != 0;
    end_ += bytes;
    return true;
}

WordWriter PartFile::begin_level() {
    if (new_levels_.empty()) new_end_ = end_ + sizeof(Header);
    return {*file_, new_end_};
}

void PartFile::end_level(WordWriter& writer, std::uint64_t nodes) {
    const std::uint64_t end = writer.finish();
    new_levels_.push_back({writer.count(), nodes, {{new_end_, end}}});
    new_end_ = end;
}

void PartFile::end_segment(const PartState& state, std::span<const CellNode> roots, bool closed) {
    const std::span<const CellNode> new_roots = roots.subspan(root_count_);
    WordWriter writer(*file_, new_end_);
    for (const CellNode& root : new_roots) {
        writer.put(root.code);
        writer.put(root.node);
    }
    const std::uint64_t end = writer.finish();

    Header header{};
    header.magic = kMagic;
    header.key = key_;
    header.first_tile = state.first_tile;
    header.end_tile = state.end_tile;
    header.closed = closed;
    header.counts = state.counts;
    header.new_roots = new_roots.size();
    header.roots_bytes = end - new_end_;
    for (std::size_t h = 0; h < new_levels_.size(); ++h) {
        const Extent piece = new_levels_[h].pieces[0];
        header.levels[h] = {new_levels_[h].words, new_levels_[h].nodes, piece.end - piece.begin};
    }
    header.hash = header.computed_hash();
    // Last, so that a segment without its end has no beginning.
    file_->write(end_, &header, sizeof header);

    for (std::size_t h = 0; h < new_levels_.size(); ++h) {
        levels_[h].words += new_levels_[h].words;
        levels_[h].nodes += new_levels_[h].nodes;
        levels_[h].pieces.push_back(new_levels_[h].pieces[0]);
    }
    new_levels_.clear();
    root_pieces_.push_back({new_end_, end});
    root_count_ = roots.size();
    end_ = end;
    state_ = state;
    closed_ = closed;
}

void PartFile::append(const NodeStore& store, const PartState& state,
                      std::span<const CellNode> roots, bool closed) {
    try {
        for (int h = 0; h <= top_; ++h) {
            const UniqueNodes& nodes = store.level(h);
            const auto added = nodes.words().subspan(words(h));
            WordWriter writer = begin_level();
            writer.put(added.data(), added.size());
            end_level(writer, nodes.count() - this->nodes(h));
        }
        end_segment(state, roots, closed);
    } catch (...) {
        new_levels_.clear();
        throw;
    }
}

void PartFile::restore(NodeStore& store) const {
    for (int h = 0; h <= top_; ++h) {
        UniqueNodes& nodes = store.level(h);
        WordReader reader = level(h);
        for (;;) {
            const auto next = reader.peek(kMaxNodeWords);
            if (next.empty()) break;
            const auto size = static_cast<std::size_t>(nodes.size_of(next.data()));
            if (size > next.size() || !nodes.extend(next.first(size)))
                throw Error(Errc::bad_input, file_->path(),
                            "this part of the scratch contradicts itself; delete it");
            reader.skip(size);
        }
    }
}

std::vector<CellNode> PartFile::roots() const {
    std::vector<CellNode> roots(root_count_);
    WordReader reader(*file_, root_pieces_);
    for (CellNode& root : roots) {
        std::array<std::uint32_t, 2> words{};
        if (!reader.take(words))
            throw Error(Errc::bad_input, file_->path(),
                        "this part of the scratch contradicts itself; delete it");
        root = {words[0], words[1]};
    }
    return roots;
}

void PartFile::remove() {
    std::error_code ignored;  // one that stays is overwritten or passed over by the next build
    std::filesystem::remove(file_->path(), ignored);
}

}  // namespace octavo
