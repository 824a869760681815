// SPDX-License-Identifier: MIT
// glTF meshes packed by meshopt and Draco: packed here by the same libraries, unpacked by the
// reader, and held against the plain file.
#include <draco/compression/encode.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/gltf_file.h"
#include "support/sanitized.h"

namespace octavo {
namespace {

using test::GltfFile;
using test::json;
using test::load_error;
using test::TemporaryFolder;

constexpr int kSide = 12;  // vertices along each side of a bumpy square

std::vector<float> bumps() {
    std::vector<float> positions;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            positions.insert(positions.end(),
                             {static_cast<float>(x), 0.1f * static_cast<float>(x * y % 7),
                              static_cast<float>(y)});
    return positions;
}

std::vector<std::uint8_t> tints() {
    std::vector<std::uint8_t> colors;
    for (int i = 0; i < kSide * kSide; ++i)
        for (const int c : {i, 3 * i, 255 - i, 255}) colors.push_back(static_cast<std::uint8_t>(c));
    return colors;
}

template <class Index>
std::vector<Index> square_triangles() {
    std::vector<Index> indices;
    for (int y = 0; y + 1 < kSide; ++y)
        for (int x = 0; x + 1 < kSide; ++x) {
            const int a = y * kSide + x;
            for (const int i : {a, a + 1, a + kSide, a + kSide, a + 1, a + kSide + 1})
                indices.push_back(static_cast<Index>(i));
        }
    return indices;
}

/// Three primitives over one set of vertices: words, half words, and a strip.
GltfFile plain_file() {
    GltfFile file;
    const json attributes{
        {"POSITION", file.positions(bumps())},
        {"COLOR_0", file.accessor(tints(), 5121, "VEC4", 4, true)},
    };
    const int words = file.accessor(square_triangles<std::uint32_t>(), 5125, "SCALAR", 1);
    const int halves = file.accessor(square_triangles<std::uint16_t>(), 5123, "SCALAR", 1);
    const int strip = file.accessor<std::uint16_t>({0, 1, 12, 13, 24, 25, 36}, 5123, "SCALAR", 1);
    file.root["meshes"] = {{{"primitives",
                             {{{"attributes", attributes}, {"indices", words}},
                              {{"attributes", attributes}, {"indices", halves}},
                              {{"attributes", attributes}, {"indices", strip}, {"mode", 5}}}}}};
    file.root["nodes"] = {{{"mesh", 0}}};
    return file;
}

std::string encoded(const std::string& mode, std::size_t count, std::size_t stride,
                    const char* from) {
    std::vector<unsigned char> packed;
    if (mode == "ATTRIBUTES") {
        packed.resize(meshopt_encodeVertexBufferBound(count, stride));
        packed.resize(
            meshopt_encodeVertexBuffer(packed.data(), packed.size(), from, count, stride));
        return {packed.begin(), packed.end()};
    }
    std::vector<unsigned> indices(count);
    for (std::size_t i = 0; i < count; ++i) std::memcpy(&indices[i], from + i * stride, stride);
    if (mode == "TRIANGLES") {
        packed.resize(meshopt_encodeIndexBufferBound(count, kSide * kSide));
        packed.resize(
            meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), count));
    } else {
        packed.resize(meshopt_encodeIndexSequenceBound(count, kSide * kSide));
        packed.resize(
            meshopt_encodeIndexSequence(packed.data(), packed.size(), indices.data(), count));
    }
    return {packed.begin(), packed.end()};
}

/// The same file with every view packed; buffer 1 stands for the plain bytes and does not exist.
GltfFile meshopt_file(const char* extension = "EXT_meshopt_compression") {
    GltfFile file = plain_file();
    const std::string plain = std::exchange(file.data, {});
    const std::array<std::pair<const char*, std::size_t>, 5> kinds = {{{"ATTRIBUTES", 12},
                                                                       {"ATTRIBUTES", 4},
                                                                       {"TRIANGLES", 4},
                                                                       {"TRIANGLES", 2},
                                                                       {"INDICES", 2}}};
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        json& view = file.root["bufferViews"][i];
        const auto [mode, stride] = kinds[i];
        const std::size_t count = view["byteLength"].get<std::size_t>() / stride;
        const std::string packed =
            encoded(mode, count, stride, plain.data() + view["byteOffset"].get<std::size_t>());
        view["buffer"] = 1;
        view["extensions"][extension] = {
            {"buffer", 0},    {"byteOffset", file.data.size()}, {"byteLength", packed.size()},
            {"count", count}, {"byteStride", stride},           {"mode", mode}};
        file.data += packed;
    }
    file.root["extensionsRequired"] = {extension};
    return file;
}

json& packing(GltfFile& file, int view) {
    return file.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
}

/// Triangles with their least vertex first: the packer turns some.
std::vector<uvec3> turned(std::vector<uvec3> triangles) {
    for (uvec3& t : triangles)
        while (t.x > t.y || t.x > t.z) t = {t.y, t.z, t.x};
    return triangles;
}

TEST(Meshopt, GivesTheScenesOfPlainFiles) {
    const TemporaryFolder folder;
    const Scene plain = load_scene(plain_file().write(folder));
    ASSERT_EQ(plain.triangles.size(), 2u * 242 + 5);
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        const Scene scene = load_scene(meshopt_file(extension).write(folder));
        EXPECT_EQ(scene.positions, plain.positions);
        EXPECT_EQ(turned(scene.triangles), turned(plain.triangles));
        EXPECT_EQ(scene.colors, plain.colors);
        EXPECT_TRUE(scene.warnings.empty());
    }
}

TEST(Meshopt, UndoesTheExponentialFilter) {
    const TemporaryFolder folder;
    const std::vector<float> positions = bumps();
    std::vector<std::uint32_t> filtered(positions.size());
    meshopt_encodeFilterExp(filtered.data(), positions.size() / 3, 12, 24, positions.data());
    GltfFile file = meshopt_file();
    const std::string packed = encoded("ATTRIBUTES", positions.size() / 3, 12,
                                       reinterpret_cast<const char*>(filtered.data()));
    packing(file, 0)["byteOffset"] = file.data.size();
    packing(file, 0)["byteLength"] = packed.size();
    packing(file, 0)["filter"] = "EXPONENTIAL";
    file.data += packed;
    const Scene scene = load_scene(file.write(folder));
    for (std::size_t i = 0; i < scene.positions.size(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(scene.positions[i][c], positions[3 * i + static_cast<std::size_t>(c)],
                        1e-5);
}

TEST(Meshopt, CodecsThatAreNotKnownAreUnsupported) {
    const TemporaryFolder folder;
    const auto refuses = [&](const char* what, auto&& change) {
        GltfFile file = meshopt_file();
        change(file);
        EXPECT_EQ(load_error(file.write(folder)).code(), Errc::unsupported) << what;
    };
    refuses("version", [](GltfFile& f) { f.data[0] = '\xa1'; });
    refuses("mode", [](GltfFile& f) { packing(f, 0)["mode"] = "MESHLETS"; });
    refuses("filter", [](GltfFile& f) { packing(f, 0)["filter"] = "COLOR"; });
    refuses("filter of indices", [](GltfFile& f) { packing(f, 2)["filter"] = "EXPONENTIAL"; });
    refuses("filter of this size", [](GltfFile& f) { packing(f, 0)["filter"] = "QUATERNION"; });
}

TEST(Meshopt, CountsAndSizesThatCannotBeAreBadInput) {
    const TemporaryFolder folder;
    const auto rejects = [&](const char* what, auto&& change) {
        GltfFile file = meshopt_file();
        change(file);
        EXPECT_EQ(load_error(file.write(folder)).code(), Errc::bad_input) << what;
    };
    rejects("count", [](GltfFile& f) { packing(f, 0)["count"] = 1e15; });
    rejects("more than its data", [](GltfFile& f) { packing(f, 0)["count"] = 145 + 256; });
    rejects("less than its data", [](GltfFile& f) { packing(f, 2)["count"] = 723; });
    rejects("less than the accessor", [](GltfFile& f) { packing(f, 4)["count"] = 6; });
    rejects("no whole triangle", [](GltfFile& f) { packing(f, 2)["count"] = 725; });
    rejects("stride 0", [](GltfFile& f) { packing(f, 0)["byteStride"] = 0; });
    rejects("stride 6", [](GltfFile& f) { packing(f, 0)["byteStride"] = 6; });
    rejects("stride 1024", [](GltfFile& f) { packing(f, 0)["byteStride"] = 1024; });
    rejects("index of 8 bytes", [](GltfFile& f) { packing(f, 2)["byteStride"] = 8; });
    rejects("place", [](GltfFile& f) { packing(f, 0)["byteOffset"] = 1e9; });
    rejects("no buffer", [](GltfFile& f) { packing(f, 0)["buffer"] = 1; });
}

TEST(Meshopt, UnpackedViewsStopAtTheCap) {
    const TemporaryFolder folder;
    const auto file = meshopt_file().write(folder);
    try {
        (void)load_scene(file, {.max_bytes = 2048});
        FAIL() << "was loaded";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::limit);
    }
}

/// Changes each byte of the packed data in turn, and cuts the data off before it. @return how many
/// of these files were still a scene; the others were an error that a user can read
int damaged_scenes(GltfFile file, std::size_t step) {
    const TemporaryFolder folder;
    const std::string sound = file.data;
    int scenes = 0;
    const auto load = [&] {
        try {
            (void)load_scene(file.write(folder), {.max_bytes = 64 << 20, .max_seconds = 60.0});
            ++scenes;
        } catch (const Error& error) {
            EXPECT_TRUE(error.code() == Errc::bad_input || error.code() == Errc::unsupported ||
                        error.code() == Errc::limit)
                << error.what();
        }
    };
    for (std::size_t at = 0; at < sound.size(); at += step) {
        file.data = sound;
        file.data[at] = static_cast<char>(file.data[at] ^ (1 << at % 8));
        load();
        file.data = sound.substr(0, at);
        load();
    }
    return scenes;
}

TEST(Meshopt, DamagedDataAreAnErrorOrAnotherScene) {
    EXPECT_GT(damaged_scenes(meshopt_file(), test::kSanitized ? 7 : 1), 0);
}

std::unique_ptr<draco::Mesh> draco_mesh() {
    auto mesh = std::make_unique<draco::Mesh>();
    mesh->set_num_points(kSide * kSide);
    const auto add = [&](draco::GeometryAttribute::Type kind, draco::DataType type,
                         std::int8_t components, std::int64_t stride, const void* values) {
        draco::GeometryAttribute attribute;
        attribute.Init(kind, nullptr, components, type, type == draco::DT_UINT8, stride, 0);
        const int id = mesh->AddAttribute(attribute, true, kSide * kSide);
        for (std::uint32_t i = 0; i < kSide * kSide; ++i)
            mesh->attribute(id)->SetAttributeValue(
                draco::AttributeValueIndex(i),
                static_cast<const char*>(values) + i * static_cast<std::size_t>(stride));
    };
    const auto positions = bumps();
    const auto colors = tints();
    add(draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, 12, positions.data());
    add(draco::GeometryAttribute::COLOR, draco::DT_UINT8, 4, 4, colors.data());
    const auto indices = square_triangles<std::uint32_t>();
    for (std::size_t i = 0; i < indices.size(); i += 3)
        mesh->AddFace({draco::PointIndex(indices[i]), draco::PointIndex(indices[i + 1]),
                       draco::PointIndex(indices[i + 2])});
    return mesh;
}

/// The first primitive of the plain file, packed by Draco with 14 bits for each coordinate.
GltfFile draco_file(int method) {
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*draco_mesh(), &buffer).ok());

    GltfFile file = plain_file();
    file.data = {buffer.data(), buffer.size()};
    json& primitives = file.root["meshes"][0]["primitives"];
    primitives.erase(2);
    primitives.erase(1);
    for (json& accessor : file.root["accessors"]) accessor.erase("bufferView");
    file.root["bufferViews"] = {{{"buffer", 0}, {"byteLength", file.data.size()}}};
    primitives[0]["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", 0}, {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}};
    file.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    return file;
}

using Corner = std::array<int, 7>;  // in tenths, and its colour
using Triangle = std::array<Corner, 3>;

/// The triangles of a scene, turned and sorted: Draco keeps neither order.
std::vector<Triangle> sorted_triangles(const Scene& scene) {
    std::vector<Triangle> sorted;
    for (const uvec3& t : scene.triangles) {
        Triangle triangle;
        for (int c = 0; c < 3; ++c) {
            const dvec3 p = 10.0 * scene.positions[t[c]];
            const auto& color = scene.colors[t[c]];
            for (int k = 0; k < 3; ++k) {
                EXPECT_NEAR(p[k], std::round(p[k]), 10.0 * 11.0 / (1 << 14));
                triangle[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)] =
                    static_cast<int>(std::lround(p[k]));
            }
            std::ranges::copy(color, triangle[static_cast<std::size_t>(c)].begin() + 3);
        }
        std::rotate(triangle.begin(), std::ranges::min_element(triangle), triangle.end());
        sorted.push_back(triangle);
    }
    std::ranges::sort(sorted);
    return sorted;
}

class Draco : public testing::TestWithParam<int> {};

TEST_P(Draco, GivesThePlainTrianglesWithinItsSteps) {
    const TemporaryFolder folder;
    GltfFile plain = plain_file();
    plain.root["meshes"][0]["primitives"].erase(2);
    plain.root["meshes"][0]["primitives"].erase(1);
    const auto expected = sorted_triangles(load_scene(plain.write(folder)));
    const Scene scene = load_scene(draco_file(GetParam()).write(folder));
    EXPECT_EQ(sorted_triangles(scene), expected);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_P(Draco, DamagedDataAreAnErrorOrAnotherScene) {
    EXPECT_GT(damaged_scenes(draco_file(GetParam()), test::kSanitized ? 97 : 13), 0);
}

INSTANTIATE_TEST_SUITE_P(Method, Draco,
                         testing::Values(draco::MESH_SEQUENTIAL_ENCODING,
                                         draco::MESH_EDGEBREAKER_ENCODING),
                         [](const auto& test) { return test.param == 0 ? "Sequential" : "Edges"; });

TEST(DracoFiles, PlainDataBesideArePreferredAsTheyAreExact) {
    const TemporaryFolder folder;
    GltfFile file = plain_file();
    const Scene plain = load_scene(file.write(folder));
    for (json& primitive : file.root["meshes"][0]["primitives"])
        primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 99},
                                                                 {"attributes", {{"POSITION", 0}}}};
    file.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    EXPECT_EQ(load_scene(file.write(folder)).positions, plain.positions);
}

TEST(DracoFiles, OfFourBillionPointsEndInAnError) {
    const TemporaryFolder folder;
    GltfFile file = draco_file(draco::MESH_SEQUENTIAL_ENCODING);
    // After the header of 11 bytes: the numbers of faces and of points, 7 bits to a byte.
    constexpr std::size_t kPointsAt = 13;
    ASSERT_EQ(file.data.substr(11, 4), "\xf2\x01\x90\x01");  // 242, 144
    file.data.replace(kPointsAt, 2, "\xff\xff\xff\xff\x0f");
    file.root["bufferViews"][0]["byteLength"] = file.data.size();
    const Error error = load_error(file.write(folder));
    EXPECT_TRUE(error.code() == Errc::bad_input || error.code() == Errc::limit) << error.what();
}

TEST(DracoFiles, ThatReferToWhatIsNotPackedAreBadInput) {
    const TemporaryFolder folder;
    const auto rejects = [&](const char* what, auto&& change) {
        GltfFile file = draco_file(draco::MESH_EDGEBREAKER_ENCODING);
        json& primitive = file.root["meshes"][0]["primitives"][0];
        change(file, primitive["extensions"]["KHR_draco_mesh_compression"]);
        EXPECT_EQ(load_error(file.write(folder)).code(), Errc::bad_input) << what;
    };
    rejects("view", [](GltfFile&, json& draco) { draco["bufferView"] = 1; });
    rejects("no view", [](GltfFile&, json& draco) { draco.erase("bufferView"); });
    rejects("attribute", [](GltfFile&, json& draco) { draco["attributes"]["COLOR_0"] = 7; });
    rejects("wrong JSON type",
            [](GltfFile&, json& draco) { draco["attributes"]["COLOR_0"] = "b"; });
    rejects("two sources of one accessor", [](GltfFile& file, json&) {
        json& primitives = file.root["meshes"][0]["primitives"];
        file.root["bufferViews"].push_back(file.root["bufferViews"][0]);
        primitives.push_back(primitives[0]);
        primitives[1]["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 1;
    });
}

}  // namespace
}  // namespace octavo
