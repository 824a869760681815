// SPDX-License-Identifier: MIT
#include "octavo/light/gather.h"

#include <algorithm>
#include <numbers>

#include "octavo/light/point_text.h"

namespace octavo {
namespace {

constexpr float kPerPi = std::numbers::inv_pi_v<float>;

// One sequence of random numbers for each purpose.
constexpr std::uint32_t kLampSeed = 0x02e5be93u;
constexpr std::uint32_t kAroundSeed = 0x68bc21ebu;
constexpr std::uint32_t kSkySeed = 0x967a889bu;
constexpr std::uint32_t kEmitterSeed = 0x368cc8b7u;
constexpr std::uint32_t kEmitterChoiceSeed = 0x5bd1e995u;

int round_up(int count, int parts) {
    return (count + parts - 1) / parts * parts;
}

}  // namespace

Gatherer::Gatherer(const LitWorld& world, LightFrom from, const GatherRays& rays, int parts)
    : world_(world), from_(from), rays_(rays), parts_(parts) {
    rays_.lamp = round_up(rays.lamp, parts);
    rays_.around = round_up(rays.around, parts);
    rays_.source = round_up(rays.source, parts);
}

std::size_t Gatherer::begin() {
    if (any_.size() + closest_.size() >= kMostRays) trace();
    sums_.emplace_back(0.0f);
    if (keeps_hits_) kept_.push_back({0, {}, shared::make_miss(0.0f, 0)});
    if (keeps_sides_) kept_sides_.resize(sums_.size() * static_cast<std::size_t>(rays_.around));
    return sums_.size() - 1;
}

void Gatherer::add(const LitPoint& point, int part, std::uint32_t seed, const KeptEnds* kept) {
    if (has(from_, LightFrom::lamps)) add_lamps(point, part, seed);
    if (has(from_, LightFrom::sources)) {
        if (world_.scene().sky.uneven()) add_sky(point, part, seed);
        if (!world_.emitters().empty()) add_emitters(point, part, seed);
    }
    const bool sources = has(from_, LightFrom::sources) &&
                         (!world_.scene().sky.black() || !world_.emitters().empty());
    const bool around = has(from_, LightFrom::cells) || keeps_hits_ || keeps_sides_ || sources;
    if (around) add_around(point, part, seed, kept);
}

void Gatherer::add_lamps(const LitPoint& point, int part, std::uint32_t seed) {
    for (const std::uint32_t n : world_.lamps_near(point.position())) {
        const Lamp& lamp = world_.lamps()[n];
        const SeenLamp seen(lamp, point.start, point.face, point.normal, rays_.hard);
        if (seen.dark()) continue;
        const ivec2 some = share(rays_.lamp, part);
        const float scale = kPerPi / static_cast<float>(rays_.lamp);
        for (int i = some.x; i < some.y; ++i) {
            const shared::LampSample ray = seen.ray(i, seed ^ (kLampSeed + 0x9e3779b9u * n));
            if (!(ray.light > 0.0f)) continue;
            any_rays_.push_back(ray.ray);
            any_.push_back({lamp.light().intensity * (ray.light * scale), 0.0f,
                            static_cast<std::uint32_t>(sums_.size() - 1), 0, 0, kAround, 0});
        }
    }
}

void Gatherer::add_around(const LitPoint& point, int part, std::uint32_t seed,
                          const KeptEnds* kept) {
    const auto sum = static_cast<std::uint32_t>(sums_.size() - 1);
    const ivec2 some = share(rays_.around, part);
    const float count = static_cast<float>(rays_.around);
    for (int i = some.x; i < some.y; ++i) {
        const vec2 square = shared::sample_2d(static_cast<std::uint32_t>(i), seed ^ kAroundSeed);
        shared::GridRay ray = point.start;
        const vec3 direction = shared::cosine_direction(point.normal, square);
        ray.dir = shared::bend_outwards(direction, point.face);
        const auto number = static_cast<std::uint32_t>(i);
        const auto end = kept ? kept->end(number, ray.dir) : KeptEnds::End::unknown;
        if (end == KeptEnds::End::dark) continue;
        if (end == KeptEnds::End::open) {
            if (has(from_, LightFrom::sources))
                closest_.push_back({vec3(1.0f / count) * world_.scene().sky.radiance(ray.dir), 0.0f,
                                    sum, number, kNoRay, kAround, 0});
            continue;
        }
        const float cosine = glm::dot(direction, point.normal);
        closest_.push_back({vec3(1.0f / count), cosine * kPerPi, sum, number,
                            static_cast<std::uint32_t>(closest_rays_.size()), kAround, 0});
        closest_rays_.push_back(ray);
    }
}

void Gatherer::add_sky(const LitPoint& point, int part, std::uint32_t seed) {
    const Sky& sky = world_.scene().sky;
    const ivec2 some = share(rays_.source, part);
    const float count = static_cast<float>(rays_.source);
    const float around = static_cast<float>(rays_.around);
    for (int i = some.x; i < some.y; ++i) {
        const SkySample sample =
            sky.sample(shared::sample_2d(static_cast<std::uint32_t>(i), seed ^ kSkySeed));
        const float cosine = glm::dot(sample.direction, point.normal);
        if (!(cosine > 0.0f) || !(sample.density > 0.0f)) continue;
        shared::GridRay ray = point.start;
        ray.dir = shared::bend_outwards(sample.direction, point.face);
        const float weight = cosine * kPerPi / (count * sample.density + around * cosine * kPerPi);
        any_rays_.push_back(ray);
        any_.push_back({weight * sky.radiance(sample.direction), 0.0f,
                        static_cast<std::uint32_t>(sums_.size() - 1), 0, 0, kAround, 0});
    }
}

void Gatherer::add_emitters(const LitPoint& point, int part, std::uint32_t seed) {
    const ivec2 some = share(rays_.source, part);
    const float count = static_cast<float>(rays_.source);
    const float around = static_cast<float>(rays_.around);
    const dvec3 from = point.position();
    for (int i = some.x; i < some.y; ++i) {
        const auto number = static_cast<std::uint32_t>(i);
        const Emitters::Sample sample =
            world_.emitters().sample(from, shared::sample_1d(number, seed ^ kEmitterChoiceSeed),
                                     shared::sample_2d(number, seed ^ kEmitterSeed));
        const float cosine = glm::dot(sample.direction, point.normal);
        if (!(cosine > 0.0f)) continue;
        shared::GridRay ray = point.start;
        ray.dir = shared::bend_outwards(sample.direction, point.face);
        const float weight = cosine * kPerPi / (count * sample.density + around * cosine * kPerPi);
        closest_.push_back({vec3(weight), 0.0f, static_cast<std::uint32_t>(sums_.size() - 1), 0,
                            static_cast<std::uint32_t>(closest_rays_.size()), sample.object,
                            sample.cell});
        closest_rays_.push_back(ray);
    }
}

vec3 Gatherer::found(const Waiting& w, const shared::GridRay& ray, const InstanceHit& hit) {
    const bool sources = has(from_, LightFrom::sources);
    if (w.emitter_object != kAround) {
        if (!hit || hit.object != w.emitter_object) return vec3(0.0f);
        const CellSide side = world_.side(hit);
        return side.cell == w.emitter_cell ? world_.emission(side) : vec3(0.0f);
    }
    const float around = static_cast<float>(rays_.around);
    const float source = static_cast<float>(rays_.source);
    MetSide* const kept = keeps_sides_
                              ? &kept_sides_[w.sum * static_cast<std::size_t>(rays_.around) + w.ray]
                              : nullptr;
    if (kept) kept->traced = true;
    if (!hit) {
        if (!sources) return vec3(0.0f);
        const Sky& sky = world_.scene().sky;
        float weight = 1.0f;
        if (sky.uneven())
            weight = around * w.density / (around * w.density + source * sky.density(ray.dir));
        return weight * sky.radiance(ray.dir);
    }
    const CellSide side = world_.side(hit);
    if (kept) *kept = {side, -hit.ray.dir, true, true};
    vec3 light(0.0f);
    if (sources) {
        const vec3 emission = world_.emission(side);
        if (emission != vec3(0.0f)) {
            const float density = world_.emitters().density(origin_of(ray), side.object, side.cell);
            light += around * w.density / (around * w.density + source * density) * emission;
        }
    }
    if (has(from_, LightFrom::cells)) light += world_.albedo(side) * world_.stored_light(hit, side);
    return light;
}

void Gatherer::trace() {
    occluded_.resize(any_rays_.size());
    world_.instances().trace_any(any_rays_, {0, 0.0f, 0.0f}, occluded_);
    for (std::size_t i = 0; i < any_.size(); ++i)
        if (occluded_[i] == 0) sums_[any_[i].sum] += any_[i].light;
    hits_.resize(closest_rays_.size());
    world_.instances().trace_closest(closest_rays_, {0, 0.0f, 0.0f}, hits_);
    for (std::size_t i = 0; keeps_hits_ && i < closest_.size(); ++i)
        if (closest_[i].emitter_object == kAround) kept_[closest_[i].sum] = hits_[i];
    for (const Waiting& w : closest_)
        sums_[w.sum] +=
            w.at == kNoRay ? w.light : w.light * found(w, closest_rays_[w.at], hits_[w.at]);
    traced_ += any_rays_.size() + closest_rays_.size();
    any_rays_.clear();
    closest_rays_.clear();
    any_.clear();
    closest_.clear();
}

LampGatherer::LampGatherer(const LitWorld& world, int rays, int parts)
    : world_(world), rays_(round_up(rays, parts)), parts_(parts) {}

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
    for (std::uint32_t k = 0; k < pair.points; ++k) {
        const LitPoint& point = points_[pair.first_point + k];
        const SeenLamp seen(lamp, point.start, point.face, point.normal, false);
        if (seen.dark()) continue;
        const int each = rays / static_cast<int>(pair.points);
        for (int i = static_cast<int>(k) * each; i < (static_cast<int>(k) + 1) * each; ++i) {
            const shared::LampSample ray =
                seen.ray(i, pair.seed ^ (kLampSeed + 0x9e3779b9u * pair.lamp));
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
    world_.instances().trace_any(queue_, {0, 0.0f, 0.0f}, occluded_);
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
