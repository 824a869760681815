// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "octavo/io/container.h"

namespace octavo::fuzz {

/// An .octv file taken apart without a check, to be changed and put together again.
struct OctvParts {
    struct Part {
        octv::Section section;
        std::string content;
    };
    std::vector<Part> parts;

    /// Of what is not an .octv file, no parts.
    explicit OctvParts(std::span<const std::uint8_t> file);
    OctvParts() = default;

    [[nodiscard]] Part* find(std::uint32_t id);
    void set(std::uint32_t id, std::uint32_t flags, std::string content);

    /// The file with offsets, sizes and checksums as they should be. A compressed section's raw
    /// size is kept.
    /// @param distort  changes the table before it gets its own checksum; or empty
    [[nodiscard]] std::vector<std::uint8_t> sealed(
        const std::function<void(std::vector<octv::Section>&)>& distort = {}) const;
};

/// Makes the directory's own checksum right.
void seal_directory(std::vector<std::uint8_t>& file);

}  // namespace octavo::fuzz
