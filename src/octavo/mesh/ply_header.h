// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "octavo/mesh/file_window.h"

namespace octavo::ply {

enum class Format { ascii, little_endian, big_endian };

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };

[[nodiscard]] constexpr std::size_t size_of(Type type) {
    constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[static_cast<int>(type)];
}

[[nodiscard]] constexpr bool is_whole(Type type) {
    return type != Type::f32 && type != Type::f64;
}

struct Property {
    std::string name;
    Type type;
    std::optional<Type> count_type;  // of a list: the type of its length
};

struct Element {
    std::string name;
    std::uint64_t count;
    std::vector<Property> properties;
    std::uint64_t where;  // in the file: its line in the header

    /// The fewest bytes that one of these can take in a file.
    [[nodiscard]] std::size_t min_bytes(Format format) const;
};

/// What a PLY file says about itself before its data.
struct Header {
    Format format = Format::ascii;
    std::vector<Element> elements;
};

/// Reads what is ahead of the window up to the data, which are then ahead.
/// @throws Error bad_input, with the byte
[[nodiscard]] Header read_header(FileWindow& input);

}  // namespace octavo::ply
