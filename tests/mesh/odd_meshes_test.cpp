// SPDX-License-Identifier: MIT
//
// Files that have broken other readers. Each must load or end in an Error; the table says which.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <vector>

#include "mesh/mesh_files.h"
#include "support/shared_scenes.h"

namespace octavo {
namespace {

namespace fs = std::filesystem;

TEST(OddMeshes, LoadOrEndInAnError) {
    OCTAVO_REQUIRE_SCENE("odd-meshes");
    const fs::path folder = test::shared_scenes() / "odd-meshes";
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());

    std::map<std::string, int> outcomes;
    for (const fs::path& file : files) {
        std::string outcome;
        try {
            const Scene scene = load_scene(file);
            outcome = std::to_string(scene.triangles.size()) + " triangles";
            if (!scene.warnings.empty())
                outcome += ", " + std::to_string(scene.warnings.size()) + " warnings";
            ++outcomes["loaded"];
        } catch (const Error& error) {
            outcome = error.what();
            const std::string prefix = file.string();
            if (outcome.starts_with(prefix)) outcome.erase(0, prefix.size());
            ++outcomes[error.code() == Errc::unsupported ? "unsupported" : "rejected"];
        }
        std::cout << "  " << fs::relative(file, folder).string() << ": " << outcome << "\n";
    }
    for (const auto& [outcome, count] : outcomes) std::cout << outcome << ": " << count << "\n";
    EXPECT_GE(outcomes["loaded"], 120);
}

TEST(OddMeshes, GiveTheTrianglesThatTheirTextSays) {
    OCTAVO_REQUIRE_SCENE("odd-meshes");
    const fs::path folder = test::shared_scenes() / "odd-meshes";
    const std::pair<const char*, std::size_t> kExpected[] = {
        {"tinyobj/cornell_box.obj", 36},    {"tinyobj/cube.obj", 12},
        {"tinyobj/issue-330.obj", 3},       {"trimesh/negative_indices.obj", 12},
        {"trimesh/nancolor.obj", 12},       {"trimesh/unit_cube.STL", 12},
        {"trimesh/BoxInterleaved.glb", 12}, {"trimesh/Duck.glb", 4212},
        {"trimesh/multibody.stl", 32},      {"trimesh/whitespace.off", 12},
        {"trimesh/sphere.ply", 1280},       {"trimesh/no_indices_3storybuilding.glb", 72},
    };
    for (const auto& [name, triangles] : kExpected)
        EXPECT_EQ(load_scene(folder / name).triangles.size(), triangles) << name;
    for (const char* empty :
         {"trimesh/empty.obj", "trimesh/empty.ply", "trimesh/empty.stl", "trimesh/points_bin.ply",
          "tinyobj/line-prim.obj", "tinyobj/invalid-relative-vertex-index.obj",
          "trimesh/empty_nodes.glb"})
        EXPECT_EQ(test::load_error(folder / empty).code(), Errc::bad_input) << empty;
}

}  // namespace
}  // namespace octavo
