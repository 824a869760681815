// SPDX-License-Identifier: MIT
#include "octavo/core/error.h"

#include <cerrno>
#include <system_error>

namespace octavo {
namespace {

std::string located(const std::filesystem::path& file, std::optional<std::uint64_t> offset,
                    const std::string& message) {
    std::string text = file.string();
    if (offset) text += " at byte " + std::to_string(*offset);
    return one_line(text + ": " + message);
}

}  // namespace

std::string one_line(std::string_view text) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string line;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x20 && byte != 0x7f) {
            line += c;
        } else {
            line += "\\x";
            line += kDigits[byte >> 4];
            line += kDigits[byte & 15u];
        }
    }
    return line;
}

Error::Error(Errc code, const std::filesystem::path& file, const std::string& message,
             std::optional<std::uint64_t> offset)
    : std::runtime_error(located(file, offset, message)),
      code_(code),
      file_(file),
      offset_(offset) {}

Error io_error(const std::filesystem::path& file, const std::string& action) {
    const std::error_code reason(errno, std::generic_category());
    return {Errc::io, file, "cannot " + action + ": " + reason.message()};
}

}  // namespace octavo
