// SPDX-License-Identifier: MIT
#include "octavo/light/gather.h"

#include <algorithm>
#include <numbers>

#include "octavo/light/point_text.h"

namespace octavo {
namespace {

constexpr float kPerPi = std::numbers::inv_pi_v<float>;

// One sequence of random numbers for each purpose, beside shared::lamp_seed() and
// shared::hemisphere_seed().
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
    if (to_light_.size() + looking_.size() >= kMostRays) trace();
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
            const shared::LampSample ray =
                seen.ray(i, shared::lamp_seed(seed, static_cast<int>(n)));
            if (!(ray.light > 0.0f)) continue;
            any_rays_.push_back(ray.ray);
            to_light_.push_back({lamp.light().intensity * (ray.light * scale), last_sum()});
        }
    }
}

void Gatherer::add_around(const LitPoint& point, int part, std::uint32_t seed,
                          const KeptEnds* kept) {
    const ivec2 some = share(rays_.around, part);
    const vec3 factor(1.0f / static_cast<float>(rays_.around));
    for (int i = some.x; i < some.y; ++i) {
        const auto number = static_cast<std::uint32_t>(i);
        const vec2 square = shared::sample_2d(number, shared::hemisphere_seed(seed));
        shared::GridRay ray = point.start;
        const vec3 direction = shared::cosine_direction(point.normal, square);
        ray.dir = shared::bend_outwards(direction, point.face);
        const auto end = kept ? kept->end(number, ray.dir) : KeptEnds::End::unknown;
        if (end == KeptEnds::End::dark) continue;
        if (end == KeptEnds::End::open) {
            if (has(from_, LightFrom::sources))
                looking_.push_back({.light = factor * world_.scene().sky.radiance(ray.dir),
                                    .sum = last_sum(),
                                    .open = true});
            continue;
        }
        looking_.push_back({.light = factor,
                            .sum = last_sum(),
                            .number = number,
                            .density = glm::dot(direction, point.normal) * kPerPi});
        closest_rays_.push_back(ray);
    }
}

/// How much a ray towards a source counts, with its cosine: one over the hemisphere may meet the
/// same. @param density  of its direction
float Gatherer::source_weight(float cosine, float density) const {
    const float source = static_cast<float>(rays_.source);
    const float around = static_cast<float>(rays_.around);
    return cosine * kPerPi / (source * density + around * cosine * kPerPi);
}

/// How much a ray over the hemisphere counts that met a source.
/// @param density, source_density  of its direction among both kinds of rays
float Gatherer::around_weight(float density, float source_density) const {
    const float source = static_cast<float>(rays_.source);
    const float around = static_cast<float>(rays_.around);
    return around * density / (around * density + source * source_density);
}

void Gatherer::add_sky(const LitPoint& point, int part, std::uint32_t seed) {
    const Sky& sky = world_.scene().sky;
    const ivec2 some = share(rays_.source, part);
    for (int i = some.x; i < some.y; ++i) {
        const SkySample sample =
            sky.sample(shared::sample_2d(static_cast<std::uint32_t>(i), seed ^ kSkySeed));
        const float cosine = glm::dot(sample.direction, point.normal);
        if (!(cosine > 0.0f) || !(sample.density > 0.0f)) continue;
        shared::GridRay ray = point.start;
        ray.dir = shared::bend_outwards(sample.direction, point.face);
        const float weight = source_weight(cosine, sample.density);
        any_rays_.push_back(ray);
        to_light_.push_back({weight * sky.radiance(sample.direction), last_sum()});
    }
}

void Gatherer::add_emitters(const LitPoint& point, int part, std::uint32_t seed) {
    const ivec2 some = share(rays_.source, part);
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
        const float weight = source_weight(cosine, sample.density);
        looking_.push_back({.light = vec3(weight),
                            .sum = last_sum(),
                            .emitter_object = sample.object,
                            .emitter_cell = sample.cell});
        closest_rays_.push_back(ray);
    }
}

vec3 Gatherer::found(const LookingRay& looking, const shared::GridRay& ray,
                     const InstanceHit& hit) {
    const bool sources = has(from_, LightFrom::sources);
    if (!looking.around()) {
        if (!hit || hit.object != looking.emitter_object) return vec3(0.0f);
        const CellSide side = world_.side(hit);
        return side.cell == looking.emitter_cell ? world_.emission(side) : vec3(0.0f);
    }
    MetSide* const kept =
        keeps_sides_
            ? &kept_sides_[looking.sum * static_cast<std::size_t>(rays_.around) + looking.number]
            : nullptr;
    if (kept) kept->traced = true;
    if (!hit) {
        if (!sources) return vec3(0.0f);
        const Sky& sky = world_.scene().sky;
        const float weight =
            sky.uneven() ? around_weight(looking.density, sky.density(ray.dir)) : 1.0f;
        return weight * sky.radiance(ray.dir);
    }
    const CellSide side = world_.side(hit);
    if (kept) *kept = {side, -hit.ray.dir, true, true};
    vec3 light(0.0f);
    if (sources) {
        const vec3 emission = world_.emission(side);
        if (emission != vec3(0.0f)) {
            const float density = world_.emitters().density(origin_of(ray), side.object, side.cell);
            light += around_weight(looking.density, density) * emission;
        }
    }
    if (has(from_, LightFrom::cells)) light += world_.albedo(side) * world_.stored_light(hit, side);
    return light;
}

void Gatherer::trace() {
    occluded_.resize(any_rays_.size());
    world_.instances().trace_any(any_rays_, shared::stop_at_voxels(), occluded_);
    for (std::size_t i = 0; i < to_light_.size(); ++i)
        if (occluded_[i] == 0) sums_[to_light_[i].sum] += to_light_[i].light;
    hits_.resize(closest_rays_.size());
    world_.instances().trace_closest(closest_rays_, shared::stop_at_voxels(), hits_);
    std::size_t next = 0;
    for (const LookingRay& looking : looking_) {
        if (looking.open) {
            sums_[looking.sum] += looking.light;
            continue;
        }
        const InstanceHit& hit = hits_[next];
        if (keeps_hits_ && looking.around()) kept_[looking.sum] = hit;
        sums_[looking.sum] += looking.light * found(looking, closest_rays_[next], hit);
        ++next;
    }
    traced_ += any_rays_.size() + closest_rays_.size();
    any_rays_.clear();
    closest_rays_.clear();
    to_light_.clear();
    looking_.clear();
}

}  // namespace octavo
