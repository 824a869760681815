// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "mesh/mesh_files.h"

namespace octavo {
namespace {

using test::load_error;
using test::raw;
using test::TemporaryFolder;

std::string binary_stl(const std::string& title, std::uint32_t announced, int triangles) {
    std::string bytes = title;
    bytes.resize(80, ' ');
    bytes += raw(announced);
    for (int t = 0; t < triangles; ++t) {
        for (int i = 0; i < 3; ++i) bytes += raw(0.0f);
        for (int i = 0; i < 9; ++i) bytes += raw(static_cast<float>(i + t));
        bytes += raw(std::uint16_t{0});
    }
    return bytes;
}

const std::string kText =
    "SOLID two words\n facet normal nan 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.5 0 0\n"
    "   vertex 0 5700000.123456789 0\n  endloop\n endfacet\nendsolid two words\n";

TEST(Stl, ReadsBinaryThatBeginsWithSolid) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.stl", binary_stl("solid lies", 2, 2)));
    EXPECT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(scene.positions[5], dvec3(7, 8, 9));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Stl, ReadsTextInDouble) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.stl", kText + kText));
    EXPECT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(scene.positions[2].y, 5700000.123456789);
}

TEST(Stl, ReadsBinaryWithBytesAfterItsTriangles) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.stl", binary_stl("made by hand", 1, 1) + "xyz"));
    EXPECT_EQ(scene.triangles.size(), 1u);
    EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(Stl, RejectsCountsThatTheFileHasNoRoomFor) {
    const TemporaryFolder folder;
    for (const std::uint32_t count : {3u, 1000000u, 0xffffffffu})
        EXPECT_EQ(load_error(folder.write("a.stl", binary_stl("x", count, 2))).code(),
                  Errc::bad_input);
}

TEST(Stl, RejectsTextThatIsCutShortInsideAFacet) {
    const TemporaryFolder folder;
    for (std::size_t size = kText.find("vertex"); size < kText.find("endfacet"); ++size)
        EXPECT_EQ(load_error(folder.write("a.stl", kText.substr(0, size))).code(), Errc::bad_input)
            << "cut at " << size;
    EXPECT_EQ(load_error(folder.write("a.stl", "solid x\nfacet\nvertex 1 2 3\nendfacet\n")).code(),
              Errc::bad_input);
}

}  // namespace
}  // namespace octavo
