// SPDX-License-Identifier: MIT
#include "octavo/mesh/save.h"

#include "octavo/core/error.h"
#include "octavo/core/file_name.h"
#include "octavo/mesh/exact_math.h"
#include "octavo/mesh/save_formats.h"

namespace octavo {

namespace {

using Writer = void (*)(const Scene&, const std::filesystem::path&);

/// None for another extension.
Writer writer_of(const std::filesystem::path& file) {
    const std::string extension = lowercase_extension(file);
    if (extension == ".glb") return formats::write_glb;
    if (extension == ".obj") return formats::write_obj;
    if (extension == ".ply") return formats::write_ply;
    return nullptr;
}

}  // namespace

bool can_save_scene(const std::filesystem::path& file) {
    return writer_of(file) != nullptr;
}

void save_scene(const Scene& scene, const std::filesystem::path& file) {
    const Writer write = writer_of(file);
    if (!write) throw Error(Errc::bad_argument, file, "scenes are written as .glb, .obj or .ply");
    write(scene, file);
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
