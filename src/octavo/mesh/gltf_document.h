// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "octavo/core/file_bytes.h"
#include "octavo/core/vec.h"

namespace octavo::gltf {

using json = nlohmann::json;

/// The numbers of an accessor, read one at a time where they lie. All bounds were checked when it
/// was made, so reading below `count` cannot fail.
class Accessor {
public:
    std::size_t count = 0;
    int components = 1;  // 1 to 4; matrices are not read

    /// Element i, normalized where the accessor says so; components that it does not have are 0.
    [[nodiscard]] dvec4 real(std::size_t i) const;
    /// Element i of an accessor of unsigned integers.
    [[nodiscard]] std::uint32_t index(std::size_t i) const;

private:
    friend class Document;
    const std::byte* data_ = nullptr;
    std::size_t stride_ = 0;
    int component_type_ = 0;
    bool normalized_ = false;
    std::shared_ptr<std::vector<std::byte>> patched_;  // of a sparse accessor: a packed copy
};

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
    void apply_sparse(const json& sparse, std::size_t element_size, Accessor& accessor);

    const FileBytes& file_;
    json root_;
    std::optional<std::span<const std::byte>> glb_chunk_;
    std::map<std::size_t, std::vector<std::byte>> inline_buffers_;
    std::map<std::filesystem::path, FileBytes> buffer_files_;
    std::uint64_t buffer_bytes_left_;
};

/// A whole number at this key: none where the key is absent. @throws json::exception where it is
/// not one from 0 to 2^53
[[nodiscard]] std::optional<std::size_t> whole(const json& object, const char* key);

/// The whole number that a value is. @throws json::exception as above
[[nodiscard]] std::size_t as_whole(const json& value);

/// The value at a key, or the fallback where the key is absent. @throws json::exception
template <class T>
[[nodiscard]] T value_or(const json& object, const char* key, T fallback) {
    const auto found = object.find(key);
    return found == object.end() ? fallback : found->template get<T>();
}

/// The object at a key, or none.
[[nodiscard]] const json* child(const json& object, const char* key);
/// The object of an extension, or none.
[[nodiscard]] const json* extension(const json& object, const char* name);

/// Up to four numbers of an array. @throws json::exception
[[nodiscard]] dvec4 numbers(const json& object, const char* key, const dvec4& fallback);

/// The bytes of a "data:" URI; none where the URI is of another kind.
[[nodiscard]] std::optional<std::vector<std::byte>> data_uri(std::string_view uri);

}  // namespace octavo::gltf
