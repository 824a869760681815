// SPDX-License-Identifier: MIT
#include "scene_input.h"

#include <filesystem>
#include <string_view>

#include "octavo/mesh/decode_textures.h"
#include "octavo/mesh/load.h"
#include "octavo/mesh/samples.h"

namespace octavo::cli {
namespace {

constexpr std::string_view kSamplePrefix = "sample:";

}  // namespace

Scene read_scene(const std::string& input) {
    Scene scene = input.starts_with(kSamplePrefix) ? make_sample(input.substr(kSamplePrefix.size()))
                                                   : load_scene(input);
    decode_textures(scene, WantedTextures::cut_outs);
    return scene;
}

std::string source_name(const std::string& input) {
    if (input.starts_with(kSamplePrefix)) return input;
    return std::filesystem::path(input).filename().string();
}

}  // namespace octavo::cli
