// SPDX-License-Identifier: MIT
#include "octavo/attributes/cell_values_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <utility>

#include "octavo/core/error.h"

namespace octavo {
namespace {

constexpr std::size_t kSpillWords = std::size_t{1} << 14;  // written to a file at once

constexpr std::uint64_t words_of_bits(std::uint64_t bits) {
    return (bits + 31) / 32;
}

/// Writes bits one after the other, from the lowest of each word.
class BitWriter {
public:
    explicit BitWriter(std::vector<std::uint32_t>& words) : words_(words) {}
    ~BitWriter() {
        if (filled_ > 0) words_.push_back(static_cast<std::uint32_t>(waiting_));
    }
    BitWriter(const BitWriter&) = delete;
    BitWriter& operator=(const BitWriter&) = delete;

    void add(std::uint32_t value, int bits) {
        waiting_ |= std::uint64_t{value} << filled_;
        filled_ += bits;
        if (filled_ < 32) return;
        words_.push_back(static_cast<std::uint32_t>(waiting_));
        waiting_ >>= 32;
        filled_ -= 32;
    }

private:
    std::vector<std::uint32_t>& words_;
    std::uint64_t waiting_ = 0;
    int filled_ = 0;
};

bool near(std::uint32_t a, std::uint32_t b, int tolerance) {
    if (a >> 24 != b >> 24) return false;
    for (int shift = 0; shift < 24; shift += 8)
        if (std::abs(static_cast<int>(a >> shift & 255u) - static_cast<int>(b >> shift & 255u)) >
            tolerance)
            return false;
    return true;
}

/// The palette of the values seen so far. An open-addressed table finds a value that is in it.
class Palette {
public:
    explicit Palette(std::vector<std::uint32_t>& entries) : entries_(entries) { entries.clear(); }

    std::uint8_t index_of(std::uint32_t value, int tolerance) {
        std::uint32_t slot = value * 0x9e3779b1u >> 23;
        for (; slots_[slot] != 0; slot = (slot + 1) % kSlots)
            if (keys_[slot] == value) return static_cast<std::uint8_t>(slots_[slot] - 1);
        std::uint32_t found = static_cast<std::uint32_t>(entries_.size());
        for (std::uint32_t i = 0; tolerance > 0 && i < entries_.size(); ++i)
            if (near(entries_[i], value, tolerance)) {
                found = i;
                break;
            }
        if (found == entries_.size()) entries_.push_back(value);
        keys_[slot] = value;
        slots_[slot] = static_cast<std::uint16_t>(found + 1);
        return static_cast<std::uint8_t>(found);
    }

private:
    static constexpr std::uint32_t kSlots = 512;  // at most 256 values: half full
    std::vector<std::uint32_t>& entries_;
    std::array<std::uint32_t, kSlots> keys_;
    std::array<std::uint16_t, kSlots> slots_{};  // index + 1
};

}  // namespace

void BlockPacker::pack(std::span<const std::uint32_t> values, PackedBlocks& out) {
    std::uint32_t any = 0;
    for (const std::uint32_t value : values) any |= value;
    if (any == 0) {
        out.begins.push_back(0);
        return;
    }
    out.begins.push_back(static_cast<std::uint32_t>(out.words.size()) + 1);
    if (!find_palette(values)) {
        // Only what a palette saves is worth an error.
        out.words.push_back(CellValues::kRaw);
        BitWriter bits(out.words);
        for (const std::uint32_t value : values) bits.add(value, value_bits_);
        return;
    }
    const auto colors = static_cast<std::uint32_t>(palette_.size());
    const int index_bits = std::bit_width(colors - 1);
    out.words.push_back(static_cast<unsigned>(index_bits) | colors << 8);
    BitWriter bits(out.words);
    for (const std::uint32_t color : palette_) bits.add(color, value_bits_);
    for (const std::uint8_t index : indices_) bits.add(index, index_bits);
}

bool BlockPacker::find_palette(std::span<const std::uint32_t> values) {
    const std::uint64_t width = static_cast<unsigned>(value_bits_);
    const std::uint64_t raw_words = words_of_bits(values.size() * width);
    const auto pays = [&](std::uint64_t colors) {
        return words_of_bits(colors * width +
                             values.size() * static_cast<unsigned>(std::bit_width(colors - 1))) <
               raw_words;
    };
    indices_.clear();
    Palette palette(palette_);
    std::size_t colors = 0;
    for (const std::uint32_t value : values) {
        indices_.push_back(palette.index_of(value, tolerance_));
        if (palette_.size() == colors) continue;
        colors = palette_.size();
        if (!pays(colors)) return false;
    }
    return true;
}

void CellValuesWriter::check_room() const {
    if (blocks_.begins.size() + spilled_ + blocks_.words.size() + CellValues::kHeaderWords >=
        CellValues::kMaxWords)
        throw Error(Errc::limit,
                    "an attribute takes more than 16 GiB; lower the attribute resolution");
}

void CellValuesWriter::append(std::span<const std::uint32_t> values) {
    count_ += values.size();
    while (!values.empty()) {
        const std::size_t some = std::min(values.size(), CellValues::kBlockCells - pending_.size());
        pending_.insert(pending_.end(), values.begin(), values.begin() + static_cast<long>(some));
        values = values.subspan(some);
        if (pending_.size() < CellValues::kBlockCells) return;
        pack_pending();
    }
    check_room();
}

void CellValuesWriter::pack_pending() {
    packed_.begins.clear();
    packed_.words.clear();
    packer_.pack(pending_, packed_);
    pending_.clear();
    put(packed_);
}

void CellValuesWriter::append(const PackedBlocks& blocks) {
    put(blocks);
    count_ += CellValues::kBlockCells * blocks.begins.size();
    check_room();
}

void CellValuesWriter::put(const PackedBlocks& blocks) {
    const auto base = static_cast<std::uint32_t>(spilled_ + blocks_.words.size() - head_words());
    for (const std::uint32_t begin : blocks.begins)
        blocks_.begins.push_back(begin == 0 ? 0 : begin + base);
    blocks_.words.insert(blocks_.words.end(), blocks.words.begin(), blocks.words.end());
    if (file_ && blocks_.words.size() >= kSpillWords) spill();
}

void CellValuesWriter::spill() {
    file_->write((data_begin_ + spilled_) * sizeof(std::uint32_t), blocks_.words.data(),
                 blocks_.words.size() * sizeof(std::uint32_t));
    spilled_ += blocks_.words.size();
    blocks_.words.clear();
}

CellValues CellValuesWriter::finish() && {
    if (!pending_.empty()) pack_pending();
    check_room();
    const auto data = CellValues::kHeaderWords + static_cast<std::uint32_t>(blocks_.begins.size());
    std::vector<std::uint32_t> all;
    all.reserve(data_begin_ != 0 ? data : data + blocks_.words.size());
    all.push_back(static_cast<std::uint32_t>(packer_.value_bits()));
    all.push_back(static_cast<std::uint32_t>(blocks_.begins.size()));
    for (const std::uint32_t begin : blocks_.begins)
        all.push_back(begin == 0 ? 0 : begin - 1 + data);
    blocks_.begins = {};
    if (data_begin_ != 0 && data != data_begin_)
        throw Error(Errc::bad_argument, "there are not as many cells as was said");
    if (file_) {
        spill();
        file_->write(0, all.data(), all.size() * sizeof(std::uint32_t));
        auto mapped = std::make_shared<const MappedWords>(*file_, data_begin_ + spilled_);
        file_.reset();
        const std::span<const std::uint32_t> words = mapped->words();
        return {words, count_, std::move(mapped), Dag::Backing::mapped_file};
    }
    if (head_words() != 0) {
        std::copy(all.begin(), all.end(), blocks_.words.begin());
        all = std::move(blocks_.words);
    } else {
        all.insert(all.end(), blocks_.words.begin(), blocks_.words.end());
    }
    blocks_ = {};
    auto owned = std::make_shared<const std::vector<std::uint32_t>>(std::move(all));
    const std::span<const std::uint32_t> words(*owned);
    return {words, count_, std::move(owned)};
}

}  // namespace octavo
