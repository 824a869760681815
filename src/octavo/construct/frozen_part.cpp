// SPDX-License-Identifier: MIT
#include "octavo/construct/frozen_part.h"

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "octavo/construct/reduce.h"
#include "octavo/core/error.h"
#include "octavo/core/mapped_words.h"

namespace octavo {
namespace {

/// Writes words to a file as they are, through a buffer.
class RawWriter {
public:
    explicit RawWriter(SpillFile& file) : file_(file) {}
    void put(std::uint32_t word) {
        buffer_.push_back(word);
        if (buffer_.size() == kBufferWords) flush();
    }
    void flush() {
        const std::size_t bytes = buffer_.size() * sizeof(std::uint32_t);
        file_.write(end_, buffer_.data(), bytes);
        end_ += bytes;
        buffer_.clear();
    }

private:
    static constexpr std::size_t kBufferWords = std::size_t{1} << 18;

    SpillFile& file_;
    std::uint64_t end_ = 0;
    std::vector<std::uint32_t> buffer_;
};

/// Copies the nodes of a level and moves their pointers on to where the next level begins.
class Copier {
public:
    Copier(RawWriter& out, std::uint64_t children_begin, bool leaves)
        : out_(out), children_begin_(static_cast<std::uint32_t>(children_begin)), leaves_(leaves) {}

    void put(std::span<const std::uint32_t> words) {
        for (const std::uint32_t word : words) {
            if (leaves_) {
                out_.put(word);
            } else if (left_ == 0) {
                left_ = node_words(word) - 1;
                out_.put(word);
            } else {
                --left_;
                out_.put(word + children_begin_);
            }
        }
    }

private:
    RawWriter& out_;
    std::uint32_t children_begin_;
    bool leaves_;
    int left_ = 0;  // pointers of the node that has begun
};

}  // namespace

Constructed freeze_part(const PartFile& part, int depth, const std::filesystem::path& scratch,
                        const ProgressFunction& progress, const WordLimits& limits) {
    const int root_height = depth - 2;
    OctreeCounts counts = part.state().counts;
    NodeStore above(root_height, limits);
    {
        std::vector<CellNode> cells = part.roots();
        reduce_upwards(above, part.top() + 1, cells, counts);
    }

    std::vector<std::uint64_t> level_words, level_nodes;
    for (int h = root_height; h >= 0; --h) {
        level_words.push_back(h > part.top() ? above.level(h).words().size() : part.words(h));
        level_nodes.push_back(h > part.top() ? above.level(h).count() : part.nodes(h));
    }
    std::vector<std::uint64_t> begins = level_begins(level_words, limits);
    const std::uint64_t total = begins.back();

    SpillFile file(scratch / "words", SpillFile::Kind::temporary);
    RawWriter out(file);
    for (int h = root_height; h >= 0; --h) {
        const auto level = static_cast<std::size_t>(root_height - h);
        Copier copier(out, begins[level + 1], h == 0);
        if (h > part.top()) {
            copier.put(above.level(h).words());
            continue;
        }
        WordReader reader = part.level(h);
        for (std::uint64_t done = begins[level]; done < begins[level + 1];) {
            const auto words = reader.peek(1);
            if (words.empty())
                throw Error(Errc::bad_input, part.file().path(), "this part of the scratch is cut");
            copier.put(words);
            done += words.size();
            reader.skip(words.size());
            report(progress, {"freeze", done, total, 0});
        }
    }
    out.flush();

    auto words = std::make_shared<const MappedWords>(file, total);
    const std::span<const std::uint32_t> span = words->words();
    Statistics statistics = statistics_of(depth, counts, begins, level_nodes);
    return {Dag(depth, std::move(begins), span, std::move(words), Dag::Backing::mapped_file),
            std::move(statistics)};
}

}  // namespace octavo
