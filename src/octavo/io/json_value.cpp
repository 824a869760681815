// SPDX-License-Identifier: MIT
#include "octavo/io/json_value.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "octavo/core/error.h"

namespace octavo {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& reason) {
    throw Error(Errc::bad_input, reason);
}

/// Builds a tree from what the library's parser meets. Whatever is open is the last item of what it
/// is in, so nothing that the stack points to moves.
class Builder {
public:
    explicit Builder(const JsonLimits& limits) : limits_(limits) {}
    [[nodiscard]] JsonValue take() { return std::move(root_); }

    bool null() {
        add(JsonValue::Kind::null);
        return true;
    }
    bool boolean(bool truth) {
        add(JsonValue::Kind::boolean).truth = truth;
        return true;
    }
    bool number_integer(std::int64_t number) {
        add(JsonValue::Kind::number).number = static_cast<double>(number);
        return true;
    }
    bool number_unsigned(std::uint64_t number) {
        JsonValue& value = add(JsonValue::Kind::count);
        value.count = number;
        value.number = static_cast<double>(number);
        return true;
    }
    bool number_float(double number, const std::string&) {
        add(JsonValue::Kind::number).number = number;
        return true;
    }
    bool string(std::string& text) {
        add(JsonValue::Kind::text).text = std::move(text);
        return true;
    }
    bool binary(Json::binary_t&) { return false; }  // not in text
    bool start_object(std::size_t) { return open(JsonValue::Kind::object); }
    bool start_array(std::size_t) { return open(JsonValue::Kind::array); }
    bool end_object() { return close(); }
    bool end_array() { return close(); }
    bool key(std::string& name) {
        key_ = std::move(name);
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const Json::exception& error) {
        if (const auto* at = dynamic_cast<const Json::parse_error*>(&error))
            refuse("not JSON at its byte " + std::to_string(at->byte));
        refuse("not JSON: a number is out of range");
    }

private:
    JsonValue& add(JsonValue::Kind kind) {
        if (++values_ > limits_.max_values) refuse("the JSON has too many values");
        JsonValue& value = open_.empty() ? root_ : open_.back()->items.emplace_back();
        value.kind = kind;
        value.key = std::exchange(key_, {});
        return value;
    }
    bool open(JsonValue::Kind kind) {
        if (open_.size() >= limits_.max_nesting) refuse("the JSON is nested too deep");
        open_.push_back(&add(kind));
        return true;
    }
    bool close() {
        open_.pop_back();
        return true;
    }

    JsonLimits limits_;
    std::size_t values_ = 0;
    JsonValue root_;
    std::vector<JsonValue*> open_;
    std::string key_;
};

}  // namespace

const JsonValue* JsonValue::find(std::string_view name) const {
    const auto found = std::find_if(items.rbegin(), items.rend(),
                                    [&](const JsonValue& item) { return item.key == name; });
    return kind != Kind::object || found == items.rend() ? nullptr : &*found;
}

JsonValue parse_json(std::string_view text, const JsonLimits& limits) {
    Builder builder(limits);
    Json::sax_parse(text.begin(), text.end(), &builder);
    return builder.take();
}

// Of a single value the library destroys nothing but itself.
void append_json(std::string& out, double number) {
    out += Json(number).dump();
}
void append_json(std::string& out, std::string_view text) {
    out += Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace octavo
