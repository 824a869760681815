// SPDX-License-Identifier: MIT
#include "octavo/light/gather_lamps.h"

#include <numbers>

namespace octavo {
namespace {

constexpr float kPerPi = std::numbers::inv_pi_v<float>;

}  // namespace

LampGatherer::LampGatherer(const LitWorld& world, int rays, int parts)
    : world_(world), rays_((rays + parts - 1) / parts * parts), parts_(parts) {}

std::size_t LampGatherer::begin() {
    sums_.emplace_back(0.0f);
    first_pair_ = pairs_.size();
    first_point_ = points_.size();
    return sums_.size() - 1;
}

void LampGatherer::add(const LitPoint& point, std::uint32_t seed) {
    points_.push_back(point);
    for (const std::uint32_t lamp : world_.lamps_near(point.position())) {
        std::size_t at = first_pair_;
        while (at < pairs_.size() && pairs_[at].lamp != lamp) ++at;
        if (at == pairs_.size())
            pairs_.push_back({.sum = static_cast<std::uint32_t>(sums_.size() - 1),
                              .lamp = lamp,
                              .first_point = static_cast<std::uint32_t>(first_point_),
                              .points = 0,
                              .seed = seed});
    }
    for (std::size_t at = first_pair_; at < pairs_.size(); ++at)
        pairs_[at].points = static_cast<std::uint32_t>(points_.size() - first_point_);
}

/// Queues the rays of a lamp, as evenly from the points as their number allows.
void LampGatherer::queue(std::uint32_t number, int rays) {
    Pair& pair = pairs_[number];
    const Lamp& lamp = world_.lamps()[pair.lamp];
    pair.sent = pair.seen = 0;
    pair.light = 0.0f;
    pair.few = rays < rays_;
    const float scale = kPerPi / static_cast<float>(rays);
    const std::uint32_t seed = shared::lamp_seed(pair.seed, static_cast<int>(pair.lamp));
    for (std::uint32_t k = 0; k < pair.points; ++k) {
        const LitPoint& point = points_[pair.first_point + k];
        const SeenLamp seen(lamp, point.start, point.face, point.normal, false);
        if (seen.dark()) continue;
        const int each = rays / static_cast<int>(pair.points);
        for (int i = static_cast<int>(k) * each; i < (static_cast<int>(k) + 1) * each; ++i) {
            const shared::LampSample ray = seen.ray(i, seed);
            if (!(ray.light > 0.0f)) continue;
            ++pair.sent;
            queue_.push_back(ray.ray);
            pair_of_.push_back(number);
            light_of_.push_back(ray.light * scale);
        }
    }
}

void LampGatherer::trace_queue() {
    occluded_.resize(queue_.size());
    world_.instances().trace_any(queue_, shared::stop_at_voxels(), occluded_);
    for (std::size_t i = 0; i < queue_.size(); ++i) {
        if (occluded_[i] != 0) continue;
        ++pairs_[pair_of_[i]].seen;
        pairs_[pair_of_[i]].light += light_of_[i];
    }
    traced_ += queue_.size();
    queue_.clear();
    pair_of_.clear();
    light_of_.clear();
}

void LampGatherer::trace() {
    const auto count = static_cast<std::uint32_t>(pairs_.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        const Light::Kind kind = world_.lamps()[pairs_[i].lamp].light().kind;
        const bool all_alike =
            kind == Light::Kind::sun || kind == Light::Kind::point || kind == Light::Kind::spot;
        queue(i, all_alike ? parts_ : rays_);
    }
    trace_queue();
    for (std::uint32_t i = 0; i < count; ++i) {
        const Pair& pair = pairs_[i];
        if (pair.few && pair.seen != 0 && pair.seen != pair.sent) queue(i, rays_);
    }
    trace_queue();
    for (const Pair& pair : pairs_)
        sums_[pair.sum] += pair.light * world_.lamps()[pair.lamp].light().intensity;
}

}  // namespace octavo
