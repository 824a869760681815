// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "mesh/mesh_files.h"
#include "octavo/mesh/confined_path.h"

namespace octavo {
namespace {

namespace fs = std::filesystem;
using test::load_error;
using test::mentions;
using test::TemporaryFolder;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";

TEST(ConfinedPath, AcceptsWhatIsInTheFolderHoweverItIsWritten) {
    const TemporaryFolder folder;
    folder.write("scene/textures/a.png", "");
    const fs::path scene = folder.path() / "scene", wanted = scene / "textures/a.png";
    EXPECT_EQ(confined_path(scene, "textures/a.png"), wanted);
    EXPECT_EQ(confined_path(scene, "./textures/../textures//a.png"), wanted);
    EXPECT_EQ(confined_path(scene, "textures\\a.png"), wanted);
    EXPECT_EQ(confined_path(scene, wanted.string()), wanted);
    EXPECT_EQ(confined_path(scene, "../scene/textures/a.png"), wanted);
    EXPECT_EQ(confined_path(scene, "not/there.png"), scene / "not/there.png");
}

TEST(ConfinedPath, RefusesWhatIsOutside) {
    const TemporaryFolder folder;
    folder.write("secret.png", "");
    folder.write("scene2/b.png", "");
    folder.write("scene/a.png", "");
    const fs::path scene = folder.path() / "scene";
    fs::create_symlink(folder.path() / "secret.png", scene / "link.png");
    fs::create_directory_symlink(folder.path(), scene / "up");
    for (const std::string& outside :
         {std::string("../secret.png"), std::string("/etc/passwd"), std::string("link.png"),
          std::string("up/secret.png"), std::string("../scene2/b.png"),
          std::string("..\\secret.png"), std::string(".."), std::string("."), std::string(),
          std::string("a.png\0x", 7)})
        EXPECT_FALSE(confined_path(scene, outside)) << outside;
}

TEST(ConfinedPath, DecodesPercentSigns) {
    EXPECT_EQ(percent_decoded("my%20wall%2epng"), "my wall.png");
    EXPECT_EQ(percent_decoded("100%"), "100%");
    EXPECT_EQ(percent_decoded("%zz%2"), "%zz%2");
}

TEST(Confinement, LeavesOutTexturesOutsideTheFolder) {
    const TemporaryFolder folder;
    folder.write("secret.png", "secret");
    folder.write("scene/m.mtl", "newmtl m\nmap_Kd ../secret.png\nmap_Ke link.png\n");
    fs::create_symlink(folder.path() / "secret.png", folder.path() / "scene/link.png");
    const Scene scene = load_scene(folder.write("scene/a.obj", "mtllib m.mtl\n" + kTriangle));
    EXPECT_TRUE(scene.textures.empty());
    EXPECT_EQ(scene.materials[0].base_color_texture, Material::kNoTexture);
    EXPECT_TRUE(mentions(scene, "'../secret.png' is outside"));
    EXPECT_TRUE(mentions(scene, "'link.png' is outside"));
}

TEST(Confinement, RefusesMaterialLibrariesAndBuffersOutsideTheFolder) {
    const TemporaryFolder folder;
    folder.write("m.mtl", "newmtl m\n");
    folder.write("data.bin", std::string(64, '\0'));
    const auto obj = folder.write("scene/a.obj", "mtllib ../m.mtl\n" + kTriangle);
    EXPECT_EQ(load_error(obj).code(), Errc::bad_input);
    for (const char* uri : {"../data.bin", "%2e%2e/data.bin", "/dev/zero"}) {
        const auto gltf = folder.write(
            "scene/a.gltf", std::string(R"({"asset":{"version":"2.0"},"buffers":[{"uri":")") + uri +
                                R"(","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]})");
        const Error error = load_error(gltf);
        EXPECT_EQ(error.code(), Errc::bad_input) << uri;
        EXPECT_NE(std::string(error.what()).find("outside"), std::string::npos) << error.what();
    }
}

TEST(Confinement, ASceneReachedThroughALinkHasTheFolderThatItWasNamedIn) {
    const TemporaryFolder folder;
    folder.write("real/textures/t.png", "");
    folder.write("real/m.mtl", "newmtl m\nmap_Kd textures/t.png\n");
    folder.write("real/a.obj", "mtllib m.mtl\n" + kTriangle);
    fs::create_directory_symlink(folder.path() / "real", folder.path() / "alias");
    EXPECT_EQ(load_scene(folder.path() / "alias/a.obj").textures.size(), 1u);
}

}  // namespace
}  // namespace octavo
