// SPDX-License-Identifier: MIT
#include "octavo/construct/merge_parts.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "octavo/core/error.h"
#include "octavo/core/memory.h"

namespace octavo {
namespace {

constexpr std::uint64_t kMaxPieces = 256;        // of a level; each has buffers of its own
constexpr std::uint64_t kReportEvery = 1 << 16;  // nodes

/// For the nodes of one level of one part: which node of the merged level each has become. Nodes
/// have two words or more, so half an id finds the entry.
using IdTable = std::vector<std::uint32_t>;

[[noreturn]] void refuse(const PartFile& part) {
    throw Error(Errc::bad_input, part.file().path(),
                "this part of the scratch contradicts itself; delete it");
}

/// What a level's nodes and their table take in a UniqueNodes, at worst.
std::uint64_t memory_of(std::uint64_t words, std::uint64_t nodes) {
    return sizeof(std::uint32_t) * (words + words / 2) + 13 * nodes;
}

class Merger {
public:
    Merger(std::span<const std::unique_ptr<PartFile>> parts, PartFile& out,
           const MergeOptions& options)
        : parts_(parts), out_(out), options_(options) {
        for (const auto& part : parts_)
            for (int h = 0; h <= part->top(); ++h) total_ += part->words(h);
    }

    void merge() {
        for (height_ = 0; height_ <= out_.top(); ++height_) {
            ids_ =
                std::make_unique<SpillFile>(options_.scratch / "ids", SpillFile::Kind::temporary);
            ids_end_ = 0;
            id_pieces_.clear();
            merge_level();
            std::swap(ids_, ids_below_);
            std::swap(id_pieces_, id_pieces_below_);
        }
        finish();
    }

private:
    /// Calls visit(part, id in the part, words) for each node of this level, part by part, with the
    /// merged ids of its children; and end_part() after each part.
    template <class Visit, class EndPart>
    void for_each_node(const Visit& visit, const EndPart& end_part) {
        const UniqueNodes sizes(kind());
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            const PartFile& part = *parts_[p];
            const IdTable below = height_ == 0 ? IdTable() : read_ids(p);
            WordReader reader = part.level(height_);
            std::uint64_t id = 0;
            std::uint64_t until_report = kReportEvery;
            for (;;) {
                const auto next = reader.peek(kMaxNodeWords);
                if (next.empty()) break;
                const auto size = static_cast<std::size_t>(sizes.size_of(next.data()));
                if (size < kLeafWords || size > next.size()) refuse(part);
                std::array<std::uint32_t, kMaxNodeWords> node{};
                std::copy_n(next.begin(), size, node.begin());
                if (height_ > 0)
                    for (std::size_t k = 1; k < size; ++k) {
                        if (node[k] / 2 >= below.size()) refuse(part);
                        node[k] = below[node[k] / 2];
                    }
                visit(id, node.data(), static_cast<int>(size));
                reader.skip(size);
                id += size;
                if (--until_report == 0) {
                    report(options_.progress, {"merge", done_ + id, total_, 0});
                    until_report = kReportEvery;
                }
            }
            done_ += id;
            end_part();
        }
    }

    void merge_level() {
        std::uint64_t words = 0, nodes = 0, largest = 0, largest_below = 0;
        for (const auto& part : parts_) {
            words += part->words(height_);
            nodes += part->nodes(height_);
            largest = std::max(largest, part->words(height_));
            if (height_ > 0) largest_below = std::max(largest_below, part->words(height_ - 1));
        }
        const std::uint64_t table = largest_below / 2 * sizeof(std::uint32_t);
        const std::uint64_t room =
            options_.max_bytes > table + kLeastRoom ? options_.max_bytes - table : kLeastRoom;
        const std::uint64_t needed = memory_of(words, nodes);
        if (options_.max_bytes == 0 || needed <= room) {
            merge_in_memory();
        } else {
            merge_in_pieces(std::min(kMaxPieces, needed / (room / 2) + 1));
        }
    }

    void merge_in_memory() {
        UniqueNodes merged(kind(), options_.words);
        IdWriter ids(*this);
        for_each_node([&](std::uint64_t id, const std::uint32_t* node,
                          int) { ids.put(id, merged.add(node)); },
                      [&] { ids.end_part(); });
        WordWriter writer = out_.begin_level();
        writer.put(merged.words().data(), merged.words().size());
        out_.end_level(writer, merged.count());
    }

    /// Equal nodes have equal hashes, so each piece can be made unique on its own. The first pass
    /// deals the nodes out, the second finds in each piece which are equal, and the third goes
    /// through the level again in its order and gives the ids.
    void merge_in_pieces(std::uint64_t count) {
        struct Piece {
            explicit Piece(const std::filesystem::path& scratch)
                : nodes_file(scratch / "piece", SpillFile::Kind::temporary),
                  ranks_file(scratch / "ranks", SpillFile::Kind::temporary),
                  nodes(nodes_file, 0) {}
            SpillFile nodes_file;  // the nodes of this piece, in the order of the level
            SpillFile ranks_file;  // for each, how many different ones came before its first like
            WordWriter nodes;
            std::uint64_t nodes_end = 0, ranks_end = 0;
            std::vector<std::uint32_t> ids;  // by rank
        };
        std::vector<std::unique_ptr<Piece>> pieces;
        for (std::uint64_t i = 0; i < count; ++i)
            pieces.push_back(std::make_unique<Piece>(options_.scratch));

        // Which piece each node went to, four to a word; and how many nodes each part has.
        SpillFile order_file(options_.scratch / "order", SpillFile::Kind::temporary);
        WordWriter order(order_file, 0);
        std::uint32_t four = 0;
        std::uint64_t seen = 0;
        const UniqueNodes hasher(kind());
        for_each_node(
            [&](std::uint64_t, const std::uint32_t* node, int size) {
                // Not the bits that find a slot in the table.
                const auto piece = static_cast<std::uint32_t>((hasher.hash(node) >> 40) % count);
                pieces[piece]->nodes.put(node, static_cast<std::size_t>(size));
                four = four >> 8 | piece << 24;
                if (++seen % 4 == 0) order.put(four);
            },
            [] {});
        if (seen % 4 != 0) order.put(four >> 8 * (4 - seen % 4));
        const std::uint64_t order_end = order.finish();
        for (auto& piece : pieces) {
            piece->nodes_end = piece->nodes.finish();
            piece->nodes = WordWriter(piece->nodes_file, 0);  // gives its buffers back
        }

        for (auto& piece : pieces) find_first_likes(*piece);

        const UniqueNodes sizes(kind());
        WordReader order_again(order_file, {{0, order_end}});
        std::vector<WordReader> nodes, ranks;
        for (auto& piece : pieces) {
            nodes.emplace_back(piece->nodes_file, std::vector<Extent>{{0, piece->nodes_end}});
            ranks.emplace_back(piece->ranks_file, std::vector<Extent>{{0, piece->ranks_end}});
        }
        IdWriter ids(*this);
        WordWriter writer = out_.begin_level();
        std::uint64_t merged = 0;
        seen = 0;
        for (const auto& part : parts_) {
            for (std::uint64_t id = 0; id < part->words(height_);) {
                if (seen % 4 == 0) {
                    four = order_again.peek(1)[0];
                    order_again.skip(1);
                }
                const std::size_t p = four >> 8 * (seen++ % 4) & 0xffu;
                const auto node = nodes[p].peek(kMaxNodeWords);
                const auto size = static_cast<std::size_t>(sizes.size_of(node.data()));
                const std::uint32_t rank = ranks[p].peek(1)[0];
                ranks[p].skip(1);
                std::vector<std::uint32_t>& piece_ids = pieces[p]->ids;
                if (rank == piece_ids.size()) {
                    options_.words.check_level(writer.count() + size);
                    piece_ids.push_back(static_cast<std::uint32_t>(writer.count()));
                    writer.put(node.data(), size);
                    ++merged;
                }
                ids.put(id, piece_ids[rank]);
                nodes[p].skip(size);
                id += size;
                if (seen % kReportEvery == 0)
                    report(options_.progress, {"merge", done_, total_, 0});
            }
            ids.end_part();
        }
        out_.end_level(writer, merged);
    }

    template <class Piece>
    void find_first_likes(Piece& piece) {
        UniqueNodes merged(kind());
        std::vector<std::uint32_t> rank_of;  // by half the id
        WordReader nodes(piece.nodes_file, {{0, piece.nodes_end}});
        WordWriter ranks(piece.ranks_file, 0);
        for (;;) {
            const auto node = nodes.peek(kMaxNodeWords);
            if (node.empty()) break;
            const std::uint64_t before = merged.count();
            const std::uint32_t id = merged.add(node.data());
            if (rank_of.size() <= id / 2) rank_of.resize(id / 2 + 1);
            if (merged.count() > before) rank_of[id / 2] = static_cast<std::uint32_t>(before);
            ranks.put(rank_of[id / 2]);
            nodes.skip(static_cast<std::size_t>(merged.size_of(node.data())));
            if (ranks.count() % kReportEvery == 0)
                report(options_.progress, {"merge", done_, total_, 0});
        }
        piece.ranks_end = ranks.finish();
        piece.ids.reserve(merged.count());
    }

    /// Writes the IdTable of each part, in the order of its nodes.
    class IdWriter {
    public:
        explicit IdWriter(Merger& merger) : merger_(merger), writer_(*merger.ids_, 0) {}
        void put(std::uint64_t id, std::uint32_t merged) {
            while (writer_.count() < id / 2) writer_.put(0);
            writer_.put(merged);
        }
        void end_part() {
            const std::uint64_t end = writer_.finish();
            merger_.id_pieces_.push_back({{merger_.ids_end_, end}, writer_.count()});
            merger_.ids_end_ = end;
            writer_ = WordWriter(*merger_.ids_, end);
        }

    private:
        Merger& merger_;
        WordWriter writer_;
    };

    IdTable read_ids(std::size_t part) const {
        IdTable ids(id_pieces_below_[part].count);
        WordReader reader(*ids_below_, {id_pieces_below_[part].extent});
        if (!reader.take(ids)) refuse(*parts_[part]);
        return ids;
    }

    /// After the top level: the tiles' roots.
    void finish() {
        std::vector<CellNode> roots;
        PartState state = parts_.front()->state();
        state.counts = {};
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            const IdTable ids = read_ids(p);
            for (const CellNode& root : parts_[p]->roots()) {
                if (root.node / 2 >= ids.size()) refuse(*parts_[p]);
                roots.push_back({root.code, ids[root.node / 2]});
            }
            state.counts.add(parts_[p]->state().counts);
        }
        state.end_tile = parts_.back()->state().end_tile;
        out_.end_segment(state, roots, true);
    }

    [[nodiscard]] UniqueNodes::Kind kind() const {
        return height_ == 0 ? UniqueNodes::Kind::leaves : UniqueNodes::Kind::interior;
    }

    // A piece smaller than this is not worth its buffers.
    static constexpr std::uint64_t kLeastRoom = std::uint64_t{1} << 20;

    struct IdPiece {
        Extent extent;
        std::uint64_t count = 0;
    };

    std::span<const std::unique_ptr<PartFile>> parts_;
    PartFile& out_;
    const MergeOptions& options_;
    int height_ = 0;
    std::unique_ptr<SpillFile> ids_, ids_below_;
    std::uint64_t ids_end_ = 0;
    std::vector<IdPiece> id_pieces_, id_pieces_below_;  // of each part
    std::uint64_t done_ = 0, total_ = 0;                // words
};

}  // namespace

void merge_parts(std::span<const std::unique_ptr<PartFile>> parts, PartFile& out,
                 const MergeOptions& options) {
    Merger(parts, out, options).merge();
}

std::unique_ptr<PartFile> merge_into_one(std::vector<std::unique_ptr<PartFile>> parts,
                                         const Scratch& scratch, const MemoryLimits& limits,
                                         const ProgressFunction& progress) {
    if (parts.size() == 1) return std::move(parts.front());
    auto merged = scratch.make_merged_part();
    merge_parts(parts, *merged,
                {.max_bytes = limits.room_to_merge(),
                 .words = limits.words,
                 .scratch = scratch.folder(),
                 .progress = progress});
    trim_memory();
    return merged;
}

}  // namespace octavo
