// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace octavo::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// Each takes any bytes, and ends the process where a promise is broken. An Error is no breach.
void run_octv(Bytes bytes);      // an .octv file: read, validated, then traced and rendered
void run_metadata(Bytes bytes);  // the JSON in it
void run_gltf(Bytes bytes);      // glTF or GLB
void run_obj(Bytes bytes);       // OBJ; what follows "\n#mtl\n" is its material library
void run_ply(Bytes bytes);
void run_stl(Bytes bytes);
void run_gzip(Bytes bytes);       // whatever is in it
void run_assimp(Bytes bytes);     // first byte: which format; the library in its process
void run_arguments(Bytes bytes);  // numbers of the command line
void run_lights(Bytes bytes);     // --light and --sky of the command line
void run_scene(Bytes bytes);      // a scene file, beside two models: a.octv and b.octv
void run_path(Bytes bytes);       // a camera path
void run_sky_image(Bytes bytes);  // a picture of the sky, OpenEXR or Radiance

struct Harness {
    const char* name;
    void (*run)(Bytes);
};
[[nodiscard]] std::span<const Harness> harnesses();

/// Another .octv file from this one: words, JSON, table or sizes changed, then laid out and sealed
/// so that all checksums are right. `mutate_bytes` changes bytes blindly in place, and returns how
/// many there are afterwards, at most as many as there is room for.
[[nodiscard]] std::vector<std::uint8_t> mutate_octv(Bytes file, std::uint32_t seed,
                                                    std::size_t (*mutate_bytes)(std::uint8_t* bytes,
                                                                                std::size_t size,
                                                                                std::size_t room));

/// A DAG whose nodes and pointers are all sound and otherwise random, with metadata that fits: what
/// a validator must accept and every operation must bear.
/// @param truthful  false: the counts in the metadata are random as well
[[nodiscard]] std::vector<std::uint8_t> random_octv(std::uint32_t seed, bool truthful);

/// The file that 330 bytes of words make: one full node a level, 2^(3 depth) voxels.
/// @param attribute_level  above 0: its cells are all black, which takes 4 bytes for each 256
/// @param compress         the attributes
[[nodiscard]] std::vector<std::uint8_t> full_octv(int depth, int attribute_level = 0,
                                                  bool compress = false);

}  // namespace octavo::fuzz
