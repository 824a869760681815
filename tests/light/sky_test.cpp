// SPDX-License-Identifier: MIT
#include "octavo/light/sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>

#include "octavo/core/error.h"
#include "octavo/render/image.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

constexpr double kPi = std::numbers::pi;

/// Bright in one place, dim all around.
SkyImage with_a_sun(int width, int height) {
    SkyImage image{width, height, {}};
    image.color.resize(static_cast<std::size_t>(width * height), vec3(0.1f));
    image.color[static_cast<std::size_t>(height / 4 * width + width / 3)] =
        vec3(900.0f, 800.0f, 1.0f);
    return image;
}

/// The integral of a sky's green over all directions, in plain steps.
double integral(const Sky& sky, int rows) {
    double sum = 0.0;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < 2 * rows; ++x) {
            const double z = 1.0 - 2.0 * (y + 0.5) / rows;
            const double angle = kPi * (x + 0.5) / rows, radius = std::sqrt(1.0 - z * z);
            const vec3 d(radius * std::cos(angle), z, radius * std::sin(angle));
            sum += static_cast<double>(sky.radiance(d).g);
        }
    return sum * 4.0 * kPi / (2.0 * rows * rows);
}

TEST(Sky, SamplesOfAnImageAddUpToItsIntegral) {
    const Sky sky = Sky::image(with_a_sun(32, 16), {0, 1, 0}, 0.3);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    double sum = 0.0;
    constexpr int kSamples = 20000;
    for (int i = 0; i < kSamples; ++i) {
        const SkySample s = sky.sample({unit(random), unit(random)});
        ASSERT_GT(s.density, 0.0f);
        ASSERT_NEAR(glm::length(s.direction), 1.0f, 1e-4f);
        sum += static_cast<double>(sky.radiance(s.direction).g / s.density);
    }
    EXPECT_NEAR(sum / kSamples, integral(sky, 1024), 0.01 * integral(sky, 1024));
}

TEST(Sky, DensitiesAddUpToOne) {
    const Sky sky = Sky::image(with_a_sun(32, 16), {0.2, 1, 0.1}, 1.0);
    double sum = 0.0;
    constexpr int kRows = 512;
    for (int y = 0; y < kRows; ++y)
        for (int x = 0; x < 2 * kRows; ++x) {
            const double z = 1.0 - 2.0 * (y + 0.5) / kRows;
            const double angle = kPi * (x + 0.5) / kRows, radius = std::sqrt(1.0 - z * z);
            sum += static_cast<double>(
                sky.density(vec3(radius * std::cos(angle), z, radius * std::sin(angle))));
        }
    EXPECT_NEAR(sum * 4.0 * kPi / (2.0 * kRows * kRows), 1.0, 0.01);
}

TEST(Sky, DiffuseLightOfAConstantSkyIsItsRadiance) {
    const Sky sky = Sky::constant(vec3(0.5f, 1.0f, 2.0f));
    for (const vec3& n : {vec3(1, 0, 0), vec3(0, -1, 0), glm::normalize(vec3(1, 2, 3))})
        EXPECT_LT(glm::length(sky.diffuse(n) - vec3(0.5f, 1.0f, 2.0f)), 0.01f);
}

TEST(Sky, DiffuseLightOfAGradientIsWithinThreePercentOfItsIntegral) {
    const Sky sky = Sky::clear({0, 1, 0});
    for (const vec3& n : {vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, -1, 0)}) {
        dvec3 sum(0.0);
        constexpr int kRows = 200;
        for (int y = 0; y < kRows; ++y)
            for (int x = 0; x < 2 * kRows; ++x) {
                const double z = 1.0 - 2.0 * (y + 0.5) / kRows;
                const double angle = kPi * (x + 0.5) / kRows, radius = std::sqrt(1.0 - z * z);
                const vec3 d(radius * std::cos(angle), z, radius * std::sin(angle));
                sum += dvec3(std::max(0.0f, glm::dot(d, n)) * sky.radiance(d));
            }
        sum *= 4.0 / (2.0 * kRows * kRows);
        EXPECT_LT(glm::length(dvec3(sky.diffuse(n)) - sum), 0.03 * glm::length(sum));
    }
}

TEST(SkyImage, AnExrThatWeWroteComesBack) {
    const test::TemporaryFolder folder;
    Image image(8, 4);
    for (std::size_t i = 0; i < image.color.size(); ++i)
        image.color[i] = vec3(static_cast<float>(i), 0.5f, 1000.0f);
    write_exr(folder.path() / "sky.exr", image);
    const SkyImage sky = load_sky_image(folder.path() / "sky.exr");
    EXPECT_EQ(sky.width, 8);
    EXPECT_EQ(sky.height, 4);
    EXPECT_EQ(sky.color, image.color);
}

std::string radiance_header(const std::string& size) {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n";
}
void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

TEST(SkyImage, ReadsRadiancePixelsAndRuns) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "sky.hdr";
    // Two pixels as they are: 128 * 2^(129 - 136) = 1, 0.5, 0 and black.
    write_bytes(file, radiance_header("-Y 1 +X 2") + std::string("\x80\x40\x00\x81\0\0\0\0", 8));
    SkyImage sky = load_sky_image(file);
    ASSERT_EQ(sky.color.size(), 2u);
    EXPECT_EQ(sky.color[0], vec3(1.0f, 0.5f, 0.0f));
    EXPECT_EQ(sky.color[1], vec3(0.0f));
    // Eight pixels as runs: each channel eight times the same, the last one byte by byte.
    write_bytes(file, radiance_header("-Y 1 +X 8") + std::string("\x02\x02\x00\x08", 4) +
                          std::string("\x88\x80\x88\x40\x88\x00", 6) +
                          std::string("\x08\x81\x81\x81\x81\x81\x81\x81\x82", 9));
    sky = load_sky_image(file);
    ASSERT_EQ(sky.color.size(), 8u);
    EXPECT_EQ(sky.color[0], vec3(1.0f, 0.5f, 0.0f));
    EXPECT_EQ(sky.color[7], vec3(2.0f, 1.0f, 0.0f));
}

TEST(SkyImage, AnExrThatIsCutShortIsRefused) {
    const test::TemporaryFolder folder;
    write_exr(folder / "sky.exr", Image(8, 4));
    const std::string whole = test::file_content(folder / "sky.exr");
    for (std::size_t cut = 0; cut < whole.size(); ++cut) {
        write_bytes(folder / "cut.exr", whole.substr(0, cut));
        EXPECT_THROW((void)load_sky_image(folder / "cut.exr"), Error) << cut;
    }
}

TEST(SkyImage, RefusesWhatIsDamaged) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "sky.hdr";
    const std::string good = radiance_header("-Y 1 +X 8") + std::string("\x02\x02\x00\x08", 4) +
                             std::string("\x88\x80\x88\x40\x88\x00\x88\x81", 8);
    write_bytes(file, good);
    EXPECT_NO_THROW((void)load_sky_image(file));
    for (std::size_t cut = 0; cut < good.size(); ++cut) {
        write_bytes(file, good.substr(0, cut));
        EXPECT_THROW((void)load_sky_image(file), Error) << cut;
    }
    for (const char* size : {"-Y 1 +X 0", "-Y 70000 +X 2", "-Y 60000 +X 60000", "+Y 1 +X 2", ""}) {
        write_bytes(file, radiance_header(size) + std::string(64, 'x'));
        EXPECT_THROW((void)load_sky_image(file), Error) << size;
    }
    write_bytes(file, good.substr(0, good.size() - 2) + "\xff\x81");  // a run past the row
    EXPECT_THROW((void)load_sky_image(file), Error);
    EXPECT_THROW((void)load_sky_image(folder.path() / "none.exr"), Error);
    write_bytes(folder.path() / "bad.exr", "this is no picture");
    EXPECT_THROW((void)load_sky_image(folder.path() / "bad.exr"), Error);
    write_bytes(folder.path() / "sky.png", "x");
    EXPECT_THROW((void)load_sky_image(folder.path() / "sky.png"), Error);
}

}  // namespace
}  // namespace octavo
