// SPDX-License-Identifier: MIT
#include "octavo/construct/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <span>
#include <utility>

#include "octavo/core/error.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace octavo {
namespace {

constexpr std::uint64_t kMagic = 0x314c'4e52'4a56'544full;  // "OTVJRNL1"

/// Begins a segment. The payload follows: for each level, leaves first, a 64-bit count of words and
/// the new words; then the new tile roots.
struct Header {
    std::uint64_t magic;
    std::uint64_t key;
    std::uint64_t tiles_done;
    std::uint64_t voxels;
    std::uint64_t new_roots;
    std::uint64_t payload_bytes;
    std::uint64_t payload_hash;
    std::uint64_t header_hash;  // of the seven words above
};
static_assert(sizeof(Header) == 64);

std::uint64_t hash_of(const Header& header) {
    return XXH3_64bits(&header, offsetof(Header, header_hash));
}

/// Takes values off the front of a segment's payload; false where there are not enough bytes.
class Payload {
public:
    explicit Payload(std::span<const std::byte> bytes) : bytes_(bytes) {}

    template <class T>
    [[nodiscard]] bool take(T* values, std::size_t count) {
        if (count > bytes_.size() / sizeof(T)) return false;
        if (count > 0) std::memcpy(values, bytes_.data(), count * sizeof(T));
        bytes_ = bytes_.subspan(count * sizeof(T));
        return true;
    }
    [[nodiscard]] std::size_t size() const { return bytes_.size(); }

private:
    std::span<const std::byte> bytes_;
};

}  // namespace

/// The open, locked file.
class Journal::File {
public:
    File(const std::filesystem::path& path, int flags) : path_(path) {
        descriptor_ = ::open(path.c_str(), flags | O_RDWR | O_CLOEXEC, 0666);
        if (descriptor_ < 0) {
            if (errno == ENOENT) return;
            throw io_error(path, "open the journal");
        }
        if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
            ::close(descriptor_);
            throw Error(Errc::io, path, "another build is writing this journal");
        }
    }
    ~File() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }

    [[nodiscard]] std::uint64_t size() const {
        struct stat status {};
        if (::fstat(descriptor_, &status) != 0) throw io_error(path_, "look at the journal");
        return static_cast<std::uint64_t>(status.st_size);
    }

    /// Reads exactly this many bytes; false at the end of the file.
    [[nodiscard]] bool read(void* data, std::size_t size) {
        auto* to = static_cast<char*>(data);
        while (size > 0) {
            const ssize_t got = ::read(descriptor_, to, size);
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) throw io_error(path_, "read the journal");
            if (got == 0) return false;
            to += got;
            size -= static_cast<std::size_t>(got);
        }
        return true;
    }

    void write(const void* data, std::size_t size) {
        const auto* from = static_cast<const char*>(data);
        while (size > 0) {
            const ssize_t put = ::write(descriptor_, from, size);
            if (put < 0 && errno == EINTR) continue;
            if (put < 0) throw io_error(path_, "write " + std::to_string(size) + " bytes");
            from += put;
            size -= static_cast<std::size_t>(put);
        }
    }

    /// Forgets everything from this byte on and continues there.
    void cut_at(std::uint64_t byte) {
        if (::ftruncate(descriptor_, static_cast<off_t>(byte)) != 0 ||
            ::lseek(descriptor_, static_cast<off_t>(byte), SEEK_SET) < 0)
            throw io_error(path_, "cut off the journal");
    }

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
};

Journal::Journal(std::filesystem::path file, std::uint64_t key)
    : path_(std::move(file)), key_(key) {}

Journal::~Journal() = default;

void Journal::restore(NodeStore& store, ConstructState& state) {
    words_written_.assign(static_cast<std::size_t>(store.top()) + 1, 0);
    auto file = std::make_unique<File>(path_, 0);
    if (!file->is_open()) return;
    file_ = std::move(file);

    std::uint64_t end = 0;  // of the last whole segment
    const std::uint64_t file_size = file_->size();
    for (;;) {
        Header header;
        if (!file_->read(&header, sizeof header)) break;
        if (header.magic != kMagic || header.header_hash != hash_of(header) || header.key != key_ ||
            header.payload_bytes > file_size - end)
            break;
        std::vector<std::byte> bytes(header.payload_bytes);
        if (!file_->read(bytes.data(), bytes.size())) break;
        if (XXH3_64bits(bytes.data(), bytes.size()) != header.payload_hash) break;

        Payload payload(bytes);
        bool whole = true;
        std::vector<std::uint32_t> words;
        for (int h = 0; h <= store.top() && whole; ++h) {
            std::uint64_t count = 0;
            whole = payload.take(&count, 1) && count <= payload.size() / sizeof(std::uint32_t);
            if (!whole) break;
            words.resize(count);
            whole = payload.take(words.data(), count) && store.level(h).extend(words);
        }
        std::vector<CellNode> roots(
            whole ? std::min<std::uint64_t>(header.new_roots, payload.size()) : 0);
        if (!whole || !payload.take(roots.data(), roots.size()))
            throw Error(Errc::bad_input, path_, "this journal contradicts itself; delete it", end);
        state.tile_roots.insert(state.tile_roots.end(), roots.begin(), roots.end());
        state.tiles_done = header.tiles_done;
        state.voxels = header.voxels;
        end += sizeof header + header.payload_bytes;
    }
    file_->cut_at(end);
    note_written(store, state);
}

void Journal::checkpoint_if_due(const NodeStore& store, const ConstructState& state) {
    if (std::chrono::steady_clock::now() - last_ >= interval) checkpoint(store, state);
}

void Journal::checkpoint(const NodeStore& store, const ConstructState& state) {
    if (!file_) file_ = std::make_unique<File>(path_, O_CREAT | O_TRUNC);

    std::vector<std::byte> payload;
    const auto put = [&](const void* data, std::size_t size) {
        const auto* bytes = static_cast<const std::byte*>(data);
        payload.insert(payload.end(), bytes, bytes + size);
    };
    for (int h = 0; h <= store.top(); ++h) {
        const auto added =
            store.level(h).words().subspan(words_written_[static_cast<std::size_t>(h)]);
        const std::uint64_t count = added.size();
        put(&count, sizeof count);
        put(added.data(), added.size_bytes());
    }
    const auto roots = std::span(state.tile_roots).subspan(roots_written_);
    put(roots.data(), roots.size_bytes());

    Header header{kMagic, key_, state.tiles_done, state.voxels, roots.size(), payload.size(), 0, 0};
    header.payload_hash = XXH3_64bits(payload.data(), payload.size());
    header.header_hash = hash_of(header);
    file_->write(&header, sizeof header);
    file_->write(payload.data(), payload.size());
    note_written(store, state);
}

void Journal::note_written(const NodeStore& store, const ConstructState& state) {
    for (int h = 0; h <= store.top(); ++h)
        words_written_[static_cast<std::size_t>(h)] = store.level(h).words().size();
    roots_written_ = state.tile_roots.size();
    last_ = std::chrono::steady_clock::now();
}

void Journal::remove() {
    if (!file_) return;
    std::error_code ignored;  // a journal that stays is overwritten by the next build
    std::filesystem::remove(path_, ignored);
    file_.reset();
}

}  // namespace octavo
