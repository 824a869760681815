// SPDX-License-Identifier: MIT
//
// Radiance pictures after Ward, "Real Pixels", Graphics Gems II, 1991.
#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "octavo/core/file_bytes.h"
#include "octavo/core/file_name.h"
#include "octavo/light/sky.h"

namespace octavo {
namespace {

constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 26;
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 31;  // those, as 32-bit RGBA, and more

void check_size(const std::filesystem::path& file, std::int64_t width, std::int64_t height) {
    if (width < 1 || height < 1 || width > 65536 || height > 65536 ||
        static_cast<std::uint64_t>(width * height) > kMostPixels)
        throw Error(Errc::bad_input, file, "the picture has no pixel, or more than 2^26");
}

/// The OpenEXR library's way to a file that is in memory: it would open any name that it is given.
class ExrStream : public Imf::IStream {
public:
    explicit ExrStream(const FileBytes& file) : IStream(file.file().c_str()), bytes_(file.view()) {}

    bool read(char* to, int size) override {
        const auto count = static_cast<std::uint64_t>(std::max(size, 0));
        if (at_ > bytes_.size() || count > bytes_.size() - at_)
            throw Iex::InputExc("the picture ends early");
        std::memcpy(to, bytes_.data() + at_, count);
        at_ += count;
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t position) override { at_ = position; }

private:
    std::string_view bytes_;
    std::uint64_t at_ = 0;
};

SkyImage load_exr(const FileBytes& bytes) {
    const std::filesystem::path& file = bytes.file();
    try {
        ExrStream stream(bytes);
        Imf::InputFile in(stream);
        const auto box = in.header().dataWindow();
        const std::int64_t width = std::int64_t{box.max.x} - box.min.x + 1;
        const std::int64_t height = std::int64_t{box.max.y} - box.min.y + 1;
        check_size(file, width, height);
        SkyImage image{static_cast<int>(width), static_cast<int>(height), {}};
        // Row by row, so that a short file that claims to be large takes no memory.
        std::vector<vec3> row(static_cast<std::size_t>(width));
        for (int y = box.min.y; y <= box.max.y; ++y) {
            Imf::FrameBuffer buffer;
            const char* const names[] = {"R", "G", "B"};
            for (int i = 0; i < 3; ++i) {
                char* base = reinterpret_cast<char*>(row.data()) +
                             i * std::ptrdiff_t{sizeof(float)} -
                             static_cast<std::ptrdiff_t>(sizeof(vec3)) * box.min.x;
                buffer.insert(names[i], Imf::Slice(Imf::FLOAT, base, sizeof(vec3), 0));
            }
            in.setFrameBuffer(buffer);
            in.readPixels(y);
            image.color.insert(image.color.end(), row.begin(), row.end());
        }
        return image;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw Error(Errc::bad_input, file, std::string("cannot read: ") + error.what());
    }
}

/// The bytes of a file, read one after the other.
class Bytes {
public:
    explicit Bytes(const FileBytes& file) : file_(file), bytes_(file.view()) {}
    std::uint8_t next() {
        if (at_ >= bytes_.size()) fail("the picture ends early");
        return static_cast<std::uint8_t>(bytes_[at_++]);
    }
    std::string line() {
        std::string text;
        for (char c = static_cast<char>(next()); c != '\n'; c = static_cast<char>(next())) {
            text += c;
            if (text.size() > 4096) fail("a line of the header has no end");
        }
        return text;
    }
    [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
    [[noreturn]] void fail(const std::string& reason) const {
        throw file_.error_at(bytes_.data() + at_, reason);
    }

private:
    const FileBytes& file_;
    std::string_view bytes_;
    std::size_t at_ = 0;
};

using Rgbe = std::array<std::uint8_t, 4>;

/// One row: four runs of bytes, one for each channel; or pixels as they are, with the old runs.
void read_row(Bytes& in, std::vector<Rgbe>& row) {
    Rgbe first{in.next(), in.next(), in.next(), in.next()};
    const bool runs = row.size() >= 8 && row.size() < 32768 && first[0] == 2 && first[1] == 2 &&
                      (first[2] & 0x80) == 0;
    if (!runs) {
        unsigned shift = 0;
        for (std::size_t x = 0; x < row.size();) {
            if (first[0] == 1 && first[1] == 1 && first[2] == 1) {
                const std::size_t count = std::size_t{first[3]} << shift;
                if (x == 0 || shift > 16 || count > row.size() - x) in.fail("a run is too long");
                for (std::size_t i = 0; i < count; ++i, ++x) row[x] = row[x - 1];
                shift += 8;
            } else {
                row[x++] = first;
                shift = 0;
            }
            if (x < row.size()) first = {in.next(), in.next(), in.next(), in.next()};
        }
        return;
    }
    if ((std::size_t{first[2]} << 8 | first[3]) != row.size()) in.fail("a row has another width");
    for (std::size_t channel = 0; channel < 4; ++channel)
        for (std::size_t x = 0; x < row.size();) {
            std::size_t count = in.next();
            const bool same = count > 128;
            if (same) count -= 128;
            if (count == 0 || count > row.size() - x) in.fail("a run is too long");
            const std::uint8_t value = same ? in.next() : std::uint8_t{0};
            for (std::size_t i = 0; i < count; ++i, ++x) row[x][channel] = same ? value : in.next();
        }
}

SkyImage load_hdr(const FileBytes& bytes) {
    const std::filesystem::path& file = bytes.file();
    Bytes in(bytes);
    const std::string magic = in.line();
    if (!magic.starts_with("#?")) in.fail("this is not a Radiance picture");
    bool rgbe = false;
    for (std::string line = in.line(); !line.empty(); line = in.line())
        rgbe = rgbe || line == "FORMAT=32-bit_rle_rgbe";
    if (!rgbe) throw Error(Errc::unsupported, file, "its format is not 32-bit_rle_rgbe");
    int height = 0, width = 0;
    if (std::sscanf(in.line().c_str(), "-Y %d +X %d", &height, &width) != 2)
        throw Error(Errc::unsupported, file, "its rows do not go from the top, left to right");
    check_size(file, width, height);
    // A row of runs takes 4 bytes for every 127 pixels and channel at least.
    if (in.left() < static_cast<std::size_t>(height) * (static_cast<std::size_t>(width) / 32))
        in.fail("the picture ends early");
    SkyImage image{width, height, {}};
    std::vector<Rgbe> row(static_cast<std::size_t>(width));
    for (int y = 0; y < height; ++y) {
        read_row(in, row);
        for (const Rgbe& c : row)
            image.color.push_back(vec3(c[0], c[1], c[2]) *
                                  (c[3] == 0 ? 0.0f : std::ldexp(1.0f, c[3] - 136)));
    }
    return image;
}

}  // namespace

SkyImage load_sky_image(const std::filesystem::path& file) {
    const std::string extension = lowercase_extension(file);
    if (extension != ".exr" && extension != ".hdr")
        throw Error(Errc::unsupported, file, "a sky's name ends in .exr or .hdr");
    const FileBytes bytes = read_file(file, kMostBytes);
    SkyImage image = extension == ".exr" ? load_exr(bytes) : load_hdr(bytes);
    for (const vec3& c : image.color)
        for (int i = 0; i < 3; ++i)
            if (!(c[i] >= 0.0f) || !std::isfinite(c[i]))
                throw Error(Errc::bad_input, file, "a pixel is negative or not finite");
    return image;
}

}  // namespace octavo
