// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "octavo/construct/part_file.h"

namespace octavo {

/// The folder in which a build keeps what it has done and what has no room in memory: a lock, and
/// a file for each part. Made when something is first put there. Files with other names than a build
/// gives are left alone.
class Scratch {
public:
    /// Nothing is made or touched yet.
    /// @param folder  may be missing; the folder that it is in is there. Empty: none at all
    Scratch(std::filesystem::path folder, std::uint64_t key, int top);
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    [[nodiscard]] bool available() const { return !folder_.empty(); }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

    /// Makes and locks the folder, if that has not been done.
    /// @throws Error io, as when another build has locked it
    void open();

    /// The parts that an earlier build with the same key left, in the order of their tiles and
    /// without overlap; deletes whatever else a build left.
    /// @throws Error io, as when another build has locked it
    [[nodiscard]] std::vector<std::unique_ptr<PartFile>> take_parts();

    /// A new part. @throws Error io
    [[nodiscard]] std::unique_ptr<PartFile> make_part(std::uint64_t first_tile);

    /// For what parts are merged into; an earlier build's are not taken up again. @throws Error io
    [[nodiscard]] std::unique_ptr<PartFile> make_merged_part(std::uint64_t first_tile,
                                                             std::uint64_t end_tile);

    /// Deletes the folder, whether this build has made it or an earlier one.
    void remove() noexcept;

private:
    class Lock;

    std::filesystem::path folder_;
    std::uint64_t key_;
    int top_;
    std::unique_ptr<Lock> lock_;
};

/// Deletes a scratch folder that nobody uses, as far as a build made what is in it.
void delete_scratch(const std::filesystem::path& folder) noexcept;

}  // namespace octavo
