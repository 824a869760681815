// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "octavo/core/error.h"
#include "octavo/mesh/load.h"

namespace octavo::test {

/// A folder for one test's files, gone afterwards.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "octavo-mesh-XXXXXX").string();
        if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
        path_ = std::filesystem::canonical(name);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

    std::filesystem::path write(const std::string& name, const std::string& content) const {
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << content;
        return file;
    }

private:
    std::filesystem::path path_;
};

/// The Error that loading this file ends in; fails the test where it loads.
inline Error load_error(const std::filesystem::path& file) {
    try {
        (void)load_scene(file);
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << file << " was loaded";
    return {Errc::cancelled, "no error"};
}

/// The bytes of a number as a little-endian file has them.
template <class T>
std::string raw(T value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

inline bool mentions(const Scene& scene, const std::string& what) {
    for (const std::string& warning : scene.warnings)
        if (warning.find(what) != std::string::npos) return true;
    return false;
}

}  // namespace octavo::test
