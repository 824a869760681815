// SPDX-License-Identifier: MIT
#include "octavo/mesh/ply_header.h"

#include "octavo/mesh/line_reader.h"
#include "octavo/mesh/text_cursor.h"

namespace octavo::ply {
namespace {

std::optional<Type> type_of(std::string_view word) {
    // Each type has an old name and one that tells its size.
    struct Name {
        std::string_view old_name, sized_name;
        Type type;
    };
    constexpr Name kNames[] = {
        {"char", "int8", Type::i8},      {"uchar", "uint8", Type::u8},
        {"short", "int16", Type::i16},   {"ushort", "uint16", Type::u16},
        {"int", "int32", Type::i32},     {"uint", "uint32", Type::u32},
        {"float", "float32", Type::f32}, {"double", "float64", Type::f64},
    };
    for (const Name& name : kNames)
        if (word == name.old_name || word == name.sized_name) return name.type;
    return {};
}

Format format_of(std::string_view word, const FileWindow& input) {
    if (word == "ascii") return Format::ascii;
    if (word == "binary_little_endian") return Format::little_endian;
    if (word == "binary_big_endian") return Format::big_endian;
    throw input.error_at(word.data(), "unknown PLY format");
}

Property read_property(TextCursor& words, const FileWindow& input) {
    const auto read_type = [&] {
        const std::string_view word = words.word();
        if (const auto type = type_of(word)) return *type;
        throw input.error_at(word.data(), "unknown property type '" + std::string(word) + "'");
    };
    Property property{};
    TextCursor ahead = words;
    if (ahead.word() == "list") {
        words = ahead;
        const char* where = words.at;
        property.count_type = read_type();
        if (!is_whole(*property.count_type))
            throw input.error_at(where, "the length of a list is not a whole number");
    }
    property.type = read_type();
    property.name = words.word();
    return property;
}

}  // namespace

std::size_t Element::min_bytes(Format format) const {
    std::size_t bytes = 0;
    for (const Property& property : properties) {
        if (format == Format::ascii)
            bytes += 2;  // a digit and what separates it from the next
        else
            bytes += size_of(property.count_type.value_or(property.type));
    }
    return bytes;
}

Header read_header(FileWindow& input) {
    LineReader lines(input);
    std::string_view line;
    if (!lines.next(line) || TextCursor(line).line() != "ply")
        throw input.error_at(std::uint64_t{0}, "is not a PLY file");

    Header header;
    while (lines.next(line)) {
        TextCursor words(TextCursor(line).line());  // without blanks at its ends
        const std::string_view keyword = words.word();
        if (keyword == "end_header") return header;
        if (keyword == "format") {
            header.format = format_of(words.word(), input);
        } else if (keyword == "element") {
            Element element{std::string(words.word()), 0, {}, input.offset_of(keyword.data())};
            words.skip_blanks();
            long long count = 0;
            if (!words.number(count) || count < 0)
                throw input.error_at(words.at, "an element's count is not a number");
            element.count = static_cast<std::uint64_t>(count);
            header.elements.push_back(std::move(element));
        } else if (keyword == "property") {
            if (header.elements.empty())
                throw input.error_at(keyword.data(), "a property before any element");
            header.elements.back().properties.push_back(read_property(words, input));
        }
        // What remains is comment, obj_info and whatever a program added.
    }
    throw input.error_at(input.ahead().data(), "the PLY header has no end");
}

}  // namespace octavo::ply
