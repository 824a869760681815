// SPDX-License-Identifier: MIT
// Writes seeds into FOLDER/HARNESS/: usage: fuzz_seeds FOLDER [ODD_MESHES]
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "harness.h"
#include "octavo/io/metadata.h"
#include "octavo/io/octv.h"
#include "octavo/mesh/samples.h"
#include "octavo/mesh/save.h"
#include "octavo/render/render.h"

namespace fs = std::filesystem;
using namespace octavo;

namespace {

void write(const fs::path& file, const void* data, std::size_t size) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary)
        .write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

void write(const fs::path& file, const std::string& text) {
    write(file, text.data(), text.size());
}

std::string content(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

Scene small_scene() {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    scene.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}};
    scene.materials.resize(2);
    scene.materials[0].emission = vec3(2.0f);
    scene.triangle_materials = {0, 1, 0};
    scene.cameras.resize(1);
    scene.lights.resize(1);
    return scene;
}

void write_octv_seeds(const fs::path& folder) {
    for (std::uint32_t seed = 0; seed < 24; ++seed) {
        const auto file = fuzz::random_octv(seed, true);
        write(folder / "octv" / ("random" + std::to_string(seed)), file.data(), file.size());
    }
    const auto full = fuzz::full_octv(13);
    write(folder / "octv" / "full13", full.data(), full.size());
    const Scene scene = small_scene();
    BuildOptions options;
    options.depth = 6;
    const Model model = make_model("a", scene, VoxelRule::conservative, build(scene, options));
    write_octv(folder / "octv" / "built", model);
    write_octv(folder / "octv" / "compressed", model, {.compress = true});
    write(folder / "metadata" / "a", encode_metadata(model.metadata));
}

void write_mesh_seeds(const fs::path& folder) {
    const Scene scene = small_scene();
    for (const char* kind : {"glb", "obj", "ply"}) {
        const std::string harness = std::string(kind) == "glb" ? "gltf" : kind;
        fs::create_directories(folder / harness);
        save_scene(scene, folder / harness / (std::string("ours.") + kind));
    }
    write(folder / "obj" / "library",
          "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nusemtl m\nf 1/1 -2/1 3/1\n#mtl\n"
          "newmtl m\nKd 1 0 .5\nd 0.5\nmap_Kd -s 1 1 1 a.png\nKe 3\n");
    write(folder / "stl" / "ascii",
          "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
          "endloop\nendfacet\nendsolid a\n");
    const auto off = std::string("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    write(folder / "assimp" / "off", std::string(1, '\0') + off);
    for (const char* text : {"4K", "1.5GiB", "1,-2,3.5", "0,10,0,0,-1,0", "1280x720", "131072"})
        write(folder / "arguments" / std::to_string(std::hash<std::string>{}(text)), text);
}

void write_scene_seeds(const fs::path& folder) {
    write(folder / "scene" / "a",
          R"({"objects":[{"file":"a.octv"},{"name":"b","file":"b.octv","position":[1,2,3],)"
          R"("rotation":{"axis":[0,1,1],"degrees":30},"scale":0.5}],)"
          R"("lights":["sun:30,40","point:1,2,3:power=2"],"sky":"clear",)"
          R"("camera":{"eye":[3,4,5],"at":[0,0,0],"fov":50}})");
    write(folder / "path" / "a",
          R"({"frames":12,"closed":true,"up":[0,1,0],"cameras":[{"eye":[1,2,3],"at":[0,0,0]},)"
          R"({"eye":[3,2,1],"at":[0,0.5,0],"fov":60},{"eye":[-3,2,1],"at":[0,0,1]}]})");
    int number = 0;
    for (const char* text :
         {"sun:30,40:size=2", "point:1,2,3:color=1,0.5,0", "spot:1,2,3:to=0,0,0:angle=20:power=3",
          "disc:1,5,1:to=1,0,1:size=0.5", "rectangle:1,5,1:to=1,0,1:size=2x0.5", "scene=a", "none",
          "clear:power=2", "color:1,2,3", "gradient:zenith=0,0,1:horizon=1,1,1:ground=0.1,0.1,0.1"})
        write(folder / "lights" / std::to_string(number++), text);
    write(
        folder / "sky_image" / "flat.hdr",
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n") + std::string(24, '\x80'));
    write(folder / "sky_image" / "runs.hdr",
          std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\x02\x02") +
              std::string("\0\x08\x88\x10\x88\x20\x88\x30\x88\x80", 10));
    write_exr(folder / "sky_image" / "a.exr", Image(4, 2));
}

/// Files that have broken other readers, to the harness of their kind.
void copy_odd_meshes(const fs::path& from, const fs::path& folder) {
    static const std::map<std::string, std::pair<std::string, int>> kHarnesses = {
        {".obj", {"obj", -1}},   {".ply", {"ply", -1}},   {".stl", {"stl", -1}},
        {".gltf", {"gltf", -1}}, {".glb", {"gltf", -1}},  {".gz", {"gzip", -1}},
        {".off", {"assimp", 0}}, {".dae", {"assimp", 1}}, {".3ds", {"assimp", 2}},
        {".dxf", {"assimp", 8}}, {".x", {"assimp", 9}}};
    constexpr std::uintmax_t kLargest = 100'000;
    for (const auto& entry : fs::recursive_directory_iterator(from)) {
        if (!entry.is_regular_file() || entry.file_size() > kLargest) continue;
        std::string extension = entry.path().extension().string();
        std::ranges::transform(extension, extension.begin(),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        const auto found = kHarnesses.find(extension);
        if (found == kHarnesses.end()) continue;
        const auto& [harness, kind] = found->second;
        std::string bytes = content(entry.path());
        if (kind >= 0) bytes.insert(bytes.begin(), static_cast<char>(kind));
        write(folder / harness / entry.path().filename(), bytes);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return 2;
    write_octv_seeds(argv[1]);
    write_mesh_seeds(argv[1]);
    write_scene_seeds(argv[1]);
    if (argc > 2 && fs::is_directory(argv[2])) copy_odd_meshes(argv[2], argv[1]);
}
