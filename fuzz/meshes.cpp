// SPDX-License-Identifier: MIT
// Any bytes give a scene whose parts fit together, and which can be built, or an Error.
#include <array>
#include <cstring>
#include <filesystem>
#include <string>

#include "folder.h"
#include "octavo/construct/build.h"
#include "octavo/mesh/load.h"
#include "promise.h"

namespace octavo::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxBytes = std::uint64_t{64} << 20;

void check_and_build(const Scene& scene) {
    const std::size_t vertices = scene.positions.size();
    require(!scene.triangles.empty(), "a scene has triangles");
    for (const uvec3& t : scene.triangles)
        require(t.x < vertices && t.y < vertices && t.z < vertices, "vertices exist");
    require(scene.colors.empty() || scene.colors.size() == vertices, "a colour for each vertex");
    for (const Material& material : scene.materials) {
        const auto textures = static_cast<int>(scene.textures.size());
        require(material.base_color_texture < textures && material.emission_texture < textures,
                "textures exist");
    }
    for (const Texture& texture : scene.textures)
        require(texture.file.empty() || texture.file.string().starts_with(folder().string() + "/"),
                "textures are inside the scene's folder");
    if (scene.triangles.size() > 2000) return;
    BuildOptions options;
    options.depth = 5;
    options.threads = 1;
    try {
        const BuildResult built = build(scene, options);
        require(built.dag.depth() == 5, "a build has the depth that was asked for");
    } catch (const Error& error) {
        require(error.code() == Errc::bad_input || error.code() == Errc::bad_argument ||
                    error.code() == Errc::limit,
                "a scene is built or refused");
    }
}

void load(const fs::path& file, double max_seconds = 20.0) {
    try {
        check_and_build(load_scene(file, {.max_bytes = kMaxBytes, .max_seconds = max_seconds}));
    } catch (const Error& error) {
        require_one_line(error);
    }
}

}  // namespace

void run_gltf(Bytes bytes) {
    const bool binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
    load(put(binary ? "a.glb" : "a.gltf", bytes));
}

void run_obj(Bytes bytes) {
    static constexpr std::string_view kSeparator = "\n#mtl\n";
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t at = text.find(kSeparator);
    const std::size_t end = at == std::string_view::npos ? text.size() : at;
    put("a.mtl", bytes.subspan(std::min(bytes.size(), end + kSeparator.size())));
    load(put("a.obj", bytes.first(end)));
}

void run_ply(Bytes bytes) {
    load(put("a.ply", bytes));
}

void run_stl(Bytes bytes) {
    load(put("a.stl", bytes));
}

void run_gzip(Bytes bytes) {
    load(put("a.ply.gz", bytes));
}

void run_assimp(Bytes bytes) {
    static constexpr std::array<const char*, 12> kNames = {"a.off", "a.dae", "a.3ds", "a.fbx",
                                                           "a.x3d", "a.lwo", "a.ac",  "a.ms3d",
                                                           "a.dxf", "a.x",   "a.md2", "a.blend"};
    if (bytes.empty()) return;
    // Small files are read in milliseconds; a loop that does not end is to be found soon.
    load(put(kNames[bytes[0] % kNames.size()], bytes.subspan(1)), 4.0);
}

}  // namespace octavo::fuzz
