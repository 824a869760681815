// SPDX-License-Identifier: MIT
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>

#include <exception>
#include <string>
#include <vector>

#include "octavo/core/error.h"
#include "octavo/render/image.h"
#include "octavo/render/write_file.h"

namespace octavo {

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

    detail::write_and_rename(file, [&](const std::filesystem::path& unfinished) {
        try {
            Imf::OutputFile out(unfinished.c_str(), header);
            out.setFrameBuffer(buffer);
            out.writePixels(image.height);
        } catch (const std::exception& error) {
            throw Error(Errc::io, file, std::string("cannot write: ") + error.what());
        }
    });
}

}  // namespace octavo
