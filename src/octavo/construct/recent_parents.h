// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace octavo {

/// Up to four leaves that have the same parent, padded with 0, which no leaf is. Like that they are
/// hashed and compared without a branch on how many there are.
struct Siblings {
    static constexpr int kMost = 4;

    std::array<std::uint64_t, 4> leaves;

    /// The first `count` of four leaves, which can be read.
    static Siblings first_of(const std::uint64_t* leaves, int count) {
        const auto& mask = kFirst[static_cast<unsigned>(count)];
        Siblings siblings;
        for (std::size_t i = 0; i < 4; ++i) siblings.leaves[i] = leaves[i] & mask[i];
        return siblings;
    }

    /// Only its high bits are mixed well.
    [[nodiscard]] std::uint64_t hash(std::uint32_t child_mask) const {
        std::uint64_t sum = child_mask;
        for (std::size_t i = 0; i < 4; i += 2)
            sum += (leaves[i] + kKeys[i]) * (leaves[i + 1] + kKeys[i + 1]);
        return (sum ^ sum >> 32) * kKeys[0];
    }

    friend bool operator==(const Siblings& a, const Siblings& b) {
        std::uint64_t different = 0;
        for (std::size_t i = 0; i < 4; ++i) different |= a.leaves[i] ^ b.leaves[i];
        return different == 0;
    }

private:
    static constexpr std::uint64_t kKeys[4] = {0x9e3779b97f4a7c15u, 0xd6e8feb86659fd93u,
                                               0xc2b2ae3d27d4eb4fu, 0xff51afd7ed558ccdu};
    static constexpr auto kFirst = [] {
        std::array<std::array<std::uint64_t, 4>, 5> masks{};
        for (std::size_t count = 0; count <= 4; ++count)
            for (std::size_t i = 0; i < count; ++i) masks[count][i] = ~std::uint64_t{0};
        return masks;
    }();
};

/// The last parents of up to four leaves that a tile met, found by the leaves themselves: where a
/// surface goes on as it was, most parents have four leaves and come again soon, and then neither
/// they nor their leaves are looked up in a table. Where they do not come again it stops being
/// worth asking, and says so.
class RecentParents {
public:
    /// Forgets all, for another tile.
    void clear() {
        for (Parent& parent : parents_) parent = {};
        credit_ = kFirstCredit;
    }

    [[nodiscard]] bool worth_asking() const { return credit_ > 0; }

    /// Calls make() for the id of a parent that is not among the recent ones.
    template <class Make>
    std::uint32_t find(std::uint32_t child_mask, const Siblings& siblings, const Make& make) {
        const std::size_t place = siblings.hash(child_mask) >> (64 - kBits);
        Parent& parent = parents_[place];
        if (parent.child_mask == child_mask && siblings_[place] == siblings) {
            ++credit_;
            return parent.id;
        }
        --credit_;
        siblings_[place] = siblings;
        parent = {child_mask, make()};
        return parent.id;
    }

private:
    static constexpr int kBits = 7;
    static constexpr std::size_t kCount = std::size_t{1} << kBits;
    // That a parent is found saves about as much as it costs that one is not.
    static constexpr int kFirstCredit = 64;

    struct Parent {
        std::uint32_t child_mask = 0;  // 0: none, as a parent has children
        std::uint32_t id = 0;
    };

    std::array<Siblings, kCount> siblings_;
    std::array<Parent, kCount> parents_;
    int credit_ = kFirstCredit;
};

}  // namespace octavo
