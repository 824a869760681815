// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace octavo {

/// Why something failed. The command line turns each into an exit code (see `exit_code`).
enum class Errc {
    bad_argument,  // the caller asked for something that cannot be (a resolution of 1000)
    bad_input,     // a file's content is not what its format says
    io,            // reading or writing failed: missing, no permission, disk full
    limit,         // a stated limit would be passed: memory, node count, file size
    cancelled,     // the caller's progress function asked to stop
    unsupported,   // a valid file or option that this build or version does not handle
};

/// Text on one line, whatever names from files hold: control characters as \xHH.
[[nodiscard]] std::string one_line(std::string_view text);

/// The one exception type of the library. `what()` is one line for a person: what is wrong, where,
/// and where it helps, what to do about it.
class Error : public std::runtime_error {
public:
    Error(Errc code, std::string_view message)
        : std::runtime_error(one_line(message)), code_(code) {}

    /// An error in a file: "PATH: message", or "PATH at byte OFFSET: message".
    Error(Errc code, const std::filesystem::path& file, const std::string& message,
          std::optional<std::uint64_t> offset = {});

    [[nodiscard]] Errc code() const { return code_; }

    /// The file that the error is about, or an empty path.
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }

    /// The byte in that file, where the error has one.
    [[nodiscard]] std::optional<std::uint64_t> offset() const { return offset_; }

private:
    Errc code_;
    std::filesystem::path file_;
    std::optional<std::uint64_t> offset_;
};

/// For system calls that set errno: an `io` Error "PATH: cannot ACTION: <strerror(errno)>".
[[nodiscard]] Error io_error(const std::filesystem::path& file, const std::string& action);

}  // namespace octavo
