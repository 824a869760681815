// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/trace/wide.h"

namespace octavo {

/// Shadow rays in groups, say those of a pixel, traced many at a time. Each brings some light, 1
/// unless it is said, which adds up over the group's rays that meet nothing. Memory stays below
/// some thousand rays, or one group.
class RayQueue {
public:
    /// @param partitions, walk  as of trace_any_wide()
    RayQueue(const Dag& dag, const shared::Stop& stop, Partitions* partitions = nullptr,
             WideWalk walk = WideWalk::by_size)
        : dag_(dag), stop_(stop), partitions_(partitions), walk_(walk) {}

    /// Begins a group. @return its number, from 0
    std::size_t begin_group() {
        if (rays_.size() >= kMostRays) trace();
        seen_.push_back(0.0f);
        return seen_.size() - 1;
    }
    /// Adds a ray to the last group.
    void add(const shared::GridRay& ray, float light = 1.0f) {
        rays_.push_back(ray);
        light_.push_back(light);
        groups_.push_back(seen_.size() - 1);
    }
    /// Adds light to the last group, without a ray that something could be in the way of.
    void add_seen(float light) { seen_.back() += light; }

    /// Traces what is waiting. Call it before seen().
    void trace() {
        occluded_.resize(rays_.size());
        trace_any_wide(dag_, rays_, stop_, occluded_, partitions_, walk_);
        for (std::size_t i = 0; i < rays_.size(); ++i)
            if (occluded_[i] == 0) seen_[groups_[i]] += light_[i];
        rays_.clear();
        light_.clear();
        groups_.clear();
    }
    /// The light of the group's rays that met nothing; without light given, their number.
    [[nodiscard]] float seen(std::size_t group) const { return seen_[group]; }

    /// Forgets all groups.
    void clear() { seen_.clear(); }

private:
    static constexpr std::size_t kMostRays = 8192;

    const Dag& dag_;
    shared::Stop stop_;
    Partitions* partitions_;
    WideWalk walk_;
    std::vector<shared::GridRay> rays_;
    std::vector<float> light_;
    std::vector<std::size_t> groups_;
    std::vector<std::uint8_t> occluded_;
    std::vector<float> seen_;
};

}  // namespace octavo
