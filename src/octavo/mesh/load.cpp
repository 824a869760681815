// SPDX-License-Identifier: MIT
#include "octavo/mesh/load.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <string>

#include "octavo/core/file_name.h"
#include "octavo/core/memory.h"
#include "octavo/mesh/child_process.h"
#include "octavo/mesh/formats.h"

namespace octavo {
namespace fs = std::filesystem;

namespace {

/// ".ply" for "scan.PLY" and "scan.ply.gz".
std::string format_extension(const fs::path& file) {
    const std::string extension = lowercase_extension(file);
    return extension == ".gz" ? lowercase_extension(file.stem()) : extension;
}

// Two formats say what they are, whatever the file is called.
bool is_glb(std::string_view bytes) {
    return bytes.starts_with("glTF");
}
bool is_ply(std::string_view bytes) {
    return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

/// Text of two bytes a character, as some editors save it, has none of the words that a reader
/// knows.
void refuse_utf16(std::string_view bytes, const fs::path& file) {
    if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
        throw Error(Errc::unsupported, file, "is UTF-16 text: save it as UTF-8");
}

Scene read_format(FileWindow& input, const LoadLimits& limits) {
    const fs::path& file = input.file();
    const std::string extension = format_extension(file);
    const std::string_view start = input.ahead();
    if (is_glb(start) || extension == ".gltf" || extension == ".glb") {
        refuse_utf16(start, file);
        return formats::read_gltf(input.take_all(), limits.max_bytes, limits.max_seconds);
    }
    if (is_ply(start) || extension == ".ply") return formats::read_ply(input);
    if (extension == ".obj") {
        refuse_utf16(start, file);
        return formats::read_obj(input);
    }
    if (extension == ".stl") return formats::read_stl(input);
    if (formats::assimp_knows(file))
        return read_in_child(
            file, [&file] { return formats::read_with_assimp(file); }, limits.max_bytes,
            limits.max_seconds);
    throw Error(
        Errc::unsupported, file,
        "no reader knows this kind of file: take glTF, GLB, OBJ, PLY, STL, or another format "
        "of triangles that assimp reads");
}

Scene read(const fs::path& file, const LoadLimits& limits) {
    FileWindow input(file, limits.max_bytes);
    try {
        Scene scene = read_format(input, limits);
        input.finish();
        return scene;
    } catch (const Error& error) {
        // Where gzip data is damaged, that is what is wrong, and not what a reader makes of it.
        if (error.code() == Errc::bad_input) input.finish();
        throw;
    }
}

/// What every reader promises; a mistake in one must not become a crash in a later room.
void check(const Scene& scene, const fs::path& file) {
    if (scene.triangles.empty()) {
        if (!scene.positions.empty()) throw formats::only_points_or_lines(file);
        throw Error(Errc::bad_input, file, "has no triangles");
    }
    const std::size_t count = scene.positions.size();
    const auto in_range = [count](const uvec3& t) {
        return t.x < count && t.y < count && t.z < count;
    };
    if (!std::all_of(scene.triangles.begin(), scene.triangles.end(), in_range))
        throw Error(Errc::bad_input, file, "a triangle refers to a vertex that does not exist");
    const auto one_each = [](const auto& values, std::size_t expected) {
        return values.empty() || values.size() == expected;
    };
    const auto known = [&](std::uint32_t m) {
        return m == Scene::kNoMaterial || m < scene.materials.size();
    };
    if (!one_each(scene.texture_coordinates, count) ||
        !one_each(scene.emission_coordinates, scene.texture_coordinates.size()) ||
        !one_each(scene.colors, count) ||
        !one_each(scene.triangle_materials, scene.triangles.size()) ||
        !std::ranges::all_of(scene.triangle_materials, known))
        throw Error(Errc::bad_input, file, "a vertex or triangle refers to what does not exist");
    const Box bounds = scene.bounds();
    if (bounds.empty())
        throw Error(Errc::bad_input, file, "no triangle has corners that are all numbers");
    const dvec3 size = bounds.size();
    if (!std::isfinite(size.x) || !std::isfinite(size.y) || !std::isfinite(size.z))
        throw Error(Errc::bad_input, file, "its coordinates are too large: they reach too far");
}

}  // namespace

Scene load_scene(const fs::path& file, const LoadLimits& given) {
    LoadLimits limits = given;
    if (limits.max_bytes == 0) limits.max_bytes = machine_memory_bytes() / 2;
    try {
        Scene scene = read(file, limits);
        check(scene, file);
        return scene;
    } catch (const std::bad_alloc&) {
        throw Error(Errc::limit, file, "does not fit into memory");
    } catch (const std::length_error&) {
        throw Error(Errc::limit, file, "does not fit into memory");
    } catch (const fs::filesystem_error& error) {
        throw Error(Errc::io, file, error.code().message());
    }
}

}  // namespace octavo
