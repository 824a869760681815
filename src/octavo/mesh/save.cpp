// SPDX-License-Identifier: MIT
#include "octavo/mesh/save.h"

#include "octavo/core/error.h"
#include "octavo/mesh/save_formats.h"

namespace octavo {

void save_scene(const Scene& scene, const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (extension == ".glb") return formats::write_glb(scene, file);
    if (extension == ".obj") return formats::write_obj(scene, file);
    if (extension == ".ply") return formats::write_ply(scene, file);
    throw Error(Errc::unsupported, file, "scenes are written as .glb, .obj or .ply");
}

bool formats::floats_are_exact(const Scene& scene) {
    const auto exact = [](double x) { return static_cast<float>(x) == x || x != x; };
    for (const dvec3& p : scene.positions)
        if (!exact(p.x) || !exact(p.y) || !exact(p.z)) return false;
    return true;
}

}  // namespace octavo
