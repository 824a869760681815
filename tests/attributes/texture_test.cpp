// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>
#include <string>

#include "octavo/attributes/build_attributes.h"
#include "octavo/construct/build.h"
#include "octavo/mesh/decode_textures.h"
#include "octavo/mesh/load.h"
#include "octavo/voxelize/triangle_source.h"
#include "support/shared_scenes.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using Pixel = std::array<std::uint8_t, 4>;

Bitmap random_bitmap(int width, int height, std::uint32_t seed, bool holes) {
    std::mt19937 random(seed);
    Bitmap bitmap{width, height, {}};
    for (int i = 0; i < width * height; ++i)
        bitmap.pixels.push_back({static_cast<std::uint8_t>(random()),
                                 static_cast<std::uint8_t>(random()),
                                 static_cast<std::uint8_t>(random()),
                                 static_cast<std::uint8_t>(holes && random() % 3 ? 0 : 255)});
    return bitmap;
}

std::vector<std::byte> png_of(const Bitmap& bitmap) {
    png_image image;
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(bitmap.width);
    image.height = static_cast<png_uint_32>(bitmap.height);
    image.format = PNG_FORMAT_RGBA;
    png_alloc_size_t size = 0;
    png_image_write_to_memory(&image, nullptr, &size, 0, bitmap.pixels.data(), 0, nullptr);
    std::vector<std::byte> bytes(size);
    png_image_write_to_memory(&image, bytes.data(), &size, 0, bitmap.pixels.data(), 0, nullptr);
    return bytes;
}

/// A square of 16 x 16 units in the plane z = 3.3 with a texture over all of it `repeats` times.
Scene textured_square(const Bitmap& bitmap, double repeats, Texture::Wrap wrap) {
    Scene scene;
    scene.positions = {{0, 0, 3.3}, {16, 0, 3.3}, {16, 16, 3.3}, {0, 16, 3.3}};
    const auto r = static_cast<float>(repeats);
    scene.texture_coordinates = {{-0.25f * r, 0}, {0.75f * r, 0}, {0.75f * r, r}, {-0.25f * r, r}};
    scene.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.triangle_materials = {0, 0};
    Material material;
    material.base_color_texture = 0;
    scene.materials.push_back(material);
    Texture texture;
    texture.name = "pattern";
    texture.wrap_u = texture.wrap_v = wrap;
    texture.picture = std::make_shared<const Bitmap>(bitmap);
    scene.textures.push_back(texture);
    return scene;
}

int wrapped(int i, int size, Texture::Wrap wrap) {
    if (wrap == Texture::Wrap::clamp) return std::clamp(i, 0, size - 1);
    const int period = wrap == Texture::Wrap::mirror ? 2 * size : size;
    const int j = ((i % period) + period) % period;
    return j < size ? j : period - 1 - j;
}

BuildResult build_16(const Scene& scene, int depth) {
    BuildOptions options;
    options.grid = Grid{.voxel_size = 16.0 / (1 << depth), .depth = depth};
    return build(scene, options);
}

double linear(std::uint8_t s) {
    const double x = s / 255.0;
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}
double srgb(double x) {
    return 255.0 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055);
}

TEST(Textures, ACellHasTheMeanOfTheTexelsInIt) {
    for (const auto wrap : {Texture::Wrap::repeat, Texture::Wrap::mirror, Texture::Wrap::clamp})
        for (const int side : {64, 60}) {
            // Eight texels or so along a cell: the mean of 64 random colours, and what the filter
            // takes from beside the cell, are a few steps apart.
            const Bitmap bitmap = random_bitmap(side, side, 5, false);
            const double repeats = 2.0;
            const Scene scene = textured_square(bitmap, repeats, wrap);
            const BuildResult built = build_16(scene, 4);
            const Attributes attributes = build_attributes(scene, built.dag, built.grid, {});
            double square_error = 0.0;
            for (unsigned y = 0; y < 16; ++y)
                for (unsigned x = 0; x < 16; ++x) {
                    // Beyond the edges of a clamped picture a coarse texel goes on, not a pixel.
                    const bool beyond = x < 4 || x >= 12 || y >= 8;
                    if (wrap == Texture::Wrap::clamp && beyond) continue;
                    dvec3 mean(0.0);
                    constexpr int n = 64;
                    for (int j = 0; j < n; ++j)
                        for (int i = 0; i < n; ++i) {
                            const double u = ((x + (i + 0.5) / n) / 16.0 - 0.25) * repeats;
                            const double v = (y + (j + 0.5) / n) / 16.0 * repeats;
                            const Pixel& p = bitmap.at(
                                wrapped(static_cast<int>(std::floor(u * side)), side, wrap),
                                wrapped(static_cast<int>(std::floor(v * side)), side, wrap));
                            mean += dvec3(linear(p[0]), linear(p[1]), linear(p[2]));
                        }
                    mean /= n * n;
                    const auto color = attributes.color({x, y, 3}, 4);
                    ASSERT_TRUE(color);
                    for (int c = 0; c < 3; ++c) {
                        const double error = (*color)[static_cast<unsigned>(c)] - srgb(mean[c]);
                        EXPECT_LT(std::abs(error), 45.0) << x << " " << y;
                        square_error += error * error / (3 * 256);
                    }
                }
            EXPECT_LT(std::sqrt(square_error), 9.0);
        }
}

TEST(Textures, LargeTexelsAreSeenAsTheyAre) {
    // Sixteen cells for each texel: in its middle a cell has that texel's colour, as it is.
    Bitmap bitmap{2, 2, {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {9, 99, 199, 255}}};
    Scene scene = textured_square(bitmap, 1.0, Texture::Wrap::repeat);
    scene.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const BuildResult built = build_16(scene, 5);
    const Attributes attributes = build_attributes(scene, built.dag, built.grid, {});
    const auto near = [&](const uvec3& cell, const Rgb8& expected) {
        const auto color = attributes.color(cell, 5);
        ASSERT_TRUE(color);
        for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR((*color)[c], expected[c], 60);
    };
    near({8, 8, 6}, {255, 0, 0});
    near({24, 8, 6}, {0, 255, 0});
    near({8, 24, 6}, {0, 0, 255});
    near({24, 24, 6}, {9, 99, 199});
}

TEST(Textures, FactorsMultiplyBaseColourAndEmission) {
    const Bitmap white{1, 1, {{255, 255, 255, 255}}};
    const Bitmap half{1, 1, {{188, 188, 188, 255}}};  // half of linear light
    Scene scene = textured_square(white, 1.0, Texture::Wrap::repeat);
    scene.textures.push_back(scene.textures[0]);
    scene.textures[1].picture = std::make_shared<const Bitmap>(half);
    scene.materials[0].base_color = {0.5f, 1.0f, 0.0f, 1.0f};
    scene.materials[0].emission = {4.0f, 2.0f, 0.0f};
    scene.materials[0].emission_texture = 1;
    const BuildResult built = build_16(scene, 4);
    const Attributes attributes = build_attributes(scene, built.dag, built.grid, {});
    EXPECT_EQ(attributes.color({5, 5, 3}, 4), (Rgb8{188, 255, 0}));
    const vec3 emission = attributes.emission({5, 5, 3}, 4).value();
    EXPECT_NEAR(emission.r, 2.0f, 0.02f);
    EXPECT_NEAR(emission.g, 1.0f, 0.02f);
    EXPECT_EQ(emission.b, 0.0f);
}

TEST(Textures, EmissionLiesByItsOwnCoordinatesInMemoryAndOnDisk) {
    Scene scene = textured_square(random_bitmap(64, 64, 7, false), 2.0, Texture::Wrap::repeat);
    scene.textures.push_back(scene.textures[0]);
    scene.textures[1].wrap_u = Texture::Wrap::mirror;
    scene.materials[0].emission = {4.0f, 2.0f, 1.0f};
    scene.materials[0].emission_texture = 1;
    const BuildResult built = build_16(scene, 4);
    for (const vec2& base : scene.texture_coordinates)
        scene.emission_coordinates.emplace_back(0.7f * base.y + 0.1f, 1.3f - base.x);

    // Each picture alone, by the coordinates that are its own.
    Scene base = scene, shining = scene;
    base.emission_coordinates = {};
    base.materials[0].emission = vec3(0.0f);
    shining.materials[0].base_color_texture = Material::kNoTexture;
    shining.texture_coordinates = shining.emission_coordinates;
    shining.emission_coordinates = {};
    const Attributes colors = build_attributes(base, built.dag, built.grid, {});
    const Attributes emissions = build_attributes(shining, built.dag, built.grid, {});

    const test::TemporaryFolder folder;
    for (const AttributeOptions& options :
         {AttributeOptions{},
          AttributeOptions{.max_memory_bytes = std::uint64_t{4} << 30, .scratch = folder.path()}}) {
        const Attributes both = build_attributes(scene, built.dag, built.grid, options);
        for (const auto& [channel, alone] : {std::pair{Attributes::Channel::color, &colors},
                                             std::pair{Attributes::Channel::emission, &emissions}})
            EXPECT_TRUE(
                std::ranges::equal(both.channel(channel).words(), alone->channel(channel).words()));
    }
}

/// The rule for cut-outs of docs/voxel-rules.md, pixel by pixel, for the textured square.
bool keeps(const Bitmap& bitmap, double repeats, Texture::Wrap wrap, double x, double y,
           double width) {
    const auto side = static_cast<double>(bitmap.width);
    const double u0 = std::max((x / 16.0 - 0.25) * repeats, -0.25 * repeats) * side;
    const double u1 = std::min(((x + width) / 16.0 - 0.25) * repeats, 0.75 * repeats) * side;
    const double v0 = y / 16.0 * repeats * side, v1 = (y + width) / 16.0 * repeats * side;
    for (int v = static_cast<int>(std::floor(v0)); v <= std::floor(v1); ++v)
        for (int u = static_cast<int>(std::floor(u0)); u <= std::floor(u1); ++u)
            if (bitmap.at(wrapped(u, bitmap.width, wrap), wrapped(v, bitmap.height, wrap))[3] ==
                255)
                return true;
    return false;
}

TEST(CutOuts, AVoxelIsLeftOutWhereItsPixelsAreHoles) {
    for (const auto wrap : {Texture::Wrap::repeat, Texture::Wrap::mirror, Texture::Wrap::clamp})
        for (const double repeats : {1.0, 4.0}) {
            // Sizes that put no pixel's edge on a voxel's, where rounding would decide.
            const Bitmap bitmap = random_bitmap(19, 19, 8, true);
            Scene scene = textured_square(bitmap, repeats, wrap);
            scene.materials[0].alpha_cutoff = 0.5f;
            const BuildResult built = build_16(scene, 6);
            int set = 0;
            for (unsigned y = 1; y < 63; ++y)
                for (unsigned x = 1; x < 63; ++x) {
                    const bool found = built.dag.voxel({x, y, 13});
                    // Both triangles meet the voxels of the diagonal.
                    EXPECT_EQ(found, keeps(bitmap, repeats, wrap, x / 4.0, y / 4.0, 0.25))
                        << x << " " << y;
                    set += found;
                }
            EXPECT_GT(set, 100);
            EXPECT_LT(set, 62 * 62);
        }
}

TEST(CutOuts, DoNotDependOnTilesOrThreads) {
    Scene scene = textured_square(random_bitmap(33, 33, 3, true), 3.0, Texture::Wrap::repeat);
    scene.positions[2].z = 14.0;  // slanted
    scene.positions[1].z = 9.0;
    scene.materials[0].alpha_cutoff = 0.5f;
    BuildOptions options;
    options.depth = 7;
    const BuildResult whole = build(scene, options);
    for (const std::uint32_t tile : {4u, 16u, 64u}) {
        options.tile = tile;
        options.threads = tile == 16 ? 1 : 3;
        EXPECT_TRUE(std::ranges::equal(build(scene, options).dag.words(), whole.dag.words()));
    }
}

TEST(CutOuts, AreTheSameFromDiskOnceTheSceneIsGone) {
    const test::TemporaryFolder folder;
    const Scene whole = [] {
        Scene scene = textured_square(random_bitmap(33, 33, 3, true), 3.0, Texture::Wrap::repeat);
        scene.positions[2].z = 14.0;  // slanted
        scene.materials[0].alpha_cutoff = 0.5f;
        return scene;
    }();
    BuildOptions options;
    options.depth = 7;
    options.tile = 16;
    const BuildResult expected = build(whole, options);
    options.scratch = folder.path() / "s";
    options.spill.triangle_bytes = 1;
    Scene scene = whole;
    const BuildResult spilled = build_and_release(scene, options);
    EXPECT_TRUE(scene.triangles.empty());
    EXPECT_TRUE(scene.textures.empty());
    EXPECT_TRUE(std::ranges::equal(spilled.dag.words(), expected.dag.words()));
    BuildOptions solid = options;
    solid.scratch.clear();
    solid.spill = {};
    Scene without = whole;
    without.materials[0].alpha_cutoff.reset();
    EXPECT_LT(expected.statistics.voxels, build(without, solid).statistics.voxels);
}

TEST(CutOuts, WithoutHolesEverythingStays) {
    Scene scene = textured_square(random_bitmap(16, 16, 3, false), 1.0, Texture::Wrap::repeat);
    const BuildResult opaque = build_16(scene, 6);
    scene.materials[0].alpha_cutoff = 0.5f;
    EXPECT_TRUE(std::ranges::equal(build_16(scene, 6).dag.words(), opaque.dag.words()));
    scene.textures[0].picture.reset();  // as where it could not be read
    EXPECT_TRUE(std::ranges::equal(build_16(scene, 6).dag.words(), opaque.dag.words()));
}

TEST(CutOuts, EveryVoxelThatIsLeftHasAColour) {
    Bitmap bitmap = random_bitmap(64, 64, 4, true);
    for (Pixel& p : bitmap.pixels)
        p = p[3] == 0 ? Pixel{255, 0, 255, 0} : Pixel{0, 200, 0, 255};  // holes are magenta
    Scene scene = textured_square(bitmap, 1.0, Texture::Wrap::repeat);
    scene.materials[0].alpha_cutoff = 0.5f;
    for (const int depth : {3, 5, 7}) {
        const BuildResult built = build_16(scene, depth);
        const Attributes attributes = build_attributes(scene, built.dag, built.grid, {});
        ASSERT_GT(attributes.cells().count(), 0u);
        for (std::uint64_t i = 0; i < attributes.cells().count(); ++i) {
            const Rgb8 color = attributes.color(i, vec3(0.0f));
            ASSERT_EQ(color[0], 0);
            ASSERT_NEAR(color[1], 200, 1);
            ASSERT_EQ(color[2], 0);
        }
    }
}

TEST(DecodeTextures, ReadsPngAndTgaAlike) {
    const Bitmap bitmap = random_bitmap(7, 5, 1, true);
    const Bitmap png = decode_bitmap(png_of(bitmap));
    EXPECT_EQ(png.pixels, bitmap.pixels);

    for (const bool runs : {false, true}) {
        std::vector<std::byte> tga(18);
        tga[2] = std::byte{static_cast<unsigned char>(runs ? 10 : 2)};
        tga[12] = std::byte{7};
        tga[14] = std::byte{5};
        tga[16] = std::byte{32};
        tga[17] = std::byte{0x20};  // from the top
        for (const Pixel& p : bitmap.pixels) {
            if (runs) tga.push_back(std::byte{0x80});  // a run of one
            for (const unsigned c : {2u, 1u, 0u, 3u}) tga.push_back(std::byte{p[c]});
        }
        EXPECT_EQ(decode_bitmap(tga).pixels, bitmap.pixels);
        tga.pop_back();
        EXPECT_THROW((void)decode_bitmap(tga), Error);
    }
}

TEST(DecodeTextures, ABadPictureIsAWarningWithItsName) {
    Scene scene = textured_square(random_bitmap(4, 4, 1, false), 1.0, Texture::Wrap::repeat);
    scene.textures[0].picture.reset();
    const std::vector<std::byte> good = png_of(random_bitmap(4, 4, 1, false));
    for (std::size_t size : {std::size_t{0}, std::size_t{3}, std::size_t{20}, good.size() / 2}) {
        scene.warnings.clear();
        scene.textures[0].encoded.assign(good.begin(), good.begin() + static_cast<long>(size));
        decode_textures(scene, WantedTextures::all);
        EXPECT_FALSE(scene.textures[0].picture);
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_NE(scene.warnings[0].find("'pattern'"), std::string::npos);
    }
    scene.textures[0].encoded = good;
    decode_textures(scene, WantedTextures::all);
    EXPECT_TRUE(scene.textures[0].picture);
}

TEST(DecodeTextures, DamagedPicturesNeverCrash) {
    const std::vector<std::byte> good = png_of(random_bitmap(9, 9, 2, true));
    std::mt19937 random(7);
    for (int i = 0; i < 3000; ++i) {
        std::vector<std::byte> bytes = good;
        for (int k = 0; k < 3; ++k)
            bytes[random() % bytes.size()] = static_cast<std::byte>(random());
        try {
            (void)decode_bitmap(bytes);
        } catch (const Error&) {  // what is damaged is refused, or harmless
        }
    }
}

TEST(DecodeTextures, SponzaHasAllItsPictures) {
    OCTAVO_REQUIRE_SCENE("sponza/Sponza.gltf");
    Scene scene = load_scene(test::shared_scenes() / "sponza/Sponza.gltf");
    decode_textures(scene, WantedTextures::all);
    EXPECT_TRUE(scene.warnings.empty());
    for (const Material& m : scene.materials)
        if (m.base_color_texture != Material::kNoTexture) {
            EXPECT_TRUE(scene.textures[static_cast<std::size_t>(m.base_color_texture)].picture);
        }
}

}  // namespace
}  // namespace octavo
