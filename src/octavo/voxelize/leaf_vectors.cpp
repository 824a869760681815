// SPDX-License-Identifier: MIT
#include "octavo/voxelize/leaf_vectors.h"

#include <algorithm>
#include <bit>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octavo/voxelize/leaf_vectors.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 8 lanes: as many bits as a mask is read from at once.
constexpr hn::CappedTag<std::uint64_t, 8> kWords;
constexpr std::size_t kLanes = hn::MaxLanes(kWords);

LeafCounts CountLeaves(std::span<const std::uint64_t> leaves) {
    constexpr hn::Repartition<std::uint8_t, decltype(kWords)> kBytes;
    LeafCounts counts;
    auto voxels = hn::Zero(kWords);
    const auto count = [&](auto some) {
        voxels = hn::Add(voxels, hn::PopulationCount(some));
        const auto bytes = hn::BitCast(kBytes, some);
        counts.children += hn::CountTrue(kBytes, hn::Ne(bytes, hn::Zero(kBytes)));
    };
    std::size_t i = 0;
    for (; i + kLanes <= leaves.size(); i += kLanes) count(hn::LoadU(kWords, leaves.data() + i));
    HWY_ALIGN std::uint64_t last[kLanes] = {};
    std::ranges::copy(leaves.subspan(i), last);
    count(hn::Load(kWords, last));
    counts.voxels = hn::GetLane(hn::SumOfLanes(kWords, voxels));
    return counts;
}

void TakeLeaves(std::span<const std::uint32_t> windows, std::uint64_t* leaves, std::uint64_t* set,
                std::uint64_t* out) {
    constexpr std::uint64_t kAll = (std::uint64_t{1} << kLanes) - 1;
    for (const std::uint32_t window : windows) {
        std::uint64_t* const of_window = leaves + std::size_t{window} * 64;
        for (std::uint64_t rest = std::exchange(set[window], 0); rest != 0;) {
            const auto at = static_cast<unsigned>(std::countr_zero(rest)) / kLanes * kLanes;
            const auto bits = static_cast<std::uint8_t>(rest >> at & kAll);
            rest &= ~(kAll << at);
            const auto some = hn::Load(kWords, of_window + at);
            hn::Store(hn::Zero(kWords), kWords, of_window + at);
            hn::CompressStore(some, hn::LoadMaskBits(kWords, &bits), kWords, out);
            out += std::popcount(bits);
        }
    }
}

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octavo {

HWY_EXPORT(CountLeaves);
HWY_EXPORT(TakeLeaves);

LeafCounts count_leaves(std::span<const std::uint64_t> leaves) {
    return HWY_DYNAMIC_DISPATCH(CountLeaves)(leaves);
}

void take_leaves(std::span<const std::uint32_t> windows, std::uint64_t* leaves, std::uint64_t* set,
                 std::uint64_t* out) {
    HWY_DYNAMIC_DISPATCH(TakeLeaves)(windows, leaves, set, out);
}

}  // namespace octavo
#endif
