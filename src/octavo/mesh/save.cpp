// SPDX-License-Identifier: MIT
#include "octavo/mesh/save.h"

#include "octavo/core/error.h"
#include "octavo/mesh/exact_math.h"
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
    for (const dvec3& p : scene.positions) {
        const dvec3 rounded = exact::rounded_to_float(p);
        for (int axis = 0; axis < 3; ++axis)
            if (rounded[axis] != p[axis] && p[axis] == p[axis]) return false;  // NaN stays NaN
    }
    return true;
}

}  // namespace octavo
