// SPDX-License-Identifier: MIT
#include "octavo/core/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "octavo/core/error.h"

namespace octavo {
namespace {

// Without O_NONBLOCK, opening a named pipe would wait for a writer for ever.
int open_to_read(const std::filesystem::path& path) {
    if (path.empty()) throw Error(Errc::bad_argument, "the name of a file to read is empty");
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) throw io_error(path, "read");
    return descriptor;
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path)
    : path_(path), descriptor_(open_to_read(path)) {
    struct stat status {};
    const bool known = fstat(descriptor_, &status) == 0;
    if (known && S_ISREG(status.st_mode)) {
        size_ = static_cast<std::uint64_t>(status.st_size);
        return;
    }
    const Error error = known
                            ? Error(Errc::bad_input, path, "cannot read: it is not a regular file")
                            : io_error(path, "read");
    close(descriptor_);
    throw error;
}

InputFile::~InputFile() {
    close(descriptor_);
}

std::size_t InputFile::read(char* out, std::size_t size) {
    std::size_t done = 0;
    while (done < size) {
        const ssize_t count = ::read(descriptor_, out + done, size - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw io_error(path_, "read");
        if (count == 0) break;
        done += static_cast<std::size_t>(count);
    }
    return done;
}

}  // namespace octavo
