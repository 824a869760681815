// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <zlib.h>

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

TEST(Stl, OfManyWindowsIsReadWhereverTheyEnd) {
    const TemporaryFolder folder;
    constexpr int kTriangles = 12000;
    const auto expect_all = [&](const std::filesystem::path& file, const std::string& what) {
        const Scene scene = load_scene(file);
        ASSERT_EQ(scene.positions.size(), std::size_t{3 * kTriangles}) << what;
        for (int i = 0; i < 3 * kTriangles; ++i)
            ASSERT_EQ(scene.positions[static_cast<std::size_t>(i)],
                      dvec3(i % 3 * 3 + i / 3, i % 3 * 3 + 1 + i / 3, i % 3 * 3 + 2 + i / 3))
                << what;
        EXPECT_TRUE(scene.warnings.empty()) << what;
    };
    const std::string binary = binary_stl("solid", kTriangles, kTriangles);
    expect_all(folder.write("a.stl", binary), "binary");
    const auto zipped = folder / "a.stl.gz";
    gzFile gz = gzopen(zipped.c_str(), "wb1");
    gzwrite(gz, binary.data(), static_cast<unsigned>(binary.size()));
    gzclose(gz);
    expect_all(zipped, "zipped");

    std::string facets;
    for (int t = 0; t < kTriangles; ++t) {
        facets += "facet normal 0 0 1\nouter loop\n";
        for (int i = t; i < t + 9; i += 3)
            facets += "vertex " + std::to_string(i) + " " + std::to_string(i + 1) + " " +
                      std::to_string(i + 2) + "\n";
        facets += "endloop\nendfacet\n";
    }
    for (std::size_t shift : {0, 1, 2, 3, 5, 8, 13, 21, 34, 55, 600000})
        expect_all(folder.write("b.stl", "solid " + std::string(shift, 'x') + " y\n" + facets +
                                             "endsolid " + std::string(shift, 'x')),
                   "text moved by " + std::to_string(shift));
}

TEST(Stl, OfGzipDataThatEndTooEarlyIsRefused) {
    const TemporaryFolder folder;
    const auto file = folder / "a.stl.gz";
    const std::string bytes = binary_stl("x", 12001, 12000);
    gzFile gz = gzopen(file.c_str(), "wb1");
    gzwrite(gz, bytes.data(), static_cast<unsigned>(bytes.size()));
    gzclose(gz);
    EXPECT_EQ(load_error(file).code(), Errc::bad_input);
}

}  // namespace
}  // namespace octavo
