// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "octavo/mesh/gltf_document.h"
#include "octavo/mesh/gltf_materials.h"
#include "octavo/mesh/scene.h"

namespace octavo::gltf {

/// Scale, then a rotation by a unit quaternion (x, y, z, w), then a shift.
[[nodiscard]] dmat4 placement(const dvec4& translation, const dvec4& rotation, const dvec4& scale);

/// Adds meshes of a document to a scene: vertices in world space, triangles and their materials.
///
/// Each is added as often as a node shows it. What cannot be taken becomes a warning.
class GeometryReader {
public:
    /// @param scene       has the document's materials already
    /// @param placements  of each of their textures, from read_materials()
    /// @param max_bytes   of vertices and triangles
    GeometryReader(Document& document, Scene& scene, std::vector<MaterialPlacement> placements,
                   std::set<std::string>& warnings, std::uint64_t max_bytes)
        : document_(document),
          scene_(scene),
          placements_(std::move(placements)),
          warnings_(warnings),
          max_bytes_(max_bytes) {}

    /// @throws Error  limit where a bound is passed; bad_input where the mesh refers to what is
    ///                not there
    void add_mesh(const json& mesh, const dmat4& world);

    /// A mesh at each of the places that EXT_mesh_gpu_instancing lists below a node.
    /// @throws Error  as add_mesh(); bad_input where the lists are not of one length
    void add_instances(const json& mesh, const json& instancing, const dmat4& world);

    /// After the last mesh. @return how many sets of points or lines were passed over
    std::size_t finish();

private:
    /// Position, texture coordinate, emission coordinate and colour accessor, and the material
    /// where it places its textures in a way of its own.
    using VertexKey = std::tuple<std::size_t, std::size_t, std::size_t, std::size_t, std::size_t>;
    using VertexBases = std::map<VertexKey, std::uint32_t>;
    static constexpr std::size_t kNone = ~std::size_t{0};

    void add_primitive(const json& primitive, const dmat4& world, VertexBases& bases);
    void add_triangles(std::size_t mode, std::size_t vertices, const Accessor* indices,
                       std::uint32_t base);
    [[nodiscard]] std::uint32_t material_of(const json& primitive);
    std::uint32_t add_vertices(const Accessor& positions, const VertexKey& key,
                               const MaterialPlacement& placement, const dmat4& world);
    void add_coordinates(const VertexKey& key, const MaterialPlacement& placement,
                         std::size_t base);
    void add_colors(std::size_t accessor, std::size_t base);
    [[nodiscard]] Accessor attribute(std::size_t accessor, std::size_t vertices);
    void take_room(std::uint64_t elements, std::uint64_t bytes_each);
    void warn(const std::string& what) { warnings_.insert(what); }

    Document& document_;
    Scene& scene_;
    std::vector<MaterialPlacement> placements_;
    std::set<std::string>& warnings_;
    std::uint64_t max_bytes_;
    std::uint64_t bytes_ = 0;
    std::size_t other_primitives_ = 0;
    bool any_material_ = false;
};

}  // namespace octavo::gltf
