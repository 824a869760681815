// SPDX-License-Identifier: MIT
#pragma once

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

namespace octavo {

/// The text without the UTF-8 byte order mark that some editors put in front of it.
inline std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

/// Walks through text, number by number and word by word. Nothing is copied; `at` is always inside
/// the text or at its end, so an error can tell the byte.
struct TextCursor {
    const char* at;
    const char* end;

    explicit TextCursor(std::string_view text) : at(text.data()), end(at + text.size()) {}
    TextCursor(const char* first, const char* last) : at(first), end(last) {}

    [[nodiscard]] bool done() const { return at == end; }

    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
    static bool is_space(char c) { return is_blank(c) || c == '\n' || c == '\v' || c == '\f'; }

    void skip_blanks() {
        while (at != end && is_blank(*at)) ++at;
    }
    void skip_space() {
        while (at != end && is_space(*at)) ++at;
    }

    /// The next word; empty at the end of the text.
    std::string_view word() {
        skip_space();
        const char* first = at;
        while (at != end && !is_space(*at)) ++at;
        return {first, static_cast<std::size_t>(at - first)};
    }

    /// The rest of this line without its end and without blanks around it; moves to the next line.
    std::string_view line() {
        const char* first = at;
        const void* found = at == end ? nullptr : std::memchr(at, '\n', end - at);
        const char* last = found ? static_cast<const char*>(found) : end;
        at = found ? last + 1 : end;
        while (first != last && is_space(*first)) ++first;
        while (first != last && is_space(last[-1])) --last;
        return {first, static_cast<std::size_t>(last - first)};
    }

    /// Reads a number, rounded once. Too large becomes infinity, too small zero, as for strtod;
    /// "nan" and "inf" are numbers, and so are the "1.#IND" and "-1.#INF" of old Microsoft
    /// libraries. Stays where it is and returns false where there is none.
    bool number(double& value) {
        const char* first = at != end && *at == '+' ? at + 1 : at;
        const auto [last, error] = std::from_chars(first, end, value);
        if (error == std::errc::invalid_argument) return false;
        if (error == std::errc::result_out_of_range)
            value = std::strtod(std::string(first, last).c_str(), nullptr);
        at = last;
        if (at != end && *at == '#') microsoft_special(value);
        return true;
    }

    bool number(long long& value) {
        const char* first = at != end && *at == '+' ? at + 1 : at;
        const auto [last, error] = std::from_chars(first, end, value);
        if (error != std::errc()) return false;
        at = last;
        return true;
    }

private:
    void microsoft_special(double& value) {
        const char* first = ++at;
        while (at != end && !is_space(*at)) ++at;
        const bool infinite = std::string_view(first, at - first).starts_with("INF");
        using Limits = std::numeric_limits<double>;
        value = std::copysign(infinite ? Limits::infinity() : Limits::quiet_NaN(), value);
    }
};

}  // namespace octavo
