// SPDX-License-Identifier: MIT
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "octavo/core/atomic_file.h"
#include "octavo/core/error.h"
#include "octavo/render/image.h"

namespace octavo {
namespace {

/// The encoded file in memory: OpenEXR writes its table of lines in a destructor, where an error
/// would be lost.
class MemoryStream : public Imf::OStream {
public:
    explicit MemoryStream(const std::filesystem::path& name) : Imf::OStream(name.c_str()) {}

    void write(const char* data, int size) override {
        const auto count = static_cast<std::size_t>(size);
        if (bytes_.size() < position_ + count) bytes_.resize(position_ + count);
        std::memcpy(bytes_.data() + position_, data, count);
        position_ += count;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }

    [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

private:
    std::vector<std::byte> bytes_;
    std::size_t position_ = 0;
};

}  // namespace

void write_exr(const std::filesystem::path& file, const Image& image) {
    if (image.color.empty()) throw Error(Errc::bad_argument, file, "the image has no pixel");

    std::vector<half> rgb;
    rgb.reserve(3 * image.color.size());
    for (const vec3& color : image.color)
        for (int i = 0; i < 3; ++i) rgb.emplace_back(color[i]);

    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer buffer;
    const auto width = static_cast<std::size_t>(image.width);
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t i = 0; i < 3; ++i) {
        header.channels().insert(names[i], Imf::Channel(Imf::HALF));
        buffer.insert(names[i], Imf::Slice(Imf::HALF, reinterpret_cast<char*>(rgb.data() + i),
                                           3 * sizeof(half), 3 * sizeof(half) * width));
    }
    // OpenEXR takes a pointer to what it only reads.
    char* depth = reinterpret_cast<char*>(const_cast<float*>(image.depth.data()));
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    buffer.insert("Z", Imf::Slice(Imf::FLOAT, depth, sizeof(float), sizeof(float) * width));

    MemoryStream encoded(file);
    try {
        Imf::OutputFile out(encoded, header);
        out.setFrameBuffer(buffer);
        out.writePixels(image.height);
    } catch (const std::exception& error) {
        throw Error(Errc::io, file, std::string("cannot write: ") + error.what());
    }
    AtomicFile out(file);
    out.write(0, encoded.bytes());
    out.commit();
}

}  // namespace octavo
