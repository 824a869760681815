// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "octavo/mesh/file_window.h"
#include "octavo/mesh/ply_header.h"
#include "octavo/mesh/word_reader.h"

/// The data of a PLY file as a row of numbers: the same calls for text and for both byte orders.
namespace octavo::ply {

/// A number that stands for an index or a length. @throws Error bad_input at `where`
[[nodiscard]] inline std::int64_t to_integer(double number, const FileWindow& input,
                                             const char* where) {
    if (!(std::abs(number) < 0x1p53)) throw input.error_at(where, "is not an index");
    return static_cast<std::int64_t>(number);
}

/// Line ends are blanks like others: some writers break long lists.
class TextValues {
public:
    explicit TextValues(FileWindow& input) : input_(input), words_(input) {}

    double real(Type) {
        find();
        double value = 0.0;
        if (!words_.text.number(value)) throw missing();
        return value;
    }

    std::int64_t integer(Type) {
        find();
        TextCursor& text = words_.text;
        long long value = 0;
        if (text.number(value) && (text.done() || TextCursor::is_space(*text.at))) return value;
        text.at = latest_;  // "3.0"
        return to_integer(real(Type::f64), input_, latest_);
    }

    void skip(std::uint64_t count, Type type) {
        for (; count > 0; --count) real(type);
    }

    /// As FileWindow has them, and one more: the last number needs nothing after it.
    [[nodiscard]] std::uint64_t most_ahead() const { return input_.most_ahead() - read() + 1; }
    [[nodiscard]] std::uint64_t expected_ahead() const {
        return input_.expected_ahead() - read() + 1;
    }

    /// Where the last number begins.
    [[nodiscard]] const char* latest() const { return latest_; }

private:
    void find() {
        if (!words_.find()) throw missing();
        latest_ = words_.text.at;
    }
    /// Bytes that the window has not passed yet.
    [[nodiscard]] std::uint64_t read() const {
        return static_cast<std::uint64_t>(words_.text.at - input_.ahead().data());
    }
    [[nodiscard]] Error missing() const {
        return input_.error_at(words_.text.at, words_.text.done() ? "the file ends too early"
                                                                  : "a number was expected here");
    }

    FileWindow& input_;
    WordReader words_;
    const char* latest_ = nullptr;
};

template <std::endian kOrder>
class BinaryValues {
public:
    explicit BinaryValues(FileWindow& input) : input_(input) {}

    double real(Type type) {
        switch (type) {
            case Type::f32:
                return take<float>();
            case Type::f64:
                return take<double>();
            default:
                return static_cast<double>(integer(type));
        }
    }

    std::int64_t integer(Type type) {
        switch (type) {
            case Type::i8:
                return take<std::int8_t>();
            case Type::u8:
                return take<std::uint8_t>();
            case Type::i16:
                return take<std::int16_t>();
            case Type::u16:
                return take<std::uint16_t>();
            case Type::i32:
                return take<std::int32_t>();
            case Type::u32:
                return take<std::uint32_t>();
            default:
                return to_integer(real(type), input_, latest_);
        }
    }

    void skip(std::uint64_t count, Type type) {
        const std::uint64_t where = input_.offset_of(input_.ahead().data());
        if (count > input_.most_ahead() / size_of(type) || !input_.skip(count * size_of(type)))
            throw input_.error_at(where, "the file ends too early");
    }

    [[nodiscard]] std::uint64_t most_ahead() const { return input_.most_ahead(); }
    [[nodiscard]] std::uint64_t expected_ahead() const { return input_.expected_ahead(); }
    [[nodiscard]] const char* latest() const { return latest_; }

private:
    template <class T>
    T take() {
        latest_ = input_.take(sizeof(T));
        if (latest_ == nullptr)
            throw input_.error_at(input_.ahead().data(), "the file ends too early");
        std::array<char, sizeof(T)> raw;
        std::memcpy(raw.data(), latest_, sizeof(T));
        if constexpr (kOrder != std::endian::native) std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }

    FileWindow& input_;
    const char* latest_ = nullptr;
};

}  // namespace octavo::ply
