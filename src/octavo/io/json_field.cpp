// SPDX-License-Identifier: MIT
#include "octavo/io/json_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "octavo/core/error.h"
#include "octavo/core/vec.h"

namespace octavo {

using Kind = JsonValue::Kind;

void JsonField::refuse(const std::string& reason) const {
    throw Error(Errc::bad_input, (name_.empty() ? "the whole" : name_) + " " + reason);
}

JsonField JsonField::operator[](std::string_view key) const {
    if (json_.kind != Kind::object) refuse("is not an object");
    const JsonValue* const found = json_.find(key);
    const std::string name = name_ + "/" + std::string(key);
    if (found == nullptr) throw Error(Errc::bad_input, name + " is missing");
    return {*found, name};
}

void JsonField::check_keys(std::initializer_list<std::string_view> known) const {
    if (json_.kind != Kind::object) refuse("is not an object");
    for (const JsonValue& item : json_.items)
        if (std::ranges::find(known, item.key) == known.end())
            throw Error(Errc::bad_input, name_ + "/" + item.key + " is not a key that is known");
}

std::vector<JsonField> JsonField::items() const {
    if (json_.kind != Kind::array) refuse("is not an array");
    std::vector<JsonField> fields;
    for (std::size_t i = 0; i < json_.items.size(); ++i)
        fields.emplace_back(json_.items[i], name_ + "/" + std::to_string(i));
    return fields;
}

const std::string& JsonField::text() const {
    if (json_.kind != Kind::text) refuse("is not a text");
    return json_.text;
}

bool JsonField::truth() const {
    if (json_.kind != Kind::boolean) refuse("is not true or false");
    return json_.truth;
}

double JsonField::number() const {
    if (json_.kind != Kind::number && json_.kind != Kind::count) refuse("is not a number");
    if (!std::isfinite(json_.number)) refuse("is not finite");
    return json_.number;
}

std::uint64_t JsonField::count(std::uint64_t max) const {
    if (json_.kind != Kind::count) refuse("is not a count");
    if (json_.count > max)
        refuse("is " + std::to_string(json_.count) + "; at most " + std::to_string(max) +
               " is possible");
    return json_.count;
}

template <typename Vector>
Vector JsonField::vector() const {
    using Number = typename Vector::value_type;
    const std::vector<JsonField> parts = items();
    if (parts.size() != 3) refuse("does not have three numbers");
    Vector vector;
    for (int i = 0; i < 3; ++i) {
        const double number = parts[static_cast<std::size_t>(i)].number();
        if (std::abs(number) > static_cast<double>(std::numeric_limits<Number>::max()))
            parts[static_cast<std::size_t>(i)].refuse("is too large");
        vector[i] = static_cast<Number>(number);
    }
    return vector;
}
template vec3 JsonField::vector<vec3>() const;
template dvec3 JsonField::vector<dvec3>() const;

}  // namespace octavo
