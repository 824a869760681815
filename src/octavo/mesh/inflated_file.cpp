// SPDX-License-Identifier: MIT
#include "octavo/mesh/inflated_file.h"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <new>
#include <string>

#include "octavo/core/error.h"

namespace octavo {
namespace {

using Magic = std::array<char, 2>;
constexpr Magic kGzipMagic = {'\x1f', '\x8b'};

bool begins_as_gzip(const InputFile& file) {
    Magic start{};
    return pread(file.descriptor(), start.data(), start.size(), 0) == ssize_t{start.size()} &&
           start == kGzipMagic;
}

}  // namespace

struct InflatedFile::Inflater {
    Inflater() {
        constexpr int kGzipOnly = 16 + MAX_WBITS;
        if (inflateInit2(&stream, kGzipOnly) != Z_OK) throw std::bad_alloc();
    }
    ~Inflater() { inflateEnd(&stream); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    /// Moves what is left of the input to the front, and fills up behind it.
    void refill(InputFile& file) {
        std::memmove(input.data(), stream.next_in, stream.avail_in);
        stream.next_in = reinterpret_cast<Bytef*>(input.data());
        stream.avail_in += static_cast<uInt>(
            file.read(input.data() + stream.avail_in, input.size() - stream.avail_in));
    }

    [[nodiscard]] bool member_begins() const {
        return stream.avail_in >= kGzipMagic.size() &&
               std::memcmp(stream.next_in, kGzipMagic.data(), kGzipMagic.size()) == 0;
    }

    z_stream stream{};
    std::array<char, std::size_t{64} << 10> input;
    std::uint64_t made = 0;
    bool ended = false;
};

InflatedFile::InflatedFile(const std::filesystem::path& file, std::uint64_t max_bytes)
    : file_(file), max_bytes_(max_bytes) {
    if (file_.size() > max_bytes)
        throw Error(Errc::limit, file,
                    "has " + std::to_string(file_.size()) + " bytes, and at most " +
                        std::to_string(max_bytes) + " are read");
    if (begins_as_gzip(file_)) {
        inflater_ = std::make_unique<Inflater>();
        inflater_->stream.next_in = reinterpret_cast<Bytef*>(inflater_->input.data());
    }
}

InflatedFile::~InflatedFile() = default;

std::uint64_t InflatedFile::expected_size() const {
    return inflater_ ? 4 * file_.size() : file_.size();
}

std::uint64_t InflatedFile::most_size() const {
    // Deflate's shortest code, of two bits, stands for at most 258 bytes.
    constexpr std::uint64_t kMostPerByte = 4 * 258;
    if (!inflater_) return file_.size();
    return file_.size() < max_bytes_ / kMostPerByte ? kMostPerByte * file_.size() : max_bytes_;
}

std::size_t InflatedFile::read(char* out, std::size_t size) {
    if (!inflater_) return file_.read(out, size);
    std::size_t done = 0;
    while (done < size && !inflater_->ended) {
        const std::size_t piece =
            std::min<std::size_t>(size - done, std::numeric_limits<uInt>::max());
        done += inflate_next(out + done, piece);
    }
    inflater_->made += done;
    if (inflater_->made > max_bytes_)
        throw Error(Errc::limit, path(),
                    "inflates to more than " + std::to_string(max_bytes_) + " bytes");
    return done;
}

std::size_t InflatedFile::inflate_next(char* out, std::size_t size) {
    z_stream& stream = inflater_->stream;
    if (stream.avail_in == 0) inflater_->refill(file_);
    const bool input_ends = stream.avail_in == 0;
    stream.next_out = reinterpret_cast<Bytef*>(out);
    stream.avail_out = static_cast<uInt>(size);
    const int result = inflate(&stream, Z_NO_FLUSH);
    const std::size_t made = size - stream.avail_out;

    const auto error = [&](const char* message) {
        const off_t at = lseek(file_.descriptor(), 0, SEEK_CUR);
        return Error(Errc::bad_input, path(), message,
                     static_cast<std::uint64_t>(at) - stream.avail_in);
    };
    if (result == Z_STREAM_END) {
        // gzip files may be several members one after another; anything else after the end is
        // padding, as gzip itself treats it.
        if (stream.avail_in < kGzipMagic.size()) inflater_->refill(file_);
        if (inflater_->member_begins())
            inflateReset(&stream);
        else
            inflater_->ended = true;
    } else if (result == Z_BUF_ERROR && input_ends) {
        throw error("the gzip data is cut short");
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
        throw error("the gzip data is damaged");
    }
    return made;
}

}  // namespace octavo
