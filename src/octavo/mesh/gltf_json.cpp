// SPDX-License-Identifier: MIT
#include "octavo/mesh/gltf_json.h"

#include <cmath>

namespace octavo::gltf {
namespace {

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+') return 62;
    return c == '/' ? 63 : -1;
}

}  // namespace

std::size_t as_whole(const json& value) {
    const double number = value.get<double>();
    if (!(number >= 0.0 && number <= 0x1p53 && number == std::floor(number)))
        throw json::other_error::create(500, "an index or a size is not a whole number", nullptr);
    return static_cast<std::size_t>(number);
}

std::optional<std::size_t> whole(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) return {};
    return as_whole(*found);
}

const json* child(const json& object, const char* key) {
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

const json* extension(const json& object, const char* name) {
    const json* extensions = child(object, "extensions");
    return extensions && extensions->is_object() ? child(*extensions, name) : nullptr;
}

dvec4 numbers(const json& object, const char* key, const dvec4& fallback) {
    const json* array = child(object, key);
    if (!array) return fallback;
    dvec4 value = fallback;
    for (std::size_t i = 0; i < array->size() && i < 4; ++i)
        value[static_cast<int>(i)] = array->at(i).get<double>();
    return value;
}

std::optional<std::vector<std::byte>> data_uri(std::string_view uri) {
    if (!uri.starts_with("data:")) return {};
    const std::size_t comma = uri.find(',');
    std::vector<std::byte> bytes;
    if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) return bytes;
    std::uint32_t bits = 0;
    int have = 0;
    bytes.reserve((uri.size() - comma) / 4 * 3);
    for (const char c : uri.substr(comma + 1)) {
        const int digit = base64_digit(c);
        if (digit < 0) break;  // the padding
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        have += 6;
        if (have >= 8) {
            have -= 8;
            bytes.push_back(static_cast<std::byte>(bits >> have & 0xff));
        }
    }
    return bytes;
}

}  // namespace octavo::gltf
