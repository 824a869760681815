// SPDX-License-Identifier: MIT
//
// What assimp's scenes leave to us: which way is up, and where there are holes.
#include "mesh_files.h"
#include "octavo/mesh/alpha.h"
#include "octavo/mesh/decode_textures.h"
#include "octavo/mesh/masked_texture.h"

namespace octavo {
namespace {

using test::grey_tga;
using test::TemporaryFolder;

/// A texture of one row of grey pixels with this alpha, as an uncompressed TGA.
std::string row_of_alpha(const std::string& alpha) {
    std::string bytes("\0\0\2\0\0\0\0\0\0\0\0\0", 12);
    bytes += static_cast<char>(alpha.size());
    bytes += std::string("\0\1\0\x20\x28", 5);
    for (const char a : alpha) bytes += std::string(3, '\x40') + a;
    return bytes;
}

/// The alpha of the pixels of a material's texture, once decoded.
std::vector<int> alpha_of(const Scene& scene, std::size_t material) {
    const int texture = scene.materials.at(material).base_color_texture;
    std::vector<int> alpha;
    const Texture* decoded = decoded_texture(scene, texture);
    if (!decoded) return {};
    for (const auto& pixel : decoded->picture->pixels) alpha.push_back(pixel[3]);
    return alpha;
}

/// A COLLADA file of a triangle whose surface has a colour map and this <transparent> part.
std::string collada(const std::string& images, const std::string& transparent) {
    return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Z_UP</up_axis></asset>
<library_images>)" +
           images + R"(</library_images>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert>
<diffuse><texture texture="color" texcoord="UV"/></diffuse>)" +
           transparent + R"(
</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 0 1</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="u"><float_array id="ua" count="6">0 0 1 0 0 1</float_array><technique_common>
<accessor source="#ua" count="3" stride="2"><param name="S" type="float"/>
<param name="T" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="s"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#u" offset="1" set="0"/><p>0 0 1 1 2 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node><instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="s" target="#m">
<bind_vertex_input semantic="UV" input_semantic="TEXCOORD" input_set="0"/></instance_material>
</technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>
)";
}

std::string image(const std::string& id, const std::string& file) {
    return "<image id=\"" + id + "\"><init_from>" + file + "</init_from></image>";
}

TEST(Assimp, ColladasTransparencyMapMakesHoles) {
    const TemporaryFolder folder;
    folder.write("color.tga", grey_tga(1, 1, "\x40"));
    folder.write("mask.tga", grey_tga(2, 1, std::string("\xff\0", 2)));
    Scene scene = load_scene(folder.write(
        "leaf.dae", collada(image("color", "color.tga") + image("mask", "mask.tga"),
                            "<transparent><texture texture=\"mask\" texcoord=\"UV\"/>"
                            "</transparent><transparency><float>0</float></transparency>")));
    EXPECT_EQ(scene.bounds().high, dvec3(1, 1, 0));  // its z is up
    decode_textures(scene, WantedTextures::all);
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].alpha_cutoff, 0.5f);
    EXPECT_EQ(scene.materials[0].base_color.a, 1.0f);
    EXPECT_EQ(alpha_of(scene, 0), (std::vector{255, 0}));
}

TEST(Assimp, AMapThatIsMissingMakesNoHoles) {
    const TemporaryFolder folder;
    folder.write("color.tga", row_of_alpha(std::string(1, '\0')));
    const Scene scene = load_scene(
        folder.write("wall.dae", collada(image("color", "color.tga") + image("mask", "gone.tga"),
                                         "<transparent><texture texture=\"mask\" texcoord=\"UV\"/>"
                                         "</transparent>")));
    EXPECT_TRUE(test::mentions(scene, "gone.tga"));
    EXPECT_FALSE(scene.materials.at(0).alpha_cutoff);
    EXPECT_FALSE(load_scene(folder.write("plain.dae", collada(image("color", "color.tga"), "")))
                     .materials.at(0)
                     .alpha_cutoff);
}

TEST(Assimp, AlphaOfAnAc3dTextureMakesHoles) {
    const TemporaryFolder folder;
    folder.write("leaf.tga", row_of_alpha(std::string("\xff\0", 2)));
    Scene scene = load_scene(folder.write(
        "tree.ac",
        "AC3Db\nMATERIAL \"m\" rgb 1 1 1  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 10  trans 0\n"
        "OBJECT world\nkids 1\nOBJECT poly\nname \"leaf\"\ntexture \"leaf.tga\"\nnumvert 3\n"
        "0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x30\nmat 0\nrefs 3\n0 0 0\n1 1 0\n2 0 1\nkids 0\n"));
    decode_textures(scene, WantedTextures::all);
    const auto material = scene.triangle_materials.at(0);
    EXPECT_EQ(scene.materials.at(material).alpha_cutoff, 0.5f);
    EXPECT_EQ(alpha_of(scene, material), (std::vector{255, 0}));
}

TEST(Assimp, BlenderFilesStandUpright) {
    // Their bytes are a dump of the program's memory, so that none is made here.
    const std::filesystem::path file = "/usr/share/assimp/models/BLEND/BlenderDefault_269.blend";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "needs the package assimp-testmodels";
    const Scene scene = load_scene(file);
    const dvec3 eye = scene.cameras.at(0).eye;  // 7.48, -6.51, 5.34 in Blender
    EXPECT_LT(glm::distance(eye, dvec3(7.48, 5.34, 6.51)), 0.01) << eye.x << ' ' << eye.y;
}

TEST(SetBaseColorTexture, TakesPicturesWithinTheSceneFileToo) {
    const std::string color = grey_tga(1, 1, "\x40"),
                      mask = grey_tga(2, 1, std::string("\0\xff", 2));
    const auto bytes = [](const std::string& s) { return std::as_bytes(std::span(s)); };
    Scene scene;
    Material leaf, same;
    set_base_color_texture(scene, leaf, ".", {"*0", bytes(color)}, {"*1", bytes(mask)});
    set_base_color_texture(scene, same, ".", {"*0", bytes(color)}, {"*1", bytes(mask)});
    EXPECT_EQ(same.base_color_texture, leaf.base_color_texture);
    scene.materials = {leaf};
    decode_textures(scene, WantedTextures::all);
    EXPECT_EQ(leaf.alpha_cutoff, 0.5f);
    EXPECT_EQ(alpha_of(scene, 0), (std::vector{0, 255}));
    EXPECT_EQ(scene.textures[0].picture->pixels[0][0], 0x40);
}

}  // namespace
}  // namespace octavo
