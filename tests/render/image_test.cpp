// SPDX-License-Identifier: MIT
#include "octavo/render/image.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "octavo/core/error.h"
#include "octavo/render/tone_map.h"

namespace octavo {
namespace {

class ImageFile : public testing::Test {
protected:
    ImageFile()
        : folder_(std::filesystem::temp_directory_path() /
                  ("octavo_image_test_" + std::to_string(getpid()))) {
        std::filesystem::create_directories(folder_);
        for (int y = 0; y < image_.height; ++y)
            for (int x = 0; x < image_.width; ++x) {
                image_.color[image_.index(x, y)] =
                    vec3(0.01f * static_cast<float>(x), 0.05f * static_cast<float>(y), 0.4f);
                image_.depth[image_.index(x, y)] = static_cast<float>(x + 100 * y);
            }
    }
    ~ImageFile() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_;
    Image image_{37, 11};
};

TEST_F(ImageFile, FormatIsKnownByTheExtensionInAnyCase) {
    for (const char* name : {"a.PNG", "a.Exr"}) {
        write_image(folder_ / name, image_, 0.0);
        EXPECT_TRUE(std::filesystem::exists(folder_ / name));
    }
    EXPECT_THROW(write_image(folder_ / "a.jpg", image_, 0.0), Error);
}

TEST_F(ImageFile, PngHoldsTheToneMappedPixels) {
    const auto file = folder_ / "a.png";
    write_image(file, image_, 0.5);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_file(&png, file.c_str()), 0);
    ASSERT_EQ(png.width, 37u);
    ASSERT_EQ(png.height, 11u);
    png.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(png));
    ASSERT_NE(png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr), 0);
    for (std::size_t i = 0; i < image_.color.size(); ++i) {
        const auto expected = tone_map(image_.color[i], std::exp2(0.5f));
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(bytes[3 * i + c], expected[c]) << i;
    }
}

TEST_F(ImageFile, ExrHoldsTheLinearPixelsAndTheDepth) {
    const auto file = folder_ / "a.exr";
    image_.depth[5] = std::numeric_limits<float>::infinity();
    write_image(file, image_);
    Imf::InputFile in(file.c_str());
    ASSERT_EQ(in.header().dataWindow().max.x, 36);
    ASSERT_EQ(in.header().dataWindow().max.y, 10);
    std::vector<float> green(image_.color.size());
    std::vector<float> depth(image_.color.size());
    Imf::FrameBuffer buffer;
    buffer.insert("G", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(green.data()), 4, 4 * 37));
    buffer.insert("Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(depth.data()), 4, 4 * 37));
    in.setFrameBuffer(buffer);
    in.readPixels(0, 10);
    EXPECT_EQ(depth, image_.depth);
    for (std::size_t i = 0; i < green.size(); ++i)
        ASSERT_NEAR(green[i], image_.color[i].y, 0.001f * image_.color[i].y);
}

TEST_F(ImageFile, FailedWriteLeavesTheOldFileAndNothingElse) {
    const auto missing = folder_ / "no_such_folder" / "a";
    for (const char* extension : {".png", ".exr"}) {
        auto file = missing;
        file += extension;
        try {
            write_image(file, image_);
            FAIL();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Errc::io);
            EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos);
        }
    }
    const auto folder_as_file = folder_ / "taken.png";
    std::filesystem::create_directories(folder_as_file / "full");
    EXPECT_THROW(write_image(folder_as_file, image_), Error);
    EXPECT_TRUE(std::filesystem::exists(folder_as_file / "full"));
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
        EXPECT_EQ(entry.path(), folder_as_file);
}

TEST_F(ImageFile, RefusesOtherNamesAndEmptyImages) {
    EXPECT_THROW(write_image(folder_ / "a.gif", image_), Error);
    EXPECT_THROW(write_image(folder_ / "a.png", Image()), Error);
    EXPECT_THROW(write_image(folder_ / "a.exr", Image()), Error);
}

TEST(ToneMap, RisesFromBlackToWhiteWithoutAStep) {
    const auto grey = [](float x) { return int{tone_map(vec3(x), 1.0f)[0]}; };
    EXPECT_EQ(grey(0.0f), 0);
    EXPECT_EQ(grey(-1.0f), 0);
    EXPECT_EQ(grey(std::numeric_limits<float>::quiet_NaN()), 0);
    EXPECT_EQ(grey(std::numeric_limits<float>::infinity()), 255);
    EXPECT_NEAR(grey(0.2140f), 127.5, 1.0);  // sRGB's middle
    for (float x = 0.0f; x < 4.0f; x += 0.001f) {
        EXPECT_LE(grey(x), grey(x + 0.001f));
        EXPECT_LE(grey(x + 0.001f) - grey(x), 4);
    }
}

}  // namespace
}  // namespace octavo
