// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octavo/io/model.h"
#include "octavo/io/octv.h"
#include "support/temporary_folder.h"

namespace octavo::test {

inline Model model_of(int depth, std::vector<std::uint64_t> begins,
                      std::vector<std::uint32_t> words) {
    BuildResult built;
    built.dag = Dag(depth, std::move(begins), std::move(words));
    built.grid = {.origin = {-1.0, 0.5, 2.0}, .voxel_size = 0.1, .depth = depth};
    built.triangles = 12;
    built.degenerate_triangles = 2;
    built.non_finite_triangles = 1;
    return make_model("small.obj", {}, VoxelRule::conservative, std::move(built));
}

/// 8^3 voxels: two leaves in opposite corners, of 3 and of 1 voxels. The worked example of
/// docs/file-format.md.
inline Model example_model() {
    return model_of(3, {0, 3, 7}, {0x81, 3, 5, 0x00000013, 0, 0, 0x80000000});
}

/// 16^3 voxels in seven nodes, of which one leaf is shared, with a camera and a light.
inline Model small_model() {
    Model model = model_of(4, {0, 3, 8, 12},
                           {0x81, 3, 6,              // level 0: children 0 and 7
                            0x03, 8, 10, 0x01, 8,    // level 1: two nodes
                            0x13, 0, 0, 0x80000000}  // level 2: two leaves
    );
    model.metadata.cameras.push_back(
        {"front \"A\"", {0.1, 1.0 / 3.0, 5e6}, {0, 0, -1}, {0, 1, 0}, 0.7});
    Light lamp;
    lamp.name = "lamp";
    lamp.kind = Light::Kind::spot;
    lamp.intensity = {0.1f, 2.0f, 3e-9f};
    model.metadata.lights.push_back(lamp);
    return model;
}

/// The bytes of the model's file.
inline std::vector<std::uint8_t> bytes_of(const Model& model, bool compress = false) {
    const TemporaryFolder folder;
    write_octv(folder / "a", model, {.compress = compress});
    const std::string content = file_content(folder / "a");
    return {content.begin(), content.end()};
}

}  // namespace octavo::test
