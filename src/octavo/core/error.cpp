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
    return text + ": " + message;
}

}  // namespace

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
