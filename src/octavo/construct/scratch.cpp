// SPDX-License-Identifier: MIT
#include "octavo/construct/scratch.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "octavo/core/error.h"

namespace octavo {
namespace {

constexpr std::string_view kPartPrefix = "part-";
constexpr const char* kLockName = "lock";

/// Everything that a build puts into its scratch folder; whatever else is there is left alone.
bool is_ours(const std::string& name) {
    constexpr std::array<std::string_view, 10> kPrefixes = {
        kEstimatePrefix, kPartPrefix, "ids-",       "piece-",  "ranks-",
        "order-",        "words-",    "triangles-", "merged-", "received-"};
    if (name == kLockName) return true;
    return std::ranges::any_of(kPrefixes, [&](auto prefix) { return name.starts_with(prefix); });
}

/// A file or, with what is in it, a folder of a forecast.
void remove_ours(const std::filesystem::path& path) noexcept {
    std::error_code ignored;  // what stays is overwritten by the next build
    if (std::filesystem::is_directory(path, ignored))
        delete_scratch(path);
    else
        std::filesystem::remove(path, ignored);
}

}  // namespace

/// Held as long as the file is open, and let go of by the system when the process ends.
class Scratch::Lock {
public:
    explicit Lock(const std::filesystem::path& path) {
        descriptor_ = ::open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
        if (descriptor_ < 0) throw io_error(path, "make this file");
        if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
        ::close(descriptor_);
        throw Error(Errc::io, path.parent_path(), "another build uses this scratch folder");
    }
    ~Lock() { ::close(descriptor_); }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

private:
    int descriptor_ = -1;
};

Scratch::Scratch(std::filesystem::path folder, std::uint64_t key, int top, Use use)
    : folder_(std::move(folder)), key_(key), top_(top), use_(use) {}

Scratch::~Scratch() {
    if (!lock_) return;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder_, ignored))
        if (entry.path().filename().string().starts_with(kPartPrefix)) return;
    remove();  // nothing in it from which a build could go on
}

void Scratch::open() {
    if (lock_) return;
    std::error_code error;
    std::filesystem::create_directory(folder_, error);
    if (error) throw Error(Errc::io, folder_, "cannot make this folder: " + error.message());
    if (use_ == Use::alone) lock_ = std::make_unique<Lock>(folder_ / kLockName);
}

std::vector<std::unique_ptr<PartFile>> Scratch::take_parts() {
    std::error_code ignored;
    if (!available() || !std::filesystem::is_directory(folder_, ignored)) return {};
    open();
    FoundParts found = find_parts(folder_, key_, top_);
    for (const std::filesystem::path& other : found.others) remove_ours(other);
    return std::move(found.parts);
}

std::unique_ptr<PartFile> Scratch::make_merged_part() const {
    return PartFile::create(folder_ / "merged", key_, top_, SpillFile::Kind::temporary);
}

FoundParts find_parts(const std::filesystem::path& folder, std::uint64_t key, int top) {
    FoundParts found;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name == kLockName || !is_ours(name)) continue;
        auto part =
            name.starts_with(kPartPrefix) ? PartFile::open(entry.path(), key, top) : nullptr;
        if (part) {
            found.parts.push_back(std::move(part));
        } else {
            found.others.push_back(entry.path());
        }
    }
    std::ranges::sort(found.parts, {}, [](const auto& part) { return part->state().first_tile; });
    std::uint64_t end = 0;
    std::erase_if(found.parts, [&](const auto& part) {
        const PartState& state = part->state();
        const bool keep = state.first_tile >= end && state.end_tile > state.first_tile;
        if (keep) end = state.end_tile;
        if (!keep) found.others.push_back(part->file().path());
        return !keep;
    });
    return found;
}

std::filesystem::path part_path(const std::filesystem::path& folder, std::uint64_t first_tile) {
    std::string digits = std::to_string(first_tile);
    digits.insert(0, 10 - std::min<std::size_t>(10, digits.size()), '0');
    return folder / (std::string(kPartPrefix) + digits);
}

void Scratch::remove() noexcept {
    if (!lock_) return;
    delete_scratch(folder_);
    lock_.reset();
}

void delete_scratch(const std::filesystem::path& folder) noexcept {
    std::error_code ignored;
    std::vector<std::filesystem::path> ours;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
        if (is_ours(entry.path().filename().string())) ours.push_back(entry.path());
    for (const std::filesystem::path& path : ours) remove_ours(path);
    std::filesystem::remove(folder, ignored);  // unless there is something else in it
}

}  // namespace octavo
