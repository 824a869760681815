// SPDX-License-Identifier: MIT
#include "octavo/core/spill_file.h"

#include <fcntl.h>
#include <lz4.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

#include "octavo/core/error.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace octavo {
namespace {

/// Begins a block. The packed bytes follow; as many as the words take where packing did not help.
struct BlockHeader {
    std::uint32_t words;
    std::uint32_t packed_bytes;
    std::uint64_t checksum;  // XXH3-64 of the packed bytes
};
static_assert(sizeof(BlockHeader) == 16);

bool is_plausible(const BlockHeader& header) {
    return header.words > 0 && header.words <= kSpillBlockWords &&
           header.packed_bytes <= header.words * sizeof(std::uint32_t);
}

}  // namespace

SpillFile::SpillFile(std::filesystem::path path, int descriptor)
    : path_(std::move(path)), descriptor_(descriptor) {}

SpillFile::SpillFile(const std::filesystem::path& path, Kind kind) : path_(path) {
    if (kind == Kind::temporary) {
        // A name of its own, because other processes may make theirs in the same folder.
        std::string pattern = path.string() + "-XXXXXX";
        descriptor_ = ::mkostemp(pattern.data(), O_CLOEXEC);
        if (descriptor_ >= 0) ::unlink(pattern.c_str());
    } else {
        descriptor_ = ::open(path.c_str(), O_CREAT | O_TRUNC | O_RDWR | O_CLOEXEC, 0666);
    }
    if (descriptor_ < 0) throw io_error(path, "make this file");
}

SpillFile::~SpillFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

std::shared_ptr<SpillFile> SpillFile::open(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0 && errno == ENOENT) return nullptr;
    if (descriptor < 0) throw io_error(path, "open");
    return std::shared_ptr<SpillFile>(new SpillFile(path, descriptor));
}

std::uint64_t SpillFile::size() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) throw io_error(path_, "look at");
    return static_cast<std::uint64_t>(status.st_size);
}

void SpillFile::write(std::uint64_t offset, const void* data, std::size_t size) {
    const auto* from = static_cast<const char*>(data);
    const std::size_t whole = size;
    while (size > 0) {
        const ssize_t put = ::pwrite(descriptor_, from, size, static_cast<off_t>(offset));
        if (put < 0 && errno == EINTR) continue;
        if (put < 0)
            throw io_error(path_, "write " + std::to_string(whole) + " bytes after the first " +
                                      std::to_string(offset));
        from += put;
        offset += static_cast<std::uint64_t>(put);
        size -= static_cast<std::size_t>(put);
    }
}

bool SpillFile::read(std::uint64_t offset, void* data, std::size_t size) const {
    auto* to = static_cast<char*>(data);
    while (size > 0) {
        const ssize_t got = ::pread(descriptor_, to, size, static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw io_error(path_, "read");
        if (got == 0) return false;
        to += got;
        offset += static_cast<std::uint64_t>(got);
        size -= static_cast<std::size_t>(got);
    }
    return true;
}

void SpillFile::cut_at(std::uint64_t byte) {
    if (::ftruncate(descriptor_, static_cast<off_t>(byte)) != 0)
        throw io_error(path_, "cut off the end");
}

void WordWriter::put(const std::uint32_t* words, std::size_t count) {
    count_ += count;
    while (count > 0) {
        const std::size_t fit = std::min(count, kSpillBlockWords - block_.size());
        block_.insert(block_.end(), words, words + fit);
        words += fit;
        count -= fit;
        if (block_.size() == kSpillBlockWords) flush();
    }
}

std::uint64_t WordWriter::finish() {
    flush();
    return offset_;
}

void WordWriter::flush() {
    if (block_.empty()) return;
    const auto raw_bytes = static_cast<int>(block_.size() * sizeof(std::uint32_t));
    packed_.resize(sizeof(BlockHeader) + static_cast<std::size_t>(LZ4_compressBound(raw_bytes)));
    char* packed = packed_.data() + sizeof(BlockHeader);
    int size = LZ4_compress_default(reinterpret_cast<const char*>(block_.data()), packed, raw_bytes,
                                    LZ4_compressBound(raw_bytes));
    if (size <= 0 || size >= raw_bytes) {
        size = raw_bytes;
        std::memcpy(packed, block_.data(), static_cast<std::size_t>(size));
    }
    const auto bytes = static_cast<std::size_t>(size);
    const BlockHeader header{static_cast<std::uint32_t>(block_.size()),
                             static_cast<std::uint32_t>(size), XXH3_64bits(packed, bytes)};
    std::memcpy(packed_.data(), &header, sizeof header);
    file_->write(offset_, packed_.data(), sizeof header + bytes);
    offset_ += sizeof header + bytes;
    block_.clear();
}

std::uint64_t read_block(const SpillFile& file, std::uint64_t offset,
                         std::vector<std::uint32_t>& words) {
    const auto damaged = [&] {
        return Error(Errc::bad_input, file.path(), "this part of the scratch is damaged", offset);
    };
    BlockHeader header{};
    if (!file.read(offset, &header, sizeof header) || !is_plausible(header)) throw damaged();
    thread_local std::vector<char> packed;
    packed.resize(header.packed_bytes);
    if (!file.read(offset + sizeof header, packed.data(), packed.size()) ||
        XXH3_64bits(packed.data(), packed.size()) != header.checksum)
        throw damaged();

    const std::size_t before = words.size();
    words.resize(before + header.words);
    const auto raw_bytes = static_cast<int>(header.words * sizeof(std::uint32_t));
    auto* raw = reinterpret_cast<char*>(words.data() + before);
    if (static_cast<int>(header.packed_bytes) == raw_bytes) {
        std::memcpy(raw, packed.data(), packed.size());
    } else if (LZ4_decompress_safe(packed.data(), raw, static_cast<int>(packed.size()),
                                   raw_bytes) != raw_bytes) {
        throw damaged();
    }
    return offset + sizeof header + header.packed_bytes;
}

bool blocks_are_whole(const SpillFile& file, Extent extent) {
    std::vector<char> packed;
    std::uint64_t offset = extent.begin;
    while (offset < extent.end) {
        BlockHeader header{};
        if (!file.read(offset, &header, sizeof header) || !is_plausible(header)) return false;
        packed.resize(header.packed_bytes);
        if (!file.read(offset + sizeof header, packed.data(), packed.size()) ||
            XXH3_64bits(packed.data(), packed.size()) != header.checksum)
            return false;
        offset += sizeof header + header.packed_bytes;
    }
    return offset == extent.end;
}

bool WordReader::take(std::span<std::uint32_t> words) {
    while (!words.empty()) {
        const auto next = peek(1);
        if (next.empty()) return false;
        const std::size_t count = std::min(next.size(), words.size());
        std::copy_n(next.begin(), count, words.begin());
        skip(count);
        words = words.subspan(count);
    }
    return true;
}

void WordReader::fetch(std::size_t count) {
    words_.erase(words_.begin(), words_.begin() + static_cast<std::ptrdiff_t>(head_));
    head_ = 0;
    while (words_.size() < count && piece_ < pieces_.size()) {
        Extent& piece = pieces_[piece_];
        if (piece.begin >= piece.end) {
            ++piece_;
            continue;
        }
        piece.begin = read_block(*file_, piece.begin, words_);
    }
}

}  // namespace octavo
