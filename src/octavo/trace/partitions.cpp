// SPDX-License-Identifier: MIT
#include "octavo/trace/partitions.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <new>
#include <vector>

#include "octavo/dag/node.h"

namespace octavo {
namespace {

/// Rays that ask for a table before it is made, and that each table has to answer before there are
/// more. What a table of this height saves them takes about as long as to make it; one twice as
/// wide takes four times as long, and answers more rays that pass by.
constexpr std::uint32_t kRaysForTable = 8192;
constexpr int kHeightOfThese = 6;
constexpr std::uint32_t kRaysOnFlight = 32;

constexpr std::uint64_t kLeastRoom = 128 << 10;  // bytes that tables may always take

constexpr int kBlocks = Partitions::kBlocks;

/// The voxels of one node as rows of bits along x, and the connected parts of what is empty: runs
/// of empty voxels in a row, joined where they touch.
class NodeSpace {
public:
    NodeSpace(const Dag& dag, std::uint32_t node, int height)
        : dag_(dag),
          side_(1 << height),
          row_words_(std::max(1, side_ / 64)),
          full_(std::size_t(side_) * side_ * row_words_, 0),
          first_run_(std::size_t(side_) * side_) {
        fill(node, height, 0, 0, 0);
        for (int z = 0; z < side_; ++z)
            for (int y = 0; y < side_; ++y) find_runs(y, z);
        for (int z = 0; z < side_; ++z)
            for (int y = 0; y < side_; ++y) join_row(y, z);
    }

    /// @param table  all zero
    void write(std::uint8_t* table) {
        for (int z = 0; z < side_; ++z)
            for (int y = 0; y < side_; ++y) {
                const bool at_face = y == 0 || y == side_ - 1 || z == 0 || z == side_ - 1;
                for (std::uint32_t run = first_run_[row(y, z)];; ++run) {
                    const int from = runs_[run].from, to = runs_[run].to;
                    if (from == to) break;
                    if (at_face) {
                        for (int x = block(from); x <= block(to - 1); ++x)
                            table[place(x, y, z)] |= label(run);
                    } else {
                        if (from == 0) table[place(0, y, z)] |= label(run);
                        if (to == side_) table[place(kBlocks - 1, y, z)] |= label(run);
                    }
                }
            }
    }

private:
    struct Run {
        std::int32_t from, to;  // equal at a row's end
        std::uint32_t parent;   // in the union of those that are connected
    };

    [[nodiscard]] std::size_t row(int y, int z) const { return std::size_t(z) * side_ + y; }
    [[nodiscard]] int block(int x) const { return x * kBlocks / side_; }
    [[nodiscard]] std::size_t place(int x_block, int y, int z) const {
        return static_cast<unsigned>(x_block + kBlocks * (block(y) + kBlocks * block(z)));
    }

    void fill(std::uint32_t node, int height, int x, int y, int z) {
        if (height == 2) return fill_leaf(dag_.leaf(node), x, y, z);
        const std::uint32_t children = dag_.words()[node] & kChildMaskBits;
        const int half = 1 << (height - 1);
        for (int child = 0; child < 8; ++child)
            if ((children >> child & 1) != 0)
                fill(dag_.words()[node + static_cast<std::uint32_t>(child_offset(children, child))],
                     height - 1, x + (child & 1) * half, y + (child >> 1 & 1) * half,
                     z + (child >> 2) * half);
    }
    void fill_leaf(std::uint64_t leaf, int x, int y, int z) {
        for (int i = 0; i < 16; ++i) {
            // Morton order: x has bits 0 and 3, y 1 and 4, z 2 and 5.
            const int dy = i & 3, dz = i >> 2;
            const int first = (dy & 1) * 2 + (dz & 1) * 4 + (dy >> 1) * 16 + (dz >> 1) * 32;
            const std::uint64_t four = (leaf >> first & 3) | (leaf >> (first + 8) & 3) << 2;
            full_[row(y + dy, z + dz) * row_words_ + std::size_t(x / 64)] |= four << (x % 64);
        }
    }

    /// A row like the one before it, on y or on z, has its runs: they touch all along.
    void find_runs(int y, int z) {
        const std::size_t here = row(y, z);
        for (const std::size_t other : {y > 0 ? here - 1 : here, z > 0 ? here - side_ : here})
            if (other != here && are_equal(here, other)) {
                first_run_[here] = first_run_[other];
                return;
            }
        first_run_[here] = static_cast<std::uint32_t>(runs_.size());
        for (int x = next(here, 0, false); x < side_;) {
            const int end = next(here, x, true);
            runs_.push_back({x, end, static_cast<std::uint32_t>(runs_.size())});
            x = next(here, end, false);
        }
        runs_.push_back({side_, side_, 0});
    }
    [[nodiscard]] bool are_equal(std::size_t a, std::size_t b) const {
        std::uint64_t differ = 0;
        for (std::size_t i = 0; i < row_words_; ++i) differ |= words(a)[i] ^ words(b)[i];
        return differ == 0;
    }
    [[nodiscard]] const std::uint64_t* words(std::size_t row) const {
        return full_.data() + row * row_words_;
    }
    /// The first voxel of a row from x on that is full, or that is not; or the row's end.
    [[nodiscard]] int next(std::size_t row, int x, bool full) const {
        for (; x < side_; x = (x / 64 + 1) * 64) {
            const std::uint64_t word = words(row)[x / 64];
            const std::uint64_t rest = (full ? word : ~word) >> (x % 64);
            if (rest != 0) return std::min(x + std::countr_zero(rest), side_);
        }
        return side_;
    }

    /// With its neighbours before it.
    void join_row(int y, int z) {
        const std::size_t here = row(y, z);
        if (y > 0) join(here, here - 1, false);
        if (z == 0) return;
        const std::size_t below = here - side_;
        // What the row before this one has been joined with already.
        const bool same = y > 0 && first_run_[here] == first_run_[here - 1];
        if (y > 0) join(here, below - 1, same && y > 1);
        join(here, below, same);
        if (y + 1 < side_) join(here, below + 1, same);
    }
    void join(std::size_t a, std::size_t b, bool a_like_before) {
        if (first_run_[a] == first_run_[b]) return;
        if (a_like_before && first_run_[b] == first_run_[b - 1]) return;
        std::uint32_t i = first_run_[a], j = first_run_[b];
        while (runs_[i].from < runs_[i].to && runs_[j].from < runs_[j].to) {
            if (runs_[i].from <= runs_[j].to && runs_[j].from <= runs_[i].to) unite(i, j);
            runs_[i].to < runs_[j].to ? ++i : ++j;
        }
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = root(a);
        b = root(b);
        runs_[std::max(a, b)].parent = std::min(a, b);
    }
    std::uint32_t root(std::uint32_t run) {
        while (runs_[run].parent != run) run = runs_[run].parent = runs_[runs_[run].parent].parent;
        return run;
    }

    std::uint8_t label(std::uint32_t run) {
        const std::uint32_t part = root(run);
        const auto known = std::find(labels_.begin(), labels_.end(), part);
        const auto number = static_cast<std::size_t>(known - labels_.begin());
        if (known == labels_.end() && number < 7) labels_.push_back(part);
        return static_cast<std::uint8_t>(1u << number);
    }

    const Dag& dag_;
    int side_;
    std::size_t row_words_;
    std::vector<std::uint64_t> full_;
    std::vector<std::uint32_t> first_run_;  // of each row
    std::vector<Run> runs_;
    std::vector<std::uint32_t> labels_;  // the parts with a bit of their own
};

}  // namespace

int Partitions::usual_height(int depth, Pace pace) {
    // Wider ones take longer to make than they save, and of narrower ones rays have to find more.
    return pace == Pace::picture ? std::clamp(depth - 6, 6, 8) : std::clamp(depth - 5, 6, 9);
}

Partitions::Partitions(const Dag& dag, int height, Pace pace)
    : dag_(dag),
      rays_for_table_(pace == Pace::flight
                          ? kRaysOnFlight
                          : kRaysForTable << std::clamp(height - kHeightOfThese, 0, 2)) {
    if (dag.empty() || height < 3 || height >= dag.depth()) return;
    height_ = height;
    const int level = dag.depth() - height;
    first_word_ = dag.level_begin(level);
    last_word_ = dag.level_begin(level + 1);
    states_count_ = static_cast<std::size_t>(last_word_ - first_word_) / 2 + 1;
    states_ = std::make_unique<std::atomic<std::uint32_t>[]>(states_count_);
    const std::uint64_t states_bytes = states_count_ * sizeof(states_[0]);
    const std::uint64_t half = std::max(dag.size_bytes() / 2, kLeastRoom);
    most_ = std::min<std::uint64_t>(
        {states_count_, (half - std::min(half, states_bytes)) / kTableBytes, 1u << 31});
    // Four bytes are read at a time.
    tables_ = std::make_unique_for_overwrite<std::uint8_t[]>(most_ * kTableBytes + 3);
}

const std::uint8_t* Partitions::want(std::uint32_t node, int rays) noexcept {
    std::atomic<std::uint32_t>& state = states_[place(node)];
    std::uint32_t asked = state.load(std::memory_order_relaxed);
    if (asked >= kMaking) return nullptr;
    const std::uint32_t now = asked + static_cast<std::uint32_t>(rays);
    if (now < rays_for_table_) {
        // Where two threads add at once, one may be lost.
        state.compare_exchange_strong(asked, now, std::memory_order_relaxed);
        return nullptr;
    }
    return pays() ? make(node) : nullptr;
}

const std::uint8_t* Partitions::make(std::uint32_t node) noexcept {
    std::atomic<std::uint32_t>& state = states_[place(node)];
    std::uint32_t before = state.load(std::memory_order_relaxed);
    if (count() >= most_ || before >= kMaking || !state.compare_exchange_strong(before, kMaking))
        return nullptr;
    try {
        NodeSpace space(dag_, node, height_);
        const std::uint32_t number = count_.fetch_add(1, std::memory_order_relaxed);
        if (number >= most_) {
            count_.fetch_sub(1, std::memory_order_relaxed);
            return nullptr;
        }
        std::fill_n(table(number), kTableBytes, std::uint8_t{0});
        space.write(table(number));
        state.store(kMaking + 1 + number, std::memory_order_release);
        return table(number);
    } catch (const std::bad_alloc&) {
        return nullptr;  // and it is never asked for again
    }
}

void Partitions::make_all() {
    if (height_ == 0) return;
    std::vector<std::uint32_t> nodes;
    for (std::uint64_t word = first_word_; word < last_word_;
         word += static_cast<std::uint64_t>(node_words(dag_.words()[word])))
        nodes.push_back(static_cast<std::uint32_t>(word));
    tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) { make(nodes[i]); });
}

}  // namespace octavo
