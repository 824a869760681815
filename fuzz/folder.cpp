// SPDX-License-Identifier: MIT
#include "folder.h"

#include <fstream>

#include "../tests/support/temporary_folder.h"
#include "promise.h"

namespace octavo::fuzz {

namespace fs = std::filesystem;

const fs::path& folder() {
    static const test::TemporaryFolder kFolder(fs::exists("/dev/shm") ? "/dev/shm"
                                                                      : fs::temp_directory_path());
    return kFolder.path();
}

fs::path put(const std::string& name, Bytes bytes) {
    fs::path file = folder() / name;
    std::ofstream stream(file, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    stream.close();
    require(stream.good(), "room for the test itself");
    return file;
}

}  // namespace octavo::fuzz
