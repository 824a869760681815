// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "mesh/mesh_files.h"

namespace octavo {
namespace {

using test::load_error;
using test::raw;
using test::TemporaryFolder;

const std::string kVertexHeader = "property float x\nproperty float y\nproperty float z\n";

std::string ascii_triangle(const std::string& indices) {
    return "ply\nformat ascii 1.0\nelement vertex 3\n" + kVertexHeader +
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0\n1 0 0\n0 1 0\n" +
           indices;
}

template <class T>
std::string swapped(T value, bool big) {
    std::string bytes = raw(value);
    if (big) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

TEST(Ply, ReadsAsciiWithPropertiesAndElementsItDoesNotKnow) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.ply",
        "ply\r\nformat ascii 1.0\r\ncomment by hand\r\nobj_info none\r\n"
        "element sensor 2\r\nproperty list int double readings\r\nproperty char id\r\n"
        "element vertex 4\r\nproperty float confidence\r\nproperty double x\r\n"
        "property float32 y\r\nproperty int z\r\nproperty uchar red\r\nproperty uchar green\r\n"
        "property uchar blue\r\nelement face 2\r\nproperty uchar flags\r\n"
        "property list uint8 uint32 vertex_index\r\nend_header\r\n"
        "3 1.5 nan -inf 7\r\n0 8\r\n"
        "0.5 5700000.123456789 +1 2 255 0 128\r\n1 1 0 0 1 2 3\r\n1 1 1 0 1 2 3\r\n"
        "1 0 1 0 1 2 3\r\n9 4 0 1\r\n2 3 9 3 0 1 2");  // a list may go on in the next line
    const Scene scene = load_scene(file);
    EXPECT_EQ(scene.triangles.size(), 3u);  // a quad and a triangle
    EXPECT_EQ(scene.positions[0], dvec3(5700000.123456789, 1, 2));
    EXPECT_EQ(scene.colors[0], (std::array<std::uint8_t, 4>{255, 0, 128, 255}));
}

TEST(Ply, ReadsBothByteOrdersAndEveryNumberType) {
    const TemporaryFolder folder;
    for (const bool big : {false, true}) {
        std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                            "_endian 1.0\nelement vertex 3\nproperty double x\nproperty short y\n"
                            "property uint z\nproperty list ushort float weights\n"
                            "element face 1\nproperty list int ushort vertex_indices\nend_header\n";
        for (int i = 0; i < 3; ++i) {
            bytes += swapped(5.7e6 + 0.001 * i, big) +
                     swapped(static_cast<std::int16_t>(-7 * i), big) +
                     swapped(std::uint32_t{4000000000u}, big);
            bytes += swapped(std::uint16_t{1}, big) + swapped(1.0f, big);
        }
        bytes += swapped(std::int32_t{3}, big);
        for (const auto index : std::initializer_list<std::uint16_t>{2, 1, 0})
            bytes += swapped(index, big);
        const Scene scene = load_scene(folder.write("a.ply", bytes));
        ASSERT_EQ(scene.triangles.size(), 1u);
        EXPECT_EQ(scene.triangles[0], uvec3(2, 1, 0));
        EXPECT_EQ(scene.positions[2], dvec3(5.7e6 + 0.002, -14, 4e9));
    }
}

TEST(Ply, ReadsStripsThatBeginAnewAtMinusOne) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.ply", "ply\nformat ascii 1.0\nelement vertex 5\n" + kVertexHeader +
                     "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                     "0 0 0 1 0 0 0 1 0 1 1 0 2 2 2\n8 0 1 2 3 -1 2 3 4\n");
    const Scene scene = load_scene(file);
    ASSERT_EQ(scene.triangles.size(), 3u);
    EXPECT_EQ(scene.triangles[1], uvec3(2, 1, 3));  // turned, so that its front stays in front
    EXPECT_EQ(scene.triangles[2], uvec3(2, 3, 4));
}

TEST(Ply, KeepsCoordinatesThatAreNotFinite) {
    const TemporaryFolder folder;
    std::string text = ascii_triangle("3 0 1 2\n3 0 2 0\n");  // the second is finite
    text.replace(text.find("face 1"), 6, "face 2");
    text.replace(text.find("1 0 0\n"), 6, "nan inf 1e999\n");
    const Scene scene = load_scene(folder.write("a.ply", text));
    EXPECT_TRUE(std::isnan(scene.positions[1].x));
    EXPECT_TRUE(std::isinf(scene.positions[1].y));
    EXPECT_TRUE(std::isinf(scene.positions[1].z));
}

TEST(Ply, NamesTheByteOfABadIndex) {
    const TemporaryFolder folder;
    for (const char* bad : {"3", "-1", "4000000000", "nan", "1e30"}) {
        const std::string text = ascii_triangle(std::string("3 0 1 ") + bad + "\n");
        const Error error = load_error(folder.write("a.ply", text));
        EXPECT_EQ(error.code(), Errc::bad_input) << bad;
        ASSERT_TRUE(error.offset()) << bad;
        EXPECT_NEAR(static_cast<double>(*error.offset()), static_cast<double>(text.rfind(bad)), 1.0)
            << error.what();
    }
}

TEST(Ply, RejectsCountsThatTheFileHasNoRoomFor) {
    const TemporaryFolder folder;
    for (const char* count : {"4", "1000000", "4294967296", "9223372036854775807"}) {
        for (const char* format : {"ascii", "binary_little_endian"}) {
            std::string text = ascii_triangle("3 0 1 2\n");
            text.replace(text.find("vertex 3"), 8, std::string("vertex ") + count);
            text.replace(text.find("ascii"), 5, format);
            EXPECT_EQ(load_error(folder.write("a.ply", text)).code(), Errc::bad_input) << count;
        }
    }
    // An element without properties takes no bytes, so any number of them may be announced.
    std::string text = ascii_triangle("3 0 1 2\n");
    text.replace(text.find("element face"), 0, "element ghost 9223372036854775807\n");
    EXPECT_EQ(load_scene(folder.write("a.ply", text)).triangles.size(), 1u);
}

TEST(Ply, RejectsAListLongerThanTheFile) {
    const TemporaryFolder folder;
    const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" +
                               kVertexHeader +
                               "element face 1\nproperty list uint int extra\n"
                               "property list uint int vertex_indices\nend_header\n";
    const std::string vertices(36, '\0');
    const auto huge = raw(std::uint32_t{0xffffffffu});
    EXPECT_EQ(load_error(folder.write("a.ply", header + vertices + huge)).code(), Errc::bad_input);
    EXPECT_EQ(load_error(folder.write("b.ply", header + vertices + raw(0u) + huge)).code(),
              Errc::bad_input);
}

TEST(Ply, EndsInAnErrorWhereverItIsCutShort) {
    const TemporaryFolder folder;
    const std::string text = ascii_triangle("3 0 1 2");
    for (std::size_t size = 0; size < text.size(); ++size) {
        const Error error = load_error(folder.write("a.ply", text.substr(0, size)));
        EXPECT_EQ(error.code(), Errc::bad_input) << "cut at " << size;
    }
    std::string binary = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" +
                         kVertexHeader +
                         "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    binary += std::string(36, '\0') + raw(std::uint8_t{3}) + raw(0) + raw(1) + raw(2);
    EXPECT_EQ(load_scene(folder.write("b.ply", binary)).triangles.size(), 1u);
    for (std::size_t size = 0; size < binary.size(); ++size)
        EXPECT_EQ(load_error(folder.write("b.ply", binary.substr(0, size))).code(), Errc::bad_input)
            << "cut at " << size;
}

TEST(Ply, SaysThatAPointCloudHasNoTriangles) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\n" +
                                                kVertexHeader + "end_header\n1 2 3\n");
    const Error error = load_error(file);
    EXPECT_EQ(error.code(), Errc::bad_input);
    EXPECT_NE(std::string(error.what()).find("has no triangles"), std::string::npos);
}

TEST(Ply, ReadsGzippedFilesOfSeveralMembers) {
    const TemporaryFolder folder;
    const std::string text = ascii_triangle("3 0 1 2\n");
    const auto file = folder.path() / "a.ply.gz";
    for (const auto& [mode, part] :
         {std::pair{"wb", text.substr(0, 90)}, {"ab", text.substr(90)}}) {
        gzFile gz = gzopen(file.c_str(), mode);
        gzwrite(gz, part.data(), static_cast<unsigned>(part.size()));
        gzclose(gz);
    }
    EXPECT_EQ(load_scene(file).triangles.size(), 1u);

    std::string bytes(std::filesystem::file_size(file), '\0');
    std::ifstream(file, std::ios::binary)
        .read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    for (std::size_t size = 2; size < bytes.size(); size += 7)
        EXPECT_EQ(load_error(folder.write("b.ply.gz", bytes.substr(0, size))).code(),
                  Errc::bad_input);
}

/// A strip of triangles that takes a few windows of a reader to read.
constexpr int kLongStrip = 30000;

std::string long_ply(bool text, const std::string& comment) {
    std::string bytes =
        std::string("ply\nformat ") + (text ? "ascii" : "binary_little_endian") + " 1.0\ncomment " +
        comment + "\nelement vertex " + std::to_string(kLongStrip) +
        "\nproperty double x\nproperty float y\nproperty int z\nelement face " +
        std::to_string(kLongStrip - 2) + "\nproperty list uchar int vertex_indices\nend_header\n";
    for (int i = 0; i < kLongStrip; ++i)
        bytes += text ? std::to_string(i) + ".5 " + std::to_string(-i) + " " +
                            std::to_string(i / 7) + "\n"
                      : raw(i + 0.5) + raw(static_cast<float>(-i)) + raw(i / 7);
    for (int i = 0; i + 2 < kLongStrip; ++i)
        bytes += text ? "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " +
                            std::to_string(i + 2) + " "
                      : raw(std::uint8_t{3}) + raw(i) + raw(i + 1) + raw(i + 2);
    return bytes;
}

std::filesystem::path zip(const std::filesystem::path& file, const std::string& bytes) {
    gzFile gz = gzopen(file.c_str(), "wb1");
    gzwrite(gz, bytes.data(), static_cast<unsigned>(bytes.size()));
    gzclose(gz);
    return file;
}

TEST(Ply, OfManyWindowsIsReadWhereverTheyEnd) {
    const TemporaryFolder folder;
    for (const bool text : {false, true}) {
        for (std::size_t shift = 0; shift < 32; ++shift) {
            const std::string bytes = long_ply(text, std::string(shift, '-'));
            const Scene scene = load_scene(shift % 2 == 0 ? folder.write("a.ply", bytes)
                                                          : zip(folder / "a.ply.gz", bytes));
            ASSERT_EQ(scene.positions.size(), std::size_t{kLongStrip});
            ASSERT_EQ(scene.triangles.size(), std::size_t{kLongStrip - 2});
            for (int i = 0; i < kLongStrip; ++i)
                ASSERT_EQ(scene.positions[static_cast<std::size_t>(i)], dvec3(i + 0.5, -i, i / 7))
                    << "shift " << shift;
            for (std::uint32_t i = 0; i + 2 < kLongStrip; ++i)
                ASSERT_EQ(scene.triangles[i], uvec3(i, i + 1, i + 2)) << "shift " << shift;
        }
    }
}

TEST(Ply, NamesTheByteOfABadIndexBehindManyWindows) {
    const TemporaryFolder folder;
    for (const bool text : {false, true}) {
        std::string bytes = long_ply(text, "");
        const std::string last = text ? std::to_string(kLongStrip - 1) : raw(kLongStrip - 1);
        const std::size_t where = bytes.rfind(last);
        bytes.replace(where, last.size(), text ? std::string("99999") : raw(99999));
        for (const auto& file : {folder.write("a.ply", bytes), zip(folder / "a.ply.gz", bytes)}) {
            const Error error = load_error(file);
            EXPECT_EQ(error.code(), Errc::bad_input);
            ASSERT_TRUE(error.offset()) << error.what();
            EXPECT_EQ(*error.offset(), where) << error.what();
        }
    }
}

TEST(Ply, ReadsLinesAndWordsThatAreLongerThanAWindow) {
    const TemporaryFolder folder;
    const std::string zeros(700000, '0');
    std::string text = ascii_triangle("3 0 1 " + zeros + "2");
    text.replace(text.find("1 0 0"), 1, "1." + zeros + "1");
    text.insert(text.find("element vertex"), "comment " + std::string(1000000, 'x') + "\n");
    const Scene scene = load_scene(folder.write("a.ply", text));
    EXPECT_EQ(scene.positions[1], dvec3(1, 0, 0));
    EXPECT_EQ(scene.triangles[0], uvec3(0, 1, 2));
    EXPECT_EQ(load_error(folder.write("b.ply", text.substr(0, text.size() - 1) + "3")).code(),
              Errc::bad_input);
}

TEST(Ply, SkipsListsThatAreLongerThanAWindow) {
    const TemporaryFolder folder;
    constexpr std::uint32_t kLength = 300000;
    for (const std::uint32_t announced : {kLength, kLength + 10}) {
        const std::string bytes =
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + kVertexHeader +
            "element face 1\nproperty list uint int extra\n"
            "property list uchar int vertex_indices\nend_header\n" +
            std::string(36, '\0') + raw(announced) + std::string(4 * kLength, '\x7f') +
            raw(std::uint8_t{3}) + raw(0) + raw(1) + raw(2);
        for (const auto& file : {folder.write("a.ply", bytes), zip(folder / "a.ply.gz", bytes)}) {
            if (announced == kLength)
                EXPECT_EQ(load_scene(file).triangles[0], uvec3(0, 1, 2));
            else
                EXPECT_EQ(load_error(file).code(), Errc::bad_input);
        }
    }
}

TEST(Ply, SaysThatGzipDataAreDamagedWhateverTheyInflateTo) {
    const TemporaryFolder folder;
    const std::string bytes = long_ply(true, "");
    const auto file = zip(folder / "a.ply.gz", bytes);
    std::string zipped(std::filesystem::file_size(file), '\0');
    std::ifstream(file, std::ios::binary)
        .read(zipped.data(), static_cast<std::streamsize>(zipped.size()));
    for (std::size_t at = 20; at < zipped.size(); at += zipped.size() / 40) {
        std::string damaged = zipped;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
        const Error error = load_error(folder.write("b.ply.gz", damaged));
        EXPECT_EQ(error.code(), Errc::bad_input);
        EXPECT_NE(std::string(error.what()).find("the gzip data is"), std::string::npos)
            << error.what() << ", byte " << at;
    }
    // The end of the data is checked although nothing of the scene is in it.
    const Error error = load_error(folder.write("b.ply.gz", zipped.substr(0, zipped.size() - 4)));
    EXPECT_NE(std::string(error.what()).find("cut short"), std::string::npos) << error.what();
}

TEST(Ply, OfGzipDataThatEndTooEarlyIsRefused) {
    const TemporaryFolder folder;
    const std::string whole = long_ply(false, "");
    for (const std::size_t missing : {std::size_t{1}, std::size_t{13}, whole.size() / 2})
        EXPECT_EQ(
            load_error(zip(folder / "a.ply.gz", whole.substr(0, whole.size() - missing))).code(),
            Errc::bad_input);
    for (const char* count : {"30001", "1000000", "4294967294", "9223372036854775807"}) {
        std::string bytes = whole;
        bytes.replace(bytes.find("30000"), 5, count);
        EXPECT_EQ(load_error(zip(folder / "a.ply.gz", bytes)).code(), Errc::bad_input) << count;
    }
}

}  // namespace
}  // namespace octavo
