// SPDX-License-Identifier: MIT
#include "octavo/mesh/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <string>

namespace octavo {
namespace {

struct Inflater {
    z_stream stream{};
    Inflater() {
        constexpr int kGzipOnly = 16 + MAX_WBITS;
        if (inflateInit2(&stream, kGzipOnly) != Z_OK) throw std::bad_alloc();
    }
    ~Inflater() { inflateEnd(&stream); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;
};

}  // namespace

bool is_gzip(std::string_view bytes) {
    return bytes.starts_with("\x1f\x8b");
}

FileBytes inflate_file(const FileBytes& compressed, std::uint64_t max_bytes) {
    const std::string_view input = compressed.view();
    Inflater inflater;
    z_stream& stream = inflater.stream;

    // zlib counts in 32 bits, so it gets its input and room for its output in pieces.
    constexpr std::size_t kPiece = std::numeric_limits<uInt>::max();
    std::size_t capacity = std::max<std::size_t>(4096, 4 * input.size());
    auto data = std::make_unique_for_overwrite<char[]>(capacity);
    std::size_t size = 0, used = 0;
    for (;;) {
        if (size > max_bytes)
            throw Error(Errc::limit, compressed.file(),
                        "inflates to more than " + std::to_string(max_bytes) + " bytes");
        if (size == capacity) {
            auto larger = std::make_unique_for_overwrite<char[]>(2 * capacity);
            std::memcpy(larger.get(), data.get(), size);
            data = std::move(larger);
            capacity *= 2;
        }
        const auto in = static_cast<uInt>(std::min(kPiece, input.size() - used));
        const auto out = static_cast<uInt>(std::min(kPiece, capacity - size));
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(input.data() + used));
        stream.avail_in = in;
        stream.next_out = reinterpret_cast<Bytef*>(data.get() + size);
        stream.avail_out = out;
        const int result = inflate(&stream, Z_NO_FLUSH);
        used += in - stream.avail_in;
        size += out - stream.avail_out;

        if (result == Z_STREAM_END) {
            // gzip files may be several members one after another; anything else after the end is
            // padding, as gzip itself treats it.
            if (!is_gzip(input.substr(used))) break;
            inflateReset(&stream);
        } else if (result == Z_BUF_ERROR && used == input.size()) {
            throw compressed.error_at(input.data() + used, "the gzip data is cut short");
        } else if (result != Z_OK && result != Z_BUF_ERROR) {
            throw compressed.error_at(input.data() + used, "the gzip data is damaged");
        }
    }
    return {compressed.file(), std::move(data), size};
}

}  // namespace octavo
