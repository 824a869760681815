// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "octavo/core/error.h"

namespace octavo {

/// One thing that is wrong with a file. The codes are part of the interface: docs/file-format.md
/// has the list, and a code keeps its meaning.
struct Finding {
    std::string code;                     // "pointer-outside"
    std::optional<std::uint64_t> offset;  // of the byte in the file
    std::string message;                  // one line for a person, without file and offset
};

/// An Error about the content of an .octv file that `octavo validate` has a code for.
class FormatError : public Error {
public:
    FormatError(Errc errc, std::string_view code, const std::filesystem::path& path,
                const std::string& message, std::optional<std::uint64_t> offset)
        : Error(errc, path, message, offset), finding_{std::string(code), offset, message} {}

    [[nodiscard]] const Finding& finding() const { return finding_; }

private:
    Finding finding_;
};

/// What an Error says, as a finding. One without a code of its own, as readers of single sections
/// throw, gets `content`, `unsupported` or `limit`.
[[nodiscard]] Finding finding_of(const Error& error);

}  // namespace octavo
