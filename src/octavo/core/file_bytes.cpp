// SPDX-License-Identifier: MIT
#include "octavo/core/file_bytes.h"

#include "octavo/core/input_file.h"

namespace octavo {

FileBytes read_file(const std::filesystem::path& file, std::uint64_t max_bytes) {
    InputFile input(file);
    if (input.size() > max_bytes)
        throw Error(Errc::limit, file,
                    "has " + std::to_string(input.size()) + " bytes, and at most " +
                        std::to_string(max_bytes) + " are read");
    const auto size = static_cast<std::size_t>(input.size());
    auto data = std::make_unique_for_overwrite<char[]>(size);
    const std::size_t read = input.read(data.get(), size);  // less where it shrank meanwhile
    return {file, std::move(data), read};
}

}  // namespace octavo
