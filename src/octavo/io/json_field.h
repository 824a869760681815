// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "octavo/io/json_value.h"

namespace octavo {

/// A JSON value together with the way to it, so that an error can name the field. All throw Error
/// bad_input: "/objects/2/scale is not a number".
class JsonField {
public:
    /// @param json  is kept by reference
    JsonField(const JsonValue& json, std::string name) : json_(json), name_(std::move(name)) {}

    [[nodiscard]] const std::string& name() const { return name_; }

    // Of an object.
    [[nodiscard]] JsonField operator[](std::string_view key) const;
    [[nodiscard]] bool has(std::string_view key) const { return json_.find(key) != nullptr; }
    /// That it has no keys but these.
    void check_keys(std::initializer_list<std::string_view> known) const;

    // Of an array.
    [[nodiscard]] std::vector<JsonField> items() const;

    [[nodiscard]] const std::string& text() const;
    [[nodiscard]] bool truth() const;
    /// Finite.
    [[nodiscard]] double number() const;
    [[nodiscard]] std::uint64_t count(std::uint64_t max) const;
    /// Three numbers that fit into the vector's.
    template <typename Vector>
    [[nodiscard]] Vector vector() const;

    [[noreturn]] void refuse(const std::string& reason) const;

private:
    const JsonValue& json_;
    std::string name_;
};

}  // namespace octavo
