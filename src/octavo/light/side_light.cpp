// SPDX-License-Identifier: MIT
#include "octavo/light/side_light.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <string>

#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"
#include "octavo/light/gather.h"
#include "octavo/light/gather_lamps.h"
#include "octavo/light/side_starts.h"

namespace octavo {
namespace {

constexpr int kStarts = SideStarts::kMost;

void check(const LightOptions& o) {
    const auto refuse = [](const char* what) { throw Error(Errc::bad_argument, what); };
    if (o.bounces < 0 || o.bounces > LightOptions::kMostBounces) refuse("bounces are 0 to 8");
    if (o.lamp_rays < 1 || o.lamp_rays > 65536 || o.around_rays < 1 || o.around_rays > 65536 ||
        o.source_rays < 1 || o.source_rays > 65536)
        refuse("rays for each side of a cell are 1 to 65536");
    if (!(o.tolerance >= 0.0)) refuse("the tolerance of light is 0 or more");
}

float greatest(const vec3& v) {
    return std::max({v.r, v.g, v.b});
}

// The steps by which the rest of the light is estimated.
constexpr int kRestSteps = 4;
constexpr float kMostRatio = 0.98f;  // from one to the next: whiter walls do not exist

/// What comes back along a row's rays, on average.
vec3 mean_of(std::span<const std::uint32_t> row, const SideLight::Sent& sent) {
    vec4 sum(0.0f);
    for (const std::uint32_t word : row)
        if (CellWords::is_word(word)) sum += sent[word];
    return vec3(sum) / static_cast<float>(row.size());
}

/// Where the cells of an object are in common space.
class Placed {
public:
    Placed(const LitScene& scene, const LitWorld& world, std::uint32_t object)
        : world_(world),
          object_(object),
          to_common_(world.instances().to_common(object)),
          voxel_(glm::length(dvec3(to_common_[0]))),
          width_(scene.objects[object].attributes.empty() ? 1.0 : cell_width(scene, object)) {}

    /// How far at most the lines go by which a start is lifted off its face.
    [[nodiscard]] double reach() const { return 4.0 * voxel_; }

    /// Whether no ray of a side can meet the object, nor its starts lie elsewhere by it.
    [[nodiscard]] bool out_of_sight(const KeptEnds& kept, const LitSide& side,
                                    const uvec3& cell) const {
        const vec3 normal = side.normal();
        // Rays are bent out of the cell's face: that keeps them above the surface as well if the
        // face looks the same way.
        if (glm::dot(normal, direction_vector(side.direction())) < 0.0f) return false;
        const dvec3 middle(to_common_ * dvec4(width_ * (dvec3(cell) + 0.5), 1.0));
        return kept.out_of_sight(middle, 0.87 * width_ * voxel_ + 2.0 * reach(),
                                 world_.instances().normal_to_common(object_, normal));
    }

private:
    const LitWorld& world_;
    std::uint32_t object_;
    const dmat4& to_common_;
    double voxel_, width_;
};

}  // namespace

SideLight::SideLight(LitScene& scene, const LightOptions& options)
    : scene_(scene), options_(options), cells_(scene) {
    check(options);
    options_.around_rays = (options.around_rays + kStarts - 1) / kStarts * kStarts;
    world_.emplace(scene_);
    check_size();
    with_threads(options_.threads, [&] {
        cells_.find_colors(scene_);
        std::uint64_t sides = 0;
        for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) {
            ObjectLight& o = objects_.emplace_back();
            static_cast<ObjectSides&>(o) = find_sides(scene_, *world_, i, cells_);
            o.from_lamps.resize(o.sides.size(), vec3(0.0f));
            o.from_sources.resize(o.sides.size(), vec3(0.0f));
            o.reflected.resize(static_cast<std::size_t>(passes()));
            for (auto& some : o.reflected) some.resize(o.sides.size(), vec3(0.0f));
            sides += o.sides.size();
        }
        const auto rays = sides * static_cast<std::uint64_t>(options_.around_rays);
        keeps_rows_ = rays * sizeof(std::uint32_t) <= options_.kept_bytes;
        for (ObjectLight& o : objects_)
            if (keeps_rows_) o.rows.resize(o.sides.size() * row_length());
    });
}

/// Refuses what has no room, and makes room for the light. A small file may have attributes of
/// very many cells, where they are all alike.
void SideLight::check_size() {
    const std::uint64_t bytes =
        sizeof(std::uint32_t) * cells_.size() * (static_cast<std::uint64_t>(passes()) + 2);
    if (bytes > machine_memory_bytes() / 2)
        throw Error(Errc::limit, "the light of " + std::to_string(cells_.size() / 6) +
                                     " cells and " + std::to_string(options_.bounces) +
                                     " bounces takes " + std::to_string(bytes) +
                                     " bytes, more than half of this machine's memory");
    for (int bounce = 0; bounce <= passes(); ++bounce)
        words_.push_back(std::make_shared<Words>(cells_.size(), CellLight::kHidden));
    if (closes()) rest_.assign(cells_.size(), CellLight::kHidden);
}

/// Room for the rows of a block: where they are kept, or in `scratch`.
std::span<std::uint32_t> SideLight::row_space(ObjectLight& o, const SideBlock& block,
                                              Words& scratch) const {
    const std::size_t count = (block.end - block.first) * row_length();
    if (keeps_rows_) return std::span(o.rows).subspan(block.first * row_length(), count);
    scratch.resize(count);
    return scratch;
}

/// What the rays of a block met; they are traced again where that is not kept.
std::span<const std::uint32_t> SideLight::rows(ObjectLight& o, const SideBlock& block,
                                               Words& scratch) {
    const auto space = row_space(o, block, scratch);
    if (!keeps_rows_) gather_rows(o, block, space);
    return space;
}

template <class Visit>
void SideLight::for_rows(ObjectLight& o, const SideBlock& block, const Visit& visit) {
    Words scratch;
    const std::span<const std::uint32_t> all = rows(o, block, scratch);
    for (std::size_t i = block.first; i < block.end; ++i)
        visit(i, all.subspan((i - block.first) * row_length(), row_length()));
}

/// What all sides send back of a light that is stored, and as much everywhere besides.
SideLight::Sent SideLight::sent_back(const Words& light, float more) const {
    Sent sent(light.size());
    constexpr std::size_t kSome = 4096;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, sent.size(), kSome), [&](const auto& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i)
                sent[i] = vec4(
                    cells_.albedo(static_cast<std::uint32_t>(i)) * (more + unpack_rgb9e5(light[i])),
                    0.0f);
        });
    return sent;
}

SideLight::Sent SideLight::sent_before(int bounce) const {
    return sent_back(*words_[static_cast<std::size_t>(bounce) - 1], 0.0f);
}

void SideLight::reflect(ObjectLight& o, const SideBlock& block, int bounce, const Sent& sent) {
    const auto index = static_cast<std::size_t>(bounce) - 1;
    for_rows(o, block, [&](std::size_t side, std::span<const std::uint32_t> row) {
        o.reflected[index][side] = mean_of(row, sent);
    });
    sides_done_ += block.end - block.first;
}

void SideLight::find_rest() {
    if (!closes()) return;
    Words before(rest_.size(), CellLight::kHidden), now = before;
    for (const ObjectLight& o : objects_)
        for (const LitSide& side : o.sides) before[o.word_of(side)] = pack_rgb9e5(vec3(1.0f));
    for (int step = 1; step <= kRestSteps; ++step) {
        const Sent sent = sent_back(before, 0.0f);
        for (ObjectLight& o : objects_)
            tbb::parallel_for(std::size_t{0}, o.blocks.size(), [&](std::size_t b) {
                for_rows(o, o.blocks[b], [&](std::size_t i, std::span<const std::uint32_t> row) {
                    const std::uint32_t word = o.word_of(o.sides[i]);
                    const vec3 term = mean_of(row, sent);
                    vec3 sum = step == 1 ? term : unpack_rgb9e5(rest_[word]) + term;
                    if (step == kRestSteps) {
                        const vec3 last = unpack_rgb9e5(before[word]);
                        const vec3 ratio =
                            glm::min(term / glm::max(last, vec3(1e-6f)), vec3(kMostRatio));
                        sum += term * ratio / (1.0f - ratio);
                    }
                    now[word] = pack_rgb9e5(term);
                    rest_[word] = pack_rgb9e5(sum);
                });
            });
        before.swap(now);
    }
}

void SideLight::find_rest(const std::vector<std::vector<std::uint8_t>>& some) {
    if (!closes()) return;
    const Sent sent = sent_back(rest_, 1.0f);
    for (ObjectLight& o : objects_)
        tbb::parallel_for(std::size_t{0}, o.blocks.size(), [&](std::size_t b) {
            if (some[o.object][b] == 0) return;
            for_rows(o, o.blocks[b], [&](std::size_t i, std::span<const std::uint32_t> row) {
                rest_[o.word_of(o.sides[i])] = pack_rgb9e5(mean_of(row, sent));
            });
        });
}

template <class Begin, class Add>
void SideLight::for_points(const ObjectLight& o, const SideBlock& block, int pass,
                           const Begin& begin, const Add& add) const {
    const LitObject& object = scene_.objects[o.object];
    std::array<LitPoint, kStarts> points{};
    std::size_t i = block.first;
    const CellRange range{o.sides[i].cell, o.sides[block.end - 1].cell + 1ull};
    object.attributes.cells().for_each(range, [&](std::uint64_t cell, const uvec3& at) {
        for (; i < block.end && o.sides[i].cell == cell; ++i) {
            const LitSide& side = o.sides[i];
            if (!begin(i, at)) continue;
            const SideStarts starts(object, at, side.direction());
            const vec3 normal = side.normal();
            for (int part = 0; part < kStarts; ++part) {
                const auto k = static_cast<std::size_t>(part % starts.count);
                if (part < starts.count)
                    points[k] = world_->point(o.object, starts.rays[k], side.direction(), normal);
                add(points[k], part, side_seed(at, side.direction(), pass + 1));
            }
        }
    });
}

void SideLight::gather_lamps(ObjectLight& o, const SideBlock& block) {
    LampGatherer gatherer(*world_, options_.lamp_rays, kStarts);
    for_points(
        o, block, 0,
        [&](std::size_t, const uvec3&) {
            gatherer.begin();
            return true;
        },
        [&](const LitPoint& point, int, std::uint32_t seed) { gatherer.add(point, seed); });
    gatherer.trace();
    for (std::size_t i = block.first; i < block.end; ++i)
        o.from_lamps[i] = gatherer.light(i - block.first);
    rays_ += gatherer.rays_traced();
    sides_done_ += block.end - block.first;
}

void SideLight::gather_around(ObjectLight& o, const SideBlock& block) {
    Words scratch;
    gather_rows(o, block, row_space(o, block, scratch));
}

void SideLight::gather_around(ObjectLight& o, const SideBlock& block, const MovedObject& moved) {
    Words scratch;
    gather_rows(o, block, row_space(o, block, scratch), &moved);
}

void SideLight::gather_rows(ObjectLight& o, const SideBlock& block, std::span<std::uint32_t> rows,
                            const MovedObject* moved) {
    Gatherer gatherer(*world_, LightFrom::sources,
                      {options_.lamp_rays, options_.around_rays, options_.source_rays, false},
                      kStarts);
    gatherer.keep_sides();
    std::optional<KeptEnds> kept;
    if (moved) kept.emplace(*moved, cells_);
    std::vector<std::size_t> asked;  // sides, of whom each has a sum
    const Placed placed(scene_, *world_, o.object);
    const bool sources = !world_->emitters().empty();
    for_points(
        o, block, 1,
        [&](std::size_t i, const uvec3& at) {
            const auto row = rows.subspan((i - block.first) * row_length(), row_length());
            if (kept && !kept->begin(row) && !sources && placed.out_of_sight(*kept, o.sides[i], at))
                return false;
            asked.push_back(i);
            gatherer.begin();
            return true;
        },
        [&](const LitPoint& point, int part, std::uint32_t seed) {
            if (kept) kept->start(point.position(), placed.reach());
            gatherer.add(point, part, seed, kept ? &*kept : nullptr);
        });
    gatherer.trace();
    for (std::size_t sum = 0; sum < asked.size(); ++sum) {
        const std::size_t i = asked[sum];
        o.from_sources[i] = gatherer.light(sum);
        auto to = rows.begin() + static_cast<std::ptrdiff_t>((i - block.first) * row_length());
        for (const Gatherer::MetSide& met : gatherer.sides(sum)) {
            if (met.traced) *to = met.met ? cells_.target(met.side, met.towards) : CellWords::kOpen;
            ++to;
        }
    }
    rays_ += gatherer.rays_traced();
    sides_done_ += asked.size();
}

vec3 SideLight::sum(const ObjectLight& o, std::size_t side, int bounce) const {
    vec3 light = o.from_lamps[side] + o.from_sources[side];
    if (bounce == 0) return light;
    const auto last = static_cast<std::size_t>(bounce) - 1;
    const vec3 reflected = o.reflected[last][side];
    light += reflected;
    if (bounce != options_.bounces || !closes()) return light;
    const vec3 before = last == 0 ? vec3(0.0f) : o.reflected[last - 1][side];
    return light + glm::max(reflected - before, vec3(0.0f)) *
                       unpack_rgb9e5(rest_[o.word_of(o.sides[side])]);
}

double SideLight::write(ObjectLight& o, const SideBlock& block, int bounce) {
    Words& words = *words_[static_cast<std::size_t>(bounce)];
    double flux = 0.0;
    for (std::size_t i = block.first; i < block.end; ++i) {
        const std::uint32_t at = o.word_of(o.sides[i]);
        const std::uint32_t next = pack_rgb9e5(sum(o, i, bounce));
        if (next == words[at]) continue;
        const vec3 change = glm::abs(unpack_rgb9e5(next) - unpack_rgb9e5(words[at]));
        flux += static_cast<double>(greatest(change * cells_.albedo(at)));
        words[at] = next;
    }
    // A cell shows at most sqrt(3) of its face's area in any direction.
    const dvec3 edge(world_->instances().to_common(o.object)[0]);
    const double width = cell_width(scene_, o.object) * glm::length(edge);
    return 1.74 * flux * width * width;
}

void SideLight::show() {
    for (const ObjectLight& o : objects_) {
        LitObject& object = scene_.objects[o.object];
        if (object.attributes.empty()) continue;
        object.light = CellLight(
            object.attributes.level(), options_.bounces,
            std::span(*words_.back()).subspan(o.first_word, 6 * object.attributes.cells().count()),
            words_.back());
    }
}

std::uint64_t SideLight::size_bytes() const {
    std::uint64_t bytes = cells_.size() * sizeof(std::uint32_t);
    for (const auto& words : words_) bytes += words->size() * sizeof(std::uint32_t);
    bytes += rest_.size() * sizeof(std::uint32_t);
    for (const ObjectLight& o : objects_)
        bytes += o.sides.size() * (sizeof(LitSide) + (2 + o.reflected.size()) * sizeof(vec3)) +
                 o.rows.size() * sizeof(std::uint32_t);
    return bytes;
}

}  // namespace octavo
