// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "octavo/core/file_bytes.h"
#include "octavo/mesh/gltf_accessor.h"

namespace draco {
class Mesh;
}

namespace octavo::gltf {

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// The mesh that a bufferView of KHR_draco_mesh_compression holds.
///
/// The library was not made for data that mean harm: use it only in a process of its own, see
/// read_in_child(). Functions throw Error bad_input where the data are damaged.
class DracoMesh {
public:
    DracoMesh(std::span<const std::byte> packed, const FileBytes& file);

    /// Three vertices for each triangle. They may not exist: the reader of triangles looks.
    [[nodiscard]] Accessor triangles() const;

    /// One element for each vertex. @param id  which of the attributes
    /// @param normalized  as the accessor that it stands for says
    [[nodiscard]] Accessor attribute(std::uint32_t id, bool normalized) const;

private:
    const FileBytes& file_;
    std::shared_ptr<const draco::Mesh> mesh_;
};

}  // namespace octavo::gltf
