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
constexpr std::string_view kMergedPrefix = "merged-";
constexpr const char* kLockName = "lock";

/// Everything that a build puts into its scratch folder; whatever else is there is left alone.
bool is_ours(const std::string& name) {
    constexpr std::array<std::string_view, 7> kTemporary = {"ids",   "piece", "ranks",    "order",
                                                            "words", "lock",  "triangles"};
    return name.starts_with(kPartPrefix) || name.starts_with(kMergedPrefix) ||
           std::ranges::find(kTemporary, name) != kTemporary.end();
}

std::string digits(std::uint64_t tile) {
    std::string text = std::to_string(tile);
    text.insert(0, 10 - std::min<std::size_t>(10, text.size()), '0');
    return text;
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

Scratch::Scratch(std::filesystem::path folder, std::uint64_t key, int top)
    : folder_(std::move(folder)), key_(key), top_(top) {}

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
    lock_ = std::make_unique<Lock>(folder_ / kLockName);
}

std::vector<std::unique_ptr<PartFile>> Scratch::take_parts() {
    std::vector<std::unique_ptr<PartFile>> parts;
    std::error_code ignored;
    if (!available() || !std::filesystem::is_directory(folder_, ignored)) return parts;
    open();
    std::vector<std::filesystem::path> others;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
        const std::string name = entry.path().filename().string();
        if (name == kLockName || !is_ours(name)) continue;
        auto part = name.starts_with(kPartPrefix) ? PartFile::open(entry.path(), key_, top_)
                                                  : nullptr;
        if (part) {
            parts.push_back(std::move(part));
        } else {
            others.push_back(entry.path());
        }
    }
    std::ranges::sort(parts, [](const auto& a, const auto& b) {
        return std::pair(a->state().first_tile, b->state().end_tile) <
               std::pair(b->state().first_tile, a->state().end_tile);
    });
    std::uint64_t end = 0;
    std::erase_if(parts, [&](const auto& part) {
        const PartState& state = part->state();
        const bool keep = state.first_tile >= end && state.end_tile > state.first_tile;
        if (keep) end = state.end_tile;
        if (!keep) others.push_back(part->file().path());
        return !keep;
    });
    for (const std::filesystem::path& other : others) std::filesystem::remove(other, ignored);
    return parts;
}

std::unique_ptr<PartFile> Scratch::make_part(std::uint64_t first_tile) {
    open();
    return PartFile::create(folder_ / (std::string(kPartPrefix) + digits(first_tile)), key_, top_);
}

std::unique_ptr<PartFile> Scratch::make_merged_part(std::uint64_t first_tile,
                                                    std::uint64_t end_tile) {
    open();
    const std::string name =
        std::string(kMergedPrefix) + digits(first_tile) + "-" + digits(end_tile);
    return PartFile::create(folder_ / name, key_, top_);
}

void Scratch::remove() noexcept {
    if (!lock_) return;
    delete_scratch(folder_);
    lock_.reset();
}

void delete_scratch(const std::filesystem::path& folder) noexcept {
    std::error_code ignored;  // what stays is overwritten by the next build
    std::vector<std::filesystem::path> ours;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
        if (is_ours(entry.path().filename().string())) ours.push_back(entry.path());
    for (const std::filesystem::path& path : ours) std::filesystem::remove(path, ignored);
    std::filesystem::remove(folder, ignored);  // unless there is something else in it
}

}  // namespace octavo
