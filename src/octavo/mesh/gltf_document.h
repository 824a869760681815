// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "octavo/core/file_bytes.h"
#include "octavo/mesh/gltf_accessor.h"
#include "octavo/mesh/gltf_draco.h"
#include "octavo/mesh/gltf_json.h"

namespace octavo::gltf {

/// A glTF or GLB file: its JSON, and its buffers, which are read, and unpacked where they are
/// packed, when they are first asked for.
///
/// Functions throw Error bad_input where the file asks for bytes that it does not have.
class Document {
public:
    /// @param max_bytes  of its buffers together, unpacked @throws Error limit beyond
    Document(const FileBytes& bytes, std::uint64_t max_bytes);

    [[nodiscard]] const FileBytes& file() const { return file_; }
    [[nodiscard]] const json& root() const { return root_; }

    /// Object `index` of the top-level array `name`.
    [[nodiscard]] const json& object(const char* name, std::size_t index) const;
    /// The length of a top-level array; 0 where there is none.
    [[nodiscard]] std::size_t count(const char* name) const;

    /// Whether the file says that it uses this extension, or that it needs it.
    [[nodiscard]] bool names(const std::string& extension) const;

    [[nodiscard]] std::span<const std::byte> buffer_view(std::size_t index);
    [[nodiscard]] Accessor accessor(std::size_t index);

    /// The triangles of a primitive that Draco has packed; from now on its accessors read what was
    /// packed with them. None where the primitive is not packed, or has plain data beside.
    /// May crash: only in a process of its own, see read_in_child().
    [[nodiscard]] std::optional<Accessor> unpack_draco(const json& primitive);

private:
    struct DracoAttribute {
        std::size_t view;
        std::uint32_t id;
        friend bool operator==(const DracoAttribute&, const DracoAttribute&) = default;
    };

    std::span<const std::byte> buffer(std::size_t index);
    std::span<const std::byte> part(const json& view, const std::string& whose);
    void apply_sparse(const json& sparse, Accessor& accessor);

    const FileBytes& file_;
    json root_;
    std::optional<std::span<const std::byte>> glb_chunk_;
    std::map<std::size_t, std::vector<std::byte>> inline_buffers_;
    std::map<std::filesystem::path, FileBytes> buffer_files_;
    std::map<std::size_t, std::vector<std::byte>> unpacked_views_;
    std::map<std::size_t, DracoMesh> draco_meshes_;           // by bufferView
    std::map<std::size_t, DracoAttribute> draco_attributes_;  // by accessor
    std::uint64_t buffer_bytes_left_;
};

}  // namespace octavo::gltf
