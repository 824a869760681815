// SPDX-License-Identifier: MIT
#include "octavo/core/file_bytes.h"

#include <unistd.h>

#include <cerrno>

#include "octavo/core/input_file.h"

namespace octavo {

FileBytes read_file(const std::filesystem::path& file, std::uint64_t max_bytes) {
    const InputFile input(file);
    if (input.size() > max_bytes)
        throw Error(Errc::limit, file,
                    "has " + std::to_string(input.size()) + " bytes, and at most " +
                        std::to_string(max_bytes) + " are read");
    const auto size = static_cast<std::size_t>(input.size());
    auto data = std::make_unique_for_overwrite<char[]>(size);
    std::size_t done = 0;
    while (done < size) {
        const ssize_t count = ::read(input.descriptor(), data.get() + done, size - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw io_error(file, "read");
        if (count == 0) break;  // it shrank meanwhile
        done += static_cast<std::size_t>(count);
    }
    return {file, std::move(data), done};
}

}  // namespace octavo
