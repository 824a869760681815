// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/trace/wide.h"

namespace octavo {

/// Shadow rays in groups, say those of a pixel, traced many at a time. Memory stays below some
/// thousand rays, or one group.
class RayQueue {
public:
    RayQueue(const Dag& dag, const shared::Stop& stop) : dag_(dag), stop_(stop) {}

    /// Begins a group. @return its number, from 0
    std::size_t begin_group() {
        if (rays_.size() >= kMostRays) trace();
        seen_.push_back(0);
        return seen_.size() - 1;
    }
    /// Adds a ray to the last group.
    void add(const shared::GridRay& ray) {
        rays_.push_back(ray);
        groups_.push_back(seen_.size() - 1);
    }
    /// Counts `rays` more of the last group as seen, untraced.
    void add_seen(int rays) { seen_.back() += rays; }

    /// Traces what is waiting. Call it before seen().
    void trace() {
        occluded_.resize(rays_.size());
        trace_any_wide(dag_, rays_, stop_, occluded_);
        for (std::size_t i = 0; i < rays_.size(); ++i) seen_[groups_[i]] += 1 - occluded_[i];
        rays_.clear();
        groups_.clear();
    }
    /// How many of the group's rays met nothing.
    [[nodiscard]] int seen(std::size_t group) const { return seen_[group]; }

    /// Forgets all groups.
    void clear() { seen_.clear(); }

private:
    static constexpr std::size_t kMostRays = 8192;

    const Dag& dag_;
    shared::Stop stop_;
    std::vector<shared::GridRay> rays_;
    std::vector<std::size_t> groups_;
    std::vector<std::uint8_t> occluded_;
    std::vector<int> seen_;
};

}  // namespace octavo
