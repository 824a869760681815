// SPDX-License-Identifier: MIT
// Truevision TGA File Format Specification 2.0, 1991.
#include "octavo/mesh/tga.h"

#include "octavo/core/error.h"

namespace octavo {
namespace {

constexpr std::size_t kHeaderBytes = 18;
constexpr unsigned kRgb = 2, kGrey = 3, kRuns = 8;  // kinds of image; kRuns is added
constexpr unsigned kFromRight = 0x10, kFromTop = 0x20;

struct Header {
    unsigned id_bytes, map_kind, kind, map_bytes, width, height, bits, descriptor;
};

Header header_of(std::span<const std::byte> b) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned>(b[i]); };
    const auto pair = [&](std::size_t i) { return byte(i) | byte(i + 1) << 8; };
    return {byte(0),  byte(1),  byte(2),  pair(5) * ((byte(7) + 7) / 8),
            pair(12), pair(14), byte(16), byte(17)};
}

/// Pixels from bytes, one after the other.
class PixelReader {
public:
    PixelReader(std::span<const std::byte> bytes, const Header& header)
        : bytes_(bytes), size_(header.bits / 8), runs_(header.kind & kRuns) {}

    std::array<std::uint8_t, 4> next() {
        if (!runs_) return pixel();
        if (left_ == 0) {
            const auto packet = take();
            left_ = 1 + (packet & 127u);
            repeat_ = packet & 128u;
            if (repeat_) last_ = pixel();
        }
        --left_;
        if (!repeat_) last_ = pixel();
        return last_;
    }

private:
    std::uint8_t take() {
        if (at_ >= bytes_.size()) throw Error(Errc::bad_input, "is a TGA that is cut off");
        return static_cast<std::uint8_t>(bytes_[at_++]);
    }
    std::array<std::uint8_t, 4> pixel() {
        const std::uint8_t b = take();
        if (size_ == 1) return {b, b, b, 255};
        const std::uint8_t g = take(), r = take();
        return {r, g, b, size_ == 4 ? take() : std::uint8_t{255}};
    }

    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
    unsigned size_;
    bool runs_;
    unsigned left_ = 0;
    bool repeat_ = false;
    std::array<std::uint8_t, 4> last_{};
};

}  // namespace

bool looks_like_tga(std::span<const std::byte> encoded) {
    if (encoded.size() < kHeaderBytes) return false;
    const Header h = header_of(encoded);
    const unsigned kind = h.kind & ~kRuns;
    return h.map_kind <= 1 && (kind == 1 || kind == kRgb || kind == kGrey) && h.width > 0 &&
           h.height > 0 && (h.bits == 8 || h.bits == 16 || h.bits == 24 || h.bits == 32) &&
           (h.descriptor & 0xc0u) == 0;
}

Bitmap decode_tga(std::span<const std::byte> encoded) {
    const Header h = header_of(encoded);
    const unsigned kind = h.kind & ~kRuns;
    const bool known =
        (kind == kGrey && h.bits == 8) || (kind == kRgb && (h.bits == 24 || h.bits == 32));
    if (!known) throw Error(Errc::unsupported, "is a TGA with a palette or 16-bit colours");
    const std::size_t start = kHeaderBytes + h.id_bytes + (h.map_kind == 1 ? h.map_bytes : 0);
    if (start > encoded.size()) throw Error(Errc::bad_input, "is a TGA that is cut off");

    // A run of 128 pixels takes two bytes at least: what is claimed beyond cannot be there.
    const std::uint64_t pixels = std::uint64_t{h.width} * h.height;
    if (pixels > 128 * static_cast<std::uint64_t>(encoded.size()))
        throw Error(Errc::bad_input, "is a TGA that is cut off");
    Bitmap picture = make_bitmap(h.width, h.height);
    PixelReader reader(encoded.subspan(start), h);
    for (int row = 0; row < picture.height; ++row)
        for (int column = 0; column < picture.width; ++column) {
            const int x = h.descriptor & kFromRight ? picture.width - 1 - column : column;
            const int y = h.descriptor & kFromTop ? row : picture.height - 1 - row;
            picture.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                           static_cast<std::size_t>(x)] = reader.next();
        }
    return picture;
}

}  // namespace octavo
