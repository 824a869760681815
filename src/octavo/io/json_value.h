// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace octavo {

/// A value of JSON text. Unlike the library's tree it takes no memory while it is destroyed, where
/// nothing could be thrown, and many keys in one object cost no more than as many values elsewhere.
struct JsonValue {
    enum class Kind { null, boolean, count, number, text, array, object };

    Kind kind = Kind::null;
    bool truth = false;       // of a boolean
    std::uint64_t count = 0;  // a whole number of 0 or more
    double number = 0.0;      // that, or any other
    std::string text = {};
    std::string key = {};               // in an object
    std::vector<JsonValue> items = {};  // of an array or an object

    /// The last entry of an object with this key; null where there is none.
    [[nodiscard]] const JsonValue* find(std::string_view name) const;
};

struct JsonLimits {
    std::size_t max_nesting = 8;
    std::size_t max_values = 1'000'000;
};

/// @throws Error bad_input  saying at which byte it is not JSON, or which limit it passes
[[nodiscard]] JsonValue parse_json(std::string_view text, const JsonLimits& limits = {});

/// A number or a text as JSON. What is not UTF-8 becomes U+FFFD.
void append_json(std::string& out, double number);
void append_json(std::string& out, std::string_view text);

}  // namespace octavo
