// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <iterator>
#include <map>
#include <optional>

namespace octavo::vulkan {

/// Which parts of one block of memory are free. First fit; neighbours that are free become one.
class FreeList {
public:
    explicit FreeList(std::uint64_t size) : size_(size) { free_[0] = size; }

    /// The offset of a free part, a multiple of `alignment`; none where there is no such part.
    std::optional<std::uint64_t> take(std::uint64_t bytes, std::uint64_t alignment) {
        bytes = (bytes + alignment - 1) / alignment * alignment;
        for (auto part = free_.begin(); part != free_.end(); ++part) {
            if (part->second < bytes) continue;
            const std::uint64_t offset = part->first;
            const std::uint64_t rest = part->second - bytes;
            free_.erase(part);
            if (rest > 0) free_[offset + bytes] = rest;
            taken_[offset] = bytes;
            return offset;
        }
        return std::nullopt;
    }

    /// Gives back what take() gave.
    void give_back(std::uint64_t offset) {
        const auto taken = taken_.find(offset);
        auto part = free_.emplace(offset, taken->second).first;
        taken_.erase(taken);
        const auto next = std::next(part);
        if (next != free_.end() && part->first + part->second == next->first) {
            part->second += next->second;
            free_.erase(next);
        }
        if (part == free_.begin()) return;
        const auto before = std::prev(part);
        if (before->first + before->second != part->first) return;
        before->second += part->second;
        free_.erase(part);
    }

    [[nodiscard]] bool all_free() const { return taken_.empty(); }
    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] std::size_t free_parts() const { return free_.size(); }

private:
    std::uint64_t size_;
    std::map<std::uint64_t, std::uint64_t> free_;  // offset -> bytes; offsets are aligned
    std::map<std::uint64_t, std::uint64_t> taken_;
};

}  // namespace octavo::vulkan
