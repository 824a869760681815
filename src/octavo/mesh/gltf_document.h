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
#include "octavo/mesh/gltf_json.h"

namespace octavo::gltf {

/// A glTF or GLB file: its JSON, and its buffers, which are read when they are first asked for.
///
/// Functions throw Error bad_input where the file asks for bytes that it does not have.
class Document {
public:
    /// @param max_bytes  of its buffers together @throws Error limit beyond
    Document(const FileBytes& bytes, std::uint64_t max_bytes);

    [[nodiscard]] const FileBytes& file() const { return file_; }
    [[nodiscard]] const json& root() const { return root_; }

    /// Object `index` of the top-level array `name`.
    [[nodiscard]] const json& object(const char* name, std::size_t index) const;
    /// The length of a top-level array; 0 where there is none.
    [[nodiscard]] std::size_t count(const char* name) const;

    [[nodiscard]] std::span<const std::byte> buffer_view(std::size_t index);
    [[nodiscard]] Accessor accessor(std::size_t index);

private:
    std::span<const std::byte> buffer(std::size_t index);
    void apply_sparse(const json& sparse, Accessor& accessor);

    const FileBytes& file_;
    json root_;
    std::optional<std::span<const std::byte>> glb_chunk_;
    std::map<std::size_t, std::vector<std::byte>> inline_buffers_;
    std::map<std::filesystem::path, FileBytes> buffer_files_;
    std::uint64_t buffer_bytes_left_;
};

}  // namespace octavo::gltf
