// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <string>

#include "octavo/core/error.h"
#include "octavo/mesh/load.h"
#include "support/temporary_folder.h"

namespace octavo::test {

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
