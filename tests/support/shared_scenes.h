// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace octavo::test {

/// The folder of real scenes: $OCTAVO_SCENES, or ../shared/scenes beside the project.
inline std::filesystem::path shared_scenes() {
    if (const char* folder = std::getenv("OCTAVO_SCENES")) return folder;
    return std::filesystem::path(OCTAVO_SOURCE_DIR) / ".." / "shared" / "scenes";
}

}  // namespace octavo::test

/// Skips the test, visibly, where this file of the real scenes is missing.
#define OCTAVO_REQUIRE_SCENE(file)                                                    \
    do {                                                                              \
        if (!std::filesystem::exists(octavo::test::shared_scenes() / (file)))         \
            GTEST_SKIP() << (file) << " is not in " << octavo::test::shared_scenes(); \
    } while (false)
