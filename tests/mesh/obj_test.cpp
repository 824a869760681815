// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "mesh/mesh_files.h"
#include "octavo/construct/build.h"
#include "octavo/core/memory.h"
#include "octavo/dag/statistics.h"
#include "octavo/mesh/alpha.h"
#include "octavo/mesh/decode_textures.h"
#include "octavo/mesh/save.h"

namespace octavo {
namespace {

using test::grey_tga;
using test::load_error;
using test::mentions;
using test::TemporaryFolder;

TEST(Obj, KeepsFarCoordinatesExactToTheDouble) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write(
        "a.obj",
        "v 5734567.123456789 -4321987.000976563 1e-3\nv 5734567.123457 1 2\nv 0 .5 -.25E+1\n"
        "f 1 2 3\n"));
    EXPECT_EQ(scene.positions[0], dvec3(5734567.123456789, -4321987.000976563, 1e-3));
    EXPECT_EQ(scene.positions[2], dvec3(0, 0.5, -2.5));
}

TEST(Obj, ReadsTheFirstLineBehindAByteOrderMark) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.obj", "\xef\xbb\xbfv 5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(load_scene(file).positions.at(0), dvec3(5, 0, 0));
}

TEST(Obj, SaysThatTwoBytesACharacterAreNotRead) {
    const TemporaryFolder folder;
    for (const std::string& text : {std::string("\xff\xfev\0", 4), std::string("\xfe\xff\0v", 4)}) {
        const Error error = load_error(folder.write("a.obj", text));
        EXPECT_EQ(error.code(), Errc::unsupported);
        EXPECT_NE(std::string(error.what()).find("UTF-16"), std::string::npos) << error.what();
    }
}

TEST(Obj, CountsNegativeIndicesBackFromTheLatestVertex) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(
        folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -1 1 2\n"));
    EXPECT_EQ(scene.triangles[0], uvec3(0, 1, 2));
    EXPECT_EQ(scene.triangles[1], uvec3(3, 0, 1));
}

TEST(Obj, NamesTheByteOfABadIndex) {
    const TemporaryFolder folder;
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (const char* face : {"f 1 2 4", "f 1 2 0", "f -4 1 2", "f 1 2 99999999999999999999",
                             "f 1 2 x", "f 1 2 -9223372036854775808"}) {
        const Error error = load_error(folder.write("a.obj", vertices + face));
        EXPECT_EQ(error.code(), Errc::bad_input) << face;
        EXPECT_GE(error.offset().value_or(0), vertices.size()) << face;
    }
}

TEST(Obj, ReadsPolygonsContinuedLinesAndEveryCornerForm) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(
        folder.write("a.obj",
                     "# L-shaped\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nvn 0 0 1\n"
                     "vt 0 0\nf 1 2/1 3//1 \\\n 4/1/1 5 6 # six corners\nl 1 2\np 3\nf 1 2\n"));
    EXPECT_EQ(scene.triangles.size(), 4u);
    EXPECT_TRUE(mentions(scene, "fewer than three corners"));
}

TEST(Obj, ReadsVertexColoursAndTheNumbersOfOldPrograms) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write(
        "a.obj",
        "v 0 0 0 1 0.5 nan\nv 1.#IND -1.#INF 0\nv 0 1 0 0 0 1\nv 0 0 1 7\nf 1 2 3\nf 1 3 4\n"));
    using Color = std::array<std::uint8_t, 4>;
    EXPECT_EQ(scene.colors[0], (Color{255, 128, 0, 255}));
    EXPECT_EQ(scene.colors[1], (Color{255, 255, 255, 255}));
    EXPECT_EQ(scene.colors[2], (Color{0, 0, 255, 255}));
    EXPECT_TRUE(std::isnan(scene.positions[1].x));
    EXPECT_EQ(scene.positions[1].y, -INFINITY);
}

TEST(Obj, ReadsMaterialsWithTexturesEmissionAndHoles) {
    const TemporaryFolder folder;
    folder.write("my textures/leaf.png", "png");
    folder.write("my materials.mtl",
                 "newmtl leaf\nKd 0.1 0.2 0.3\nmap_Kd -s 1 1 1 -clamp on my textures\\leaf.png\n"
                 "map_d my textures\\leaf.png\nd 0.5\n  newmtl lamp\n Ke 3 2 1\nKd 0.5\n"
                 "newmtl gone\nmap_Kd missing.png\n");
    const Scene scene = load_scene(folder.write(
        "a.obj",
        "mtllib my materials.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 0.25\n"
        "usemtl leaf\nf 1/1 2/2 3/3\nusemtl lamp\nf 1/2 2/2 3/3\nusemtl nobody\nf 1 2 3\n"));
    ASSERT_EQ(scene.materials.size(), 4u);
    const Material& leaf = scene.materials[0];
    EXPECT_EQ(leaf.base_color, vec4(0.1f, 0.2f, 0.3f, 0.5f));
    ASSERT_EQ(leaf.base_color_texture, 0);
    EXPECT_EQ(scene.textures[0].file, folder.path() / "my textures/leaf.png");
    EXPECT_TRUE(leaf.alpha_cutoff);
    EXPECT_EQ(scene.materials[1].emission, vec3(3, 2, 1));
    EXPECT_EQ(scene.materials[1].base_color, vec4(0.5f, 0.5f, 0.5f, 1.0f));
    EXPECT_EQ(scene.materials[2].base_color_texture, Material::kNoTexture);
    EXPECT_TRUE(mentions(scene, "missing.png"));
    EXPECT_EQ(scene.materials[3].name, "nobody");
    EXPECT_EQ(scene.triangle_materials, (std::vector<std::uint32_t>{0, 1, 3}));

    // The first vertex has two texture coordinates, so it became two vertices at one place.
    ASSERT_EQ(scene.texture_coordinates.size(), scene.positions.size());
    EXPECT_EQ(scene.texture_coordinates[scene.triangles[0].x], vec2(0, 1));
    EXPECT_EQ(scene.texture_coordinates[scene.triangles[0].z], vec2(0, 0.75));
    EXPECT_EQ(scene.texture_coordinates[scene.triangles[1].x], vec2(1, 1));
    EXPECT_EQ(scene.positions[scene.triangles[0].x], scene.positions[scene.triangles[1].x]);
}

TEST(Obj, TakesAMaterialWithoutADefinitionForClayOrByTheColorsOfCorners) {
    const TemporaryFolder folder;
    const std::string rest = "v 1 0 0\nv 0 1 0\nusemtl nobody\nf 1 2 3\n";
    const Scene plain = load_scene(folder.write("plain.obj", "v 0 0 0\n" + rest));
    ASSERT_EQ(plain.materials.size(), 1u);
    EXPECT_EQ(plain.materials[0].base_color, plain_material(false).base_color);
    EXPECT_TRUE(mentions(plain, "1 materials have a name but no definition"));
    const Scene colored = load_scene(folder.write("colored.obj", "v 0 0 0 1 0.5 0\n" + rest));
    ASSERT_EQ(colored.materials.size(), 1u);
    EXPECT_EQ(colored.materials[0].base_color, vec4(1.0f));
}

TEST(Obj, TakesAlphaFromAMaskOfItsOwn) {
    const TemporaryFolder folder;
    folder.write("color.tga", grey_tga(1, 1, "\x40"));
    folder.write("mask.tga", grey_tga(2, 2, std::string("\xff\x00\x00\xff", 4)));
    folder.write("a.mtl",
                 "newmtl leaf\nmap_d mask.tga\nmap_Kd color.tga\n"
                 "newmtl white\nmap_d mask.tga\nnewmtl again\nmap_Kd color.tga\nmap_d mask.tga\n"
                 "newmtl solid\nmap_Kd color.tga\nmap_d gone.tga\n");
    Scene scene =
        load_scene(folder.write("a.obj",
                                "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                "usemtl leaf\nf 1/1 2/2 3/3\n"));
    decode_textures(scene, WantedTextures::all);
    ASSERT_EQ(scene.materials.size(), 4u);
    const auto picture = [&](std::size_t material) {
        const int texture = scene.materials[material].base_color_texture;
        return scene.textures.at(static_cast<std::size_t>(texture)).picture->pixels;
    };
    using Pixels = decltype(picture(0));
    const Pixels leaf = picture(0);
    EXPECT_EQ(leaf,
              (Pixels{{64, 64, 64, 255}, {64, 64, 64, 0}, {64, 64, 64, 0}, {64, 64, 64, 255}}));
    EXPECT_EQ(picture(1)[1], (Pixels::value_type{255, 255, 255, 0}));
    EXPECT_EQ(scene.materials[2].base_color_texture, scene.materials[0].base_color_texture);
    for (std::size_t m = 0; m < 3; ++m) EXPECT_TRUE(scene.materials[m].alpha_cutoff);
    EXPECT_FALSE(scene.materials[3].alpha_cutoff);
    EXPECT_TRUE(mentions(scene, "gone.tga"));

    // The holes are in the voxels too, and in copies of the scene.
    const auto voxels = [](const Scene& s) {
        BuildOptions options;
        options.depth = 6;
        return compute_statistics(build(s, options).dag).voxels;
    };
    const std::uint64_t with_holes = voxels(scene);
    Scene opaque = scene;
    for (Material& m : opaque.materials) m.alpha_cutoff.reset();
    EXPECT_LT(with_holes, 3 * voxels(opaque) / 4);
    for (const char* name : {"copy.glb", "copy.obj"}) {
        save_scene(scene, folder.path() / name);
        Scene copy = load_scene(folder.path() / name);
        decode_textures(copy, WantedTextures::all);
        EXPECT_EQ(voxels(copy), with_holes) << name;
    }
}

TEST(Obj, FindsMaterialsInALibraryThatIsNamedAfterTheirUse) {
    const TemporaryFolder folder;
    folder.write("a.mtl", "newmtl red\nKd 1 0 0\n");
    const Scene scene = load_scene(folder.write(
        "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nmtllib none.mtl a.mtl\n"));
    EXPECT_EQ(scene.materials[scene.triangle_materials[0]].base_color, vec4(1, 0, 0, 1));
    EXPECT_TRUE(mentions(scene, "none.mtl"));
}

TEST(Obj, ReadsLinesOfAnyLengthGzippedOrNot) {
    // More than one buffer of the reader: many lines, and one face of 100 000 corners.
    std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    for (int i = 0; i < 60000; ++i) text += "f 1 2 " + std::to_string(3 + i % 2) + "\r\n";
    text += "f";
    for (int i = 0; i < 100000; ++i) text += i % 1000 == 7 ? " \\\n 1" : " 1";
    text += "\nf 4 3 2";
    const test::TemporaryFolder folder;
    const auto zipped = folder.path() / "a.obj.gz";
    gzFile gz = gzopen(zipped.c_str(), "wb1");
    gzwrite(gz, text.data(), static_cast<unsigned>(text.size()));
    gzclose(gz);
    for (const auto& file : {folder.write("a.obj", text), zipped}) {
        const Scene scene = load_scene(file);
        ASSERT_EQ(scene.triangles.size(), 60000u + 99998u + 1u);
        EXPECT_EQ(scene.triangles[59999], uvec3(0, 1, 3));
        EXPECT_EQ(scene.triangles.back(), uvec3(3, 2, 1));
        EXPECT_TRUE(scene.triangle_materials.empty());
    }
    EXPECT_EQ(test::load_error(folder.write("b.obj", text + "\nf 9 1 2")).offset(),
              text.size() + 3);
}

TEST(Obj, IsNeverInMemoryWhole) {
    constexpr std::size_t kSize = std::size_t{64} << 20;
    std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    const std::string comment = "# " + std::string(1000, '-') + "\n";
    while (text.size() < kSize) text += comment;
    const test::TemporaryFolder folder;
    const auto file = folder.write("a.obj", text + "f 1 2 3\n");
    text = {};
    trim_memory();
    if (!restart_peak_resident()) GTEST_SKIP() << "the system does not let the peak start anew";
    const std::uint64_t before = resident_bytes();
    EXPECT_EQ(load_scene(file).triangles.size(), 1u);
    EXPECT_LT(peak_resident_bytes(), before + kSize / 4);
}

}  // namespace
}  // namespace octavo
