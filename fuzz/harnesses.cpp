// SPDX-License-Identifier: MIT
#include <array>

#include "harness.h"

namespace octavo::fuzz {

std::span<const Harness> harnesses() {
    static constexpr std::array<Harness, 13> kAll = {{{"octv", run_octv},
                                                      {"metadata", run_metadata},
                                                      {"gltf", run_gltf},
                                                      {"obj", run_obj},
                                                      {"ply", run_ply},
                                                      {"stl", run_stl},
                                                      {"gzip", run_gzip},
                                                      {"assimp", run_assimp},
                                                      {"arguments", run_arguments},
                                                      {"lights", run_lights},
                                                      {"scene", run_scene},
                                                      {"path", run_path},
                                                      {"sky_image", run_sky_image}}};
    return kAll;
}

}  // namespace octavo::fuzz
