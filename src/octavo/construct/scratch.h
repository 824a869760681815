// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "octavo/construct/part_file.h"

namespace octavo {

/// The folder in which a build keeps what it has done and what has no room in memory: a lock, and
/// a file for each part. Made when something is first put there. Files with other names than a
/// build gives are left alone.
class Scratch {
public:
    enum class Use {
        alone,   // whoever opens it second gets an error
        shared,  // with a process that has it alone, and which alone takes and removes parts
    };

    /// Nothing is made or touched yet.
    /// @param folder  may be missing; the folder that it is in is there. Empty: none at all
    Scratch(std::filesystem::path folder, std::uint64_t key, int top, Use use = Use::alone);
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    [[nodiscard]] bool available() const { return !folder_.empty(); }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    [[nodiscard]] std::uint64_t key() const { return key_; }
    [[nodiscard]] int top() const { return top_; }

    /// Makes and locks the folder, if that has not been done.
    /// @throws Error io, as when another build has locked it
    void open();

    /// The parts that an earlier build with the same key left, in the order of their tiles and
    /// without overlap; deletes whatever else a build left.
    /// @throws Error io, as when another build has locked it
    [[nodiscard]] std::vector<std::unique_ptr<PartFile>> take_parts();

    /// For what parts are merged into: a temporary file. @throws Error io
    [[nodiscard]] std::unique_ptr<PartFile> make_merged_part() const;

    /// Deletes the folder, whether this build has made it or an earlier one.
    void remove() noexcept;

private:
    class Lock;

    std::filesystem::path folder_;
    std::uint64_t key_;
    int top_;
    Use use_;
    std::unique_ptr<Lock> lock_;
};

/// The parts in a folder that have this key, in the order of their tiles and without overlap; and
/// the names of a build's other files. Nothing where there is no such folder. @throws Error io
struct FoundParts {
    std::vector<std::unique_ptr<PartFile>> parts;
    std::vector<std::filesystem::path> others;
};
[[nodiscard]] FoundParts find_parts(const std::filesystem::path& folder, std::uint64_t key,
                                    int top);

/// Where a part belongs.
[[nodiscard]] std::filesystem::path part_path(const std::filesystem::path& folder,
                                              std::uint64_t first_tile);

/// Begins the names of the folders in a scratch folder that a forecast has for itself.
inline constexpr const char* kEstimatePrefix = "estimate-";

/// Deletes a scratch folder that nobody uses, as far as a build made what is in it.
void delete_scratch(const std::filesystem::path& folder) noexcept;

}  // namespace octavo
