// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "octavo/core/box.h"
#include "octavo/core/vec.h"
#include "octavo/mesh/bitmap.h"

namespace octavo {

/// A picture that a material refers to: a file, or the encoded bytes that came inside the scene
/// file.
struct Texture {
    /// What is beyond the edges of the picture.
    enum class Wrap : std::uint8_t { repeat, clamp, mirror };

    std::string name;
    std::filesystem::path file;      // absolute, inside the scene file's folder; or empty
    std::vector<std::byte> encoded;  // PNG, JPEG, ... as stored in the scene file; or empty
    Wrap wrap_u = Wrap::repeat;
    Wrap wrap_v = Wrap::repeat;
    std::shared_ptr<const Bitmap> picture = {};  // once decoded, see decode_textures(); or none
};

/// What a surface looks like. Factors are linear; textures multiply them.
struct Material {
    static constexpr int kNoTexture = -1;

    std::string name;
    vec4 base_color{1.0f};  // red, green, blue, alpha
    int base_color_texture = kNoTexture;
    vec3 emission{0.0f};  // radiance: factor times strength
    int emission_texture = kNoTexture;
    std::optional<float> alpha_cutoff;  // below this alpha the surface is a hole; none: opaque
};

/// A perspective camera; world space.
struct Camera {
    std::string name;
    dvec3 eye{0.0};
    dvec3 forward{0.0, 0.0, -1.0};  // unit length
    dvec3 up{0.0, 1.0, 0.0};        // unit length, at right angles to forward
    double vertical_fov = 0.8;      // radians
};

/// A lamp; world space. A disc and a rectangle shine to one side, by the cosine; the triangles of a
/// mesh to both.
struct Light {
    enum class Kind { sun, point, spot, disc, rectangle, mesh };

    std::string name;
    Kind kind = Kind::sun;
    dvec3 position{0.0};              // point, spot; disc, rectangle: the middle
    dvec3 direction{0.0, -1.0, 0.0};  // all but point and mesh: the way the light travels; unit
    vec3 intensity{1.0f};      // sun: irradiance; point, spot: radiant intensity; others: radiance
    double inner_angle = 0.0;  // spot: half angle of the full-bright cone, radians
    double outer_angle = 0.7853981633974483;  // spot: half angle where the light ends

    double size = 0.0;  // sun: angular radius, radians; point, spot, disc: radius; 0: hard shadows
    dvec3 half_u{0.0};  // rectangle: from the middle to the middles of two sides, at right angles
    dvec3 half_v{0.0};  //   to each other and to the direction
    std::vector<std::array<dvec3, 3>> triangles;  // mesh
};

/// Triangles with materials, cameras and lights, whatever file they came from. Node transforms and
/// instances are applied; polygons are triangulated; positions are in world space, in double.
struct Scene {
    static constexpr std::uint32_t kNoMaterial = 0xffffffffu;

    std::vector<dvec3> positions;
    std::vector<uvec3> triangles;  // indices into positions, all in range

    // Each of these is empty, or as long as positions.
    // Texture coordinate (0, 0) is the upper left corner of the picture, as in glTF.
    std::vector<vec2> texture_coordinates;
    std::vector<vec2> emission_coordinates;  // of emission textures; empty: they lie as others do
    std::vector<std::array<std::uint8_t, 4>> colors;  // linear RGBA, multiplies the base colour

    // Empty where no triangle has a material, else as long as triangles.
    std::vector<std::uint32_t> triangle_materials;  // index into materials, or kNoMaterial

    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Camera> cameras;
    std::vector<Light> lights;

    std::vector<std::string> warnings;  // one line each: what the file had that was passed over

    /// The corners of triangle i.
    [[nodiscard]] std::array<dvec3, 3> corners(std::size_t i) const {
        const uvec3& t = triangles[i];
        return {positions[t.x], positions[t.y], positions[t.z]};
    }

    /// The smallest box that holds every triangle whose corners are all finite; other triangles,
    /// and positions that no triangle uses, do not count. Cost: one pass over the triangles,
    /// parallel.
    [[nodiscard]] Box bounds() const;

    /// A 64-bit number that differs, but for chance, where positions or triangles do.
    [[nodiscard]] std::uint64_t geometry_hash() const;
};

}  // namespace octavo
