// SPDX-License-Identifier: MIT
#include <bit>
#include <limits>

#include "octavo/mesh/output_file.h"
#include "octavo/mesh/save_formats.h"

namespace octavo {
namespace {

static_assert(std::endian::native == std::endian::little, "the files are little-endian");

template <class Real>
void write_vertices(const Scene& scene, OutputFile& out) {
    for (std::size_t i = 0; i < scene.positions.size(); ++i) {
        const glm::vec<3, Real> p(scene.positions[i]);
        out.write_raw(p);
        if (!scene.colors.empty()) out.write_raw(scene.colors[i]);
    }
}

}  // namespace

void formats::write_ply(const Scene& scene, const std::filesystem::path& file) {
    OutputFile out(file);
    const bool floats = floats_are_exact(scene);
    const std::string real = floats ? "float" : "double";
    // Many readers know signed indices only, so they are used while they suffice.
    constexpr std::size_t kMaxSigned = std::numeric_limits<std::int32_t>::max();
    const bool is_signed = scene.positions.size() <= kMaxSigned;

    out.write("ply\nformat binary_little_endian 1.0\n");
    out.write("element vertex " + std::to_string(scene.positions.size()) + "\n");
    for (const char* axis : {"x", "y", "z"}) out.write("property " + real + " " + axis + "\n");
    if (!scene.colors.empty())
        for (const char* channel : {"red", "green", "blue", "alpha"})
            out.write(std::string("property uchar ") + channel + "\n");
    out.write("element face " + std::to_string(scene.triangles.size()) + "\n");
    out.write(is_signed ? "property list uchar int vertex_indices\nend_header\n"
                        : "property list uchar uint vertex_indices\nend_header\n");

    if (floats)
        write_vertices<float>(scene, out);
    else
        write_vertices<double>(scene, out);
    for (const uvec3& triangle : scene.triangles) {
        out.write_raw(std::uint8_t{3});
        out.write_raw(triangle);
    }
    out.commit();
}

}  // namespace octavo
