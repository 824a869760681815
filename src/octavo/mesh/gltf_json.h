// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "octavo/core/vec.h"

/// Parts of glTF's JSON by key, as the format words them.
namespace octavo::gltf {

using json = nlohmann::json;

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
