// SPDX-License-Identifier: MIT
#include "output.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <system_error>

#include "octavo/core/atomic_file.h"
#include "octavo/core/error.h"

namespace octavo::cli {

void secure_standard_streams() {
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
        if (fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
        // The lowest free number is the closed stream's. Open for reading, a write to it fails.
        const int opened = open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
        if (opened < 0) throw io_error("/dev/null", "open");
    }
}

void report_full_disks() {
    // By default a write beyond the limit on file sizes ends the program without a word.
    std::signal(SIGXFSZ, SIG_IGN);
}

void print(std::string_view text) {
    const std::size_t written = std::fwrite(text.data(), 1, text.size(), stdout);
    if (written != text.size() || std::fflush(stdout) != 0)
        throw io_error("standard output", "write");
}

void check_output_name(const std::filesystem::path& name) {
    if (name.empty()) throw Error(Errc::bad_argument, "the name of what to write is empty");
    if (name == "-")
        throw Error(Errc::bad_argument,
                    "'-' is no file: Octavo writes none to a pipe; ./- is the name of one");
}

void check_output(const std::filesystem::path& file, bool force,
                  std::initializer_list<std::filesystem::path> inputs) {
    namespace fs = std::filesystem;
    check_output_name(file);
    std::error_code ignored;
    for (const fs::path& input : inputs)
        if (!input.empty() && fs::equivalent(file, input, ignored))
            throw Error(Errc::bad_argument, file,
                        "cannot write: the result is made from it, and it would be lost");
    if (!force && fs::exists(fs::symlink_status(file, ignored)))
        throw Error(Errc::io, file,
                    "cannot write: it is already there, and --force would replace it");
    const fs::path destination = write_destination(file);
    const fs::file_status status = fs::status(destination, ignored);
    if (fs::exists(status) && !fs::is_regular_file(status))
        throw Error(Errc::io, file, "cannot write: it is not a regular file");
    const fs::path folder = destination.has_parent_path() ? destination.parent_path() : ".";
    if (access(folder.c_str(), W_OK | X_OK) != 0) throw io_error(file, "write");
}

}  // namespace octavo::cli
