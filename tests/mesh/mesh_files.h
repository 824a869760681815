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

/// A texture of grey bytes, as an uncompressed TGA.
inline std::string grey_tga(int width, int height, const std::string& bytes) {
    std::string header("\0\0\3\0\0\0\0\0\0\0\0\0", 12);
    for (const int side : {width, height}) {
        header += static_cast<char>(side & 255);
        header += static_cast<char>(side >> 8);
    }
    return header + std::string("\x08\x20", 2) + bytes;  // 8 bits, the upper row first
}

}  // namespace octavo::test
