// SPDX-License-Identifier: MIT
//
// After Josh Klint's post "Sparse Voxel Octrees" ([J]): one value for each of six directions, only
// for cells that exist; direct light by rays in the octree in place of shadow maps.
#include "octavo/light/light_cells.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <span>

#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"
#include "octavo/light/cell_words.h"
#include "octavo/light/change_reach.h"
#include "octavo/light/gather.h"
#include "octavo/light/side_starts.h"

namespace octavo {
namespace {

constexpr int kStarts = SideStarts::kMost;
constexpr std::uint64_t kBlockCells = 512;  // that are lit together, and change together

/// A side of a cell that can be seen.
struct Side {
    std::uint32_t cell;
    std::uint32_t direction_and_normal;  // the normal above the lowest 8 bits

    [[nodiscard]] int direction() const { return static_cast<int>(direction_and_normal & 255u); }
    [[nodiscard]] vec3 normal() const { return unpack_normal(direction_and_normal >> 8); }
};

/// Consecutive cells, which are close together.
struct Block {
    std::size_t first = 0;  // of the sides
    std::size_t end = 0;
    Box box;  // common space
};

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

using Words = std::vector<std::uint32_t>;
constexpr std::uint32_t kNoWord = CellWords::kNone;

}  // namespace

/// The light of one object's cells, in all its stages.
struct ObjectLight {
    std::uint32_t object = 0;
    std::size_t first_word = 0;  // of this object, in arrays of words
    std::vector<Side> sides;
    std::vector<Block> blocks;
    std::vector<vec3> from_lamps, from_sources;  // of each side
    std::vector<std::vector<vec3>> reflected;    // for each number of bounces, from 1
    Words rows;  // if they are kept: for each side and ray over its hemisphere the word that the
                 // ray met
};

class CellLighter::State {
public:
    State(LitScene& scene, const LightOptions& options)
        : scene_(scene), options_(options), cells_(scene) {
        check(options);
        options_.around_rays = (options.around_rays + kStarts - 1) / kStarts * kStarts;
        world_.emplace(scene_);
        check_size();
        with_threads(options_.threads, [&] {
            cells_.find_colors(scene_);
            std::uint64_t sides = 0;
            for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) {
                objects_.emplace_back();
                objects_.back().object = i;
                objects_.back().first_word = cells_.first_word(i);
                if (!scene_.objects[i].attributes.empty()) find_sides(objects_.back());
                sides += objects_.back().sides.size();
            }
            const auto rays = sides * static_cast<std::uint64_t>(options_.around_rays);
            keeps_rows_ = rays * sizeof(std::uint32_t) <= options_.kept_bytes;
            for (ObjectLight& o : objects_)
                if (keeps_rows_) o.rows.resize(o.sides.size() * row_length());
        });
    }

    LightReport light_all() {
        start_report(static_cast<std::uint64_t>(options_.bounces) + 1);
        with_threads(options_.threads, [&] {
            for (ObjectLight& o : objects_)
                for_blocks(o, {}, [&](const Block& block) {
                    Words scratch;
                    gather_lamps(o, block);
                    gather_around(o, block, row_space(o, block, scratch));
                    write(o, block, 0);
                });
            if (closes()) find_rest();
            for (int bounce = 1; bounce <= options_.bounces; ++bounce)
                for (ObjectLight& o : objects_)
                    for_blocks(o, {}, [&](const Block& block) {
                        reflect(o, block, bounce);
                        write(o, block, bounce);
                    });
            show();
        });
        return finish_report();
    }

    LightReport change_light(std::size_t which, const Light& light) {
        if (which > scene_.lights.size())
            throw Error(Errc::bad_argument, "there is no light with this number");
        std::vector<Light> changed = {light};
        if (which < scene_.lights.size()) {
            changed.push_back(scene_.lights[which]);
            scene_.lights[which] = light;
        } else {
            scene_.lights.push_back(light);
        }
        world_.emplace(scene_);
        start_report(0);
        with_threads(options_.threads, [&] {
            Changes changes = redo_lamps(changed);
            for (int bounce = 1; bounce <= options_.bounces; ++bounce)
                changes = redo_bounce(bounce, changes, {});
            show();
        });
        return finish_report();
    }

    LightReport move_object(std::size_t which, const dmat4& placement) {
        if (which == 0 || which >= objects_.size())
            throw Error(Errc::bad_argument, "there is no object with this number that can move");
        const auto moved = static_cast<std::uint32_t>(which);
        const dmat4 old = scene_.objects[which].placement;
        const Ball before = ball_of(object_box(moved));
        scene_.objects[which].placement = placement;
        try {
            world_.emplace(scene_);
        } catch (...) {
            scene_.objects[which].placement = old;
            world_.emplace(scene_);
            throw;
        }
        start_report(0);
        with_threads(options_.threads, [&] {
            place_blocks(objects_[which]);
            const Ball after = ball_of(object_box(moved));
            Flags looked_around;
            Changes changes = redo_around_object(moved, before, after, looked_around);
            for (int bounce = 1; bounce <= options_.bounces; ++bounce)
                changes = redo_bounce(bounce, changes, looked_around);
            show();
        });
        return finish_report();
    }

    [[nodiscard]] std::uint64_t size_bytes() const {
        std::uint64_t bytes = cells_.size() * sizeof(std::uint32_t);
        for (const auto& words : words_) bytes += words->size() * sizeof(std::uint32_t);
        bytes += rest_.size() * sizeof(std::uint32_t);
        for (const ObjectLight& o : objects_)
            bytes += o.sides.size() * (sizeof(Side) + (2 + o.reflected.size()) * sizeof(vec3)) +
                     o.rows.size() * sizeof(std::uint32_t);
        return bytes;
    }

private:
    /// For each object and block the flux by which it changed, at most: of radiance times area, in
    /// square units of common space.
    using Changes = std::vector<std::vector<double>>;
    /// For each object and block 1 or 0; empty: none.
    using Flags = std::vector<std::vector<std::uint8_t>>;

    /// Refuses what has no room, and makes room for the light. A small file may have attributes of
    /// very many cells, where they are all alike.
    void check_size() {
        const std::uint64_t bytes = sizeof(std::uint32_t) * cells_.size() *
                                    (static_cast<std::uint64_t>(options_.bounces) + 2);
        if (bytes > machine_memory_bytes() / 2)
            throw Error(Errc::limit, "the light of " + std::to_string(cells_.size() / 6) +
                                         " cells and " + std::to_string(options_.bounces) +
                                         " bounces takes " + std::to_string(bytes) +
                                         " bytes, more than half of this machine's memory");
        for (int bounce = 0; bounce <= options_.bounces; ++bounce)
            words_.push_back(std::make_shared<Words>(cells_.size(), CellLight::kHidden));
        if (closes()) rest_.assign(cells_.size(), CellLight::kHidden);
    }

    [[nodiscard]] std::size_t row_length() const {
        return static_cast<std::size_t>(options_.around_rays);
    }
    /// Room for the rows of a block: where they are kept, or in `scratch`.
    [[nodiscard]] std::span<std::uint32_t> row_space(ObjectLight& o, const Block& block,
                                                     Words& scratch) const {
        const std::size_t count = (block.end - block.first) * row_length();
        if (keeps_rows_) return std::span(o.rows).subspan(block.first * row_length(), count);
        scratch.resize(count);
        return scratch;
    }
    /// What the rays of a block met; they are traced again where that is not kept.
    [[nodiscard]] std::span<const std::uint32_t> rows(ObjectLight& o, const Block& block,
                                                      Words& scratch) {
        const auto space = row_space(o, block, scratch);
        if (!keeps_rows_) gather_around(o, block, space);
        return space;
    }

    /// Calls visit(side, row) for the sides of a block.
    template <class Visit>
    void for_rows(ObjectLight& o, const Block& block, const Visit& visit) {
        Words scratch;
        const std::span<const std::uint32_t> all = rows(o, block, scratch);
        for (std::size_t i = block.first; i < block.end; ++i)
            visit(i, all.subspan((i - block.first) * row_length(), row_length()));
    }

    /// What the cells that a row's rays met send back of this light, on average over the rays.
    [[nodiscard]] vec3 sent_to(std::span<const std::uint32_t> row, const Words& light) const {
        vec3 sum(0.0f);
        for (const std::uint32_t word : row)
            if (word != kNoWord) sum += cells_.albedo(word) * unpack_rgb9e5(light[word]);
        return sum / static_cast<float>(row.size());
    }

    /// Gathers a bounce from the light before it.
    void reflect(ObjectLight& o, const Block& block, int bounce) {
        const auto index = static_cast<std::size_t>(bounce) - 1;
        for_rows(o, block, [&](std::size_t side, std::span<const std::uint32_t> row) {
            o.reflected[index][side] = sent_to(row, *words_[index]);
        });
        sides_done_ += block.end - block.first;
    }

    [[nodiscard]] bool closes() const { return options_.estimate_rest && options_.bounces > 0; }

    /// Finds for each side what a light that is even around it adds up to by being sent on again
    /// and again: the sum over k of A^k 1, where A is one bounce. The first terms are found one by
    /// one; from then on they are taken to shrink by a constant ratio, that of the last two.
    void find_rest() {
        Words before(rest_.size(), CellLight::kHidden), now = before;
        for (const ObjectLight& o : objects_)
            for (const Side& side : o.sides) before[word_of(o, side)] = pack_rgb9e5(vec3(1.0f));
        for (int step = 1; step <= kRestSteps; ++step) {
            for (ObjectLight& o : objects_)
                tbb::parallel_for(std::size_t{0}, o.blocks.size(), [&](std::size_t b) {
                    for_rows(
                        o, o.blocks[b], [&](std::size_t i, std::span<const std::uint32_t> row) {
                            const std::uint32_t word = word_of(o, o.sides[i]);
                            const vec3 term = sent_to(row, before);
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

    /// The same for an object that stands somewhere else: one step from what is known.
    void find_rest(ObjectLight& o) {
        std::vector<std::uint32_t> found(o.sides.size());
        tbb::parallel_for(std::size_t{0}, o.blocks.size(), [&](std::size_t b) {
            for_rows(o, o.blocks[b], [&](std::size_t i, std::span<const std::uint32_t> row) {
                vec3 sum(0.0f);
                for (const std::uint32_t word : row)
                    if (word != kNoWord)
                        sum += cells_.albedo(word) * (1.0f + unpack_rgb9e5(rest_[word]));
                found[i] = pack_rgb9e5(sum / static_cast<float>(row.size()));
            });
        });
        for (std::size_t i = 0; i < o.sides.size(); ++i) rest_[word_of(o, o.sides[i])] = found[i];
    }

    [[nodiscard]] static std::uint32_t word_of(const ObjectLight& o, const Side& side) {
        return static_cast<std::uint32_t>(o.first_word + 6 * std::size_t{side.cell} +
                                          static_cast<std::size_t>(side.direction()));
    }

    /// What an object fills of common space: the cells that can be seen, or else its grid.
    [[nodiscard]] Box object_box(std::uint32_t object) const {
        Box box;
        for (const Block& block : objects_[object].blocks) {
            box.extend(block.box.low);
            box.extend(block.box.high);
        }
        if (!box.empty()) return box;
        const double width = std::ldexp(1.0, scene_.objects[object].dag.depth());
        return placed(object, {dvec3(0.0), dvec3(width)});
    }
    /// A box around a box of an object's grid, in common space.
    [[nodiscard]] Box placed(std::uint32_t object, const Box& box) const {
        const dmat4& to_common = world_->instances().to_common(object);
        Box result;
        for (unsigned i = 0; i < 8; ++i)
            result.extend(dvec3(to_common * dvec4(i & 1 ? box.high.x : box.low.x,
                                                  i & 2 ? box.high.y : box.low.y,
                                                  i & 4 ? box.high.z : box.low.z, 1.0)));
        return result;
    }

    [[nodiscard]] double cell_width(const ObjectLight& o) const {
        const LitObject& object = scene_.objects[o.object];
        return std::ldexp(1.0, object.dag.depth() - object.attributes.level());
    }

    void find_sides(ObjectLight& o) {
        const LitObject& object = scene_.objects[o.object];
        const CellIndex& cells = object.attributes.cells();
        const std::uint64_t blocks = (cells.count() + kBlockCells - 1) / kBlockCells;
        std::vector<std::vector<Side>> found(blocks);
        tbb::parallel_for(std::uint64_t{0}, blocks, [&](std::uint64_t b) {
            const CellRange range{b * kBlockCells, std::min((b + 1) * kBlockCells, cells.count())};
            cells.for_each(range, [&](std::uint64_t cell, const uvec3& at) {
                for (int direction = 0; direction < 6; ++direction)
                    if (const auto normal = side_normal(object, at, direction))
                        found[b].push_back(
                            {static_cast<std::uint32_t>(cell),
                             pack_normal(*normal) << 8 | static_cast<std::uint32_t>(direction)});
            });
        });
        for (const auto& some : found) {
            Block block{o.sides.size(), 0, {}};
            o.sides.insert(o.sides.end(), some.begin(), some.end());
            block.end = o.sides.size();
            if (block.first < block.end) o.blocks.push_back(block);
        }
        for (const Side& side : o.sides) cells_.set_seen(word_of(o, side));
        place_blocks(o);
        o.from_lamps.resize(o.sides.size(), vec3(0.0f));
        o.from_sources.resize(o.sides.size(), vec3(0.0f));
        o.reflected.resize(static_cast<std::size_t>(options_.bounces));
        for (auto& some : o.reflected) some.resize(o.sides.size(), vec3(0.0f));
    }

    void place_blocks(ObjectLight& o) const {
        const CellIndex& cells = scene_.objects[o.object].attributes.cells();
        const double width = cell_width(o);
        tbb::parallel_for(std::size_t{0}, o.blocks.size(), [&](std::size_t b) {
            Block& block = o.blocks[b];
            const CellRange range{o.sides[block.first].cell, o.sides[block.end - 1].cell + 1ull};
            Box box;
            cells.for_each(range, [&](std::uint64_t, const uvec3& at) {
                box.extend(width * dvec3(at));
                box.extend(width * (dvec3(at) + 1.0));
            });
            block.box = placed(o.object, box);
        });
    }

    template <class Work>
    void for_blocks(ObjectLight& o, const std::vector<std::uint8_t>& some, const Work& work) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, o.blocks.size(), 1),
                          [&](const auto& range) {
                              for (std::size_t b = range.begin(); b != range.end(); ++b) {
                                  if (!some.empty() && some[b] == 0) continue;
                                  work(o.blocks[b]);
                                  add_progress(o.blocks[b].end - o.blocks[b].first);
                              }
                          });
    }

    /// Calls begin() for each side of a block, and add(point, part, seed) for the kStarts points
    /// that its rays start from.
    template <class Begin, class Add>
    void for_points(const ObjectLight& o, const Block& block, int pass, const Begin& begin,
                    const Add& add) const {
        const LitObject& object = scene_.objects[o.object];
        std::array<LitPoint, kStarts> points{};
        std::size_t i = block.first;
        const CellRange range{o.sides[i].cell, o.sides[block.end - 1].cell + 1ull};
        object.attributes.cells().for_each(range, [&](std::uint64_t cell, const uvec3& at) {
            for (; i < block.end && o.sides[i].cell == cell; ++i) {
                const Side& side = o.sides[i];
                const SideStarts starts(object, at, side.direction());
                const vec3 normal = side.normal();
                begin();
                for (int part = 0; part < kStarts; ++part) {
                    const auto k = static_cast<std::size_t>(part % starts.count);
                    if (part < starts.count)
                        points[k] =
                            world_->point(o.object, starts.rays[k], side.direction(), normal);
                    add(points[k], part, side_seed(at, side.direction(), pass + 1));
                }
            }
        });
    }

    void gather_lamps(ObjectLight& o, const Block& block) {
        LampGatherer gatherer(*world_, options_.lamp_rays, kStarts);
        for_points(
            o, block, 0, [&] { gatherer.begin(); },
            [&](const LitPoint& point, int, std::uint32_t seed) { gatherer.add(point, seed); });
        gatherer.trace();
        for (std::size_t i = block.first; i < block.end; ++i)
            o.from_lamps[i] = gatherer.light(i - block.first);
        rays_ += gatherer.rays_traced();
        sides_done_ += block.end - block.first;
    }

    /// Finds the light of the sky and of shining cells, and what cells the rays meet.
    void gather_around(ObjectLight& o, const Block& block, std::span<std::uint32_t> rows) {
        Gatherer gatherer(*world_, LightFrom::sources,
                          {options_.lamp_rays, options_.around_rays, options_.source_rays, false},
                          kStarts);
        gatherer.keep_sides();
        for_points(
            o, block, 1, [&] { gatherer.begin(); },
            [&](const LitPoint& point, int part, std::uint32_t seed) {
                gatherer.add(point, part, seed);
            });
        gatherer.trace();
        auto to = rows.begin();
        for (std::size_t i = block.first; i < block.end; ++i) {
            o.from_sources[i] = gatherer.light(i - block.first);
            for (const Gatherer::MetSide& met : gatherer.sides(i - block.first))
                *to++ = cells_.target(met.side, met.towards);
        }
        rays_ += gatherer.rays_traced();
        sides_done_ += block.end - block.first;
    }

    [[nodiscard]] vec3 sum(const ObjectLight& o, std::size_t side, int bounce) const {
        vec3 light = o.from_lamps[side] + o.from_sources[side];
        if (bounce == 0) return light;
        const auto last = static_cast<std::size_t>(bounce) - 1;
        const vec3 reflected = o.reflected[last][side];
        light += reflected;
        if (bounce < options_.bounces || !closes()) return light;
        const vec3 before = last == 0 ? vec3(0.0f) : o.reflected[last - 1][side];
        return light + glm::max(reflected - before, vec3(0.0f)) *
                           unpack_rgb9e5(rest_[word_of(o, o.sides[side])]);
    }

    /// Stores what the light of a block sums up to. @return the flux by which it changed
    double write(ObjectLight& o, const Block& block, int bounce) {
        Words& words = *words_[static_cast<std::size_t>(bounce)];
        double flux = 0.0;
        for (std::size_t i = block.first; i < block.end; ++i) {
            const std::uint32_t at = word_of(o, o.sides[i]);
            const std::uint32_t next = pack_rgb9e5(sum(o, i, bounce));
            if (next == words[at]) continue;
            const vec3 change = glm::abs(unpack_rgb9e5(next) - unpack_rgb9e5(words[at]));
            flux += static_cast<double>(greatest(change * cells_.albedo(at)));
            words[at] = next;
        }
        // A cell shows at most sqrt(3) of its face's area in any direction.
        const dvec3 edge(world_->instances().to_common(o.object)[0]);
        const double width = cell_width(o) * glm::length(edge);
        return 1.74 * flux * width * width;
    }

    /// Lets others see the light.
    void show() {
        for (const ObjectLight& o : objects_) {
            LitObject& object = scene_.objects[o.object];
            if (object.attributes.empty()) continue;
            object.light =
                CellLight(object.attributes.level(), options_.bounces,
                          std::span(*words_.back())
                              .subspan(o.first_word, 6 * object.attributes.cells().count()),
                          words_.back());
        }
    }

    Changes redo_lamps(const std::vector<Light>& changed) {
        const Grid& grid = world_->instances().grid();
        Changes changes;
        for (ObjectLight& o : objects_) {
            std::vector<std::uint8_t> some(o.blocks.size(), 0);
            std::vector<double> flux(o.blocks.size(), 0.0);
            for (std::size_t b = 0; b < some.size(); ++b)
                for (const Light& light : changed) {
                    const Box box{grid.to_world(o.blocks[b].box.low),
                                  grid.to_world(o.blocks[b].box.high)};
                    const bool near = reaches(light, box);
                    some[b] = some[b] != 0 || near ? 1 : 0;
                }
            for_blocks(o, some, [&](const Block& block) {
                gather_lamps(o, block);
                flux[static_cast<std::size_t>(&block - o.blocks.data())] = write(o, block, 0);
            });
            changes.push_back(std::move(flux));
        }
        return changes;
    }

    /// Redoes what comes straight from lamps and from around where an object was or is.
    /// @param looked_around  gets the blocks whose rays over the hemisphere were sent again
    Changes redo_around_object(std::uint32_t moved, const Ball& before, const Ball& after,
                               Flags& looked_around) {
        const Box& shining = world_->emitters().bounds();
        Changes changes;
        for (ObjectLight& o : objects_) {
            std::vector<std::uint8_t> shaded(o.blocks.size(), 0), around(o.blocks.size(), 0),
                some(o.blocks.size(), 0);
            std::vector<double> flux(o.blocks.size(), 0.0);
            for (std::size_t b = 0; b < some.size(); ++b) {
                const Box& box = o.blocks[b].box;
                const Ball block = ball_of(box);
                bool all = o.object == moved, lamp = all, look = all || scene_.sky.uneven();
                for (const Ball& ball : {before, after}) {
                    for (const Light& light : scene_.lights)
                        lamp = lamp || shades(ball, light, box, world_->instances().grid());
                    look = look || covered(box, ball) > options_.move_tolerance ||
                           (!shining.empty() && between(ball, block, ball_of(shining)));
                }
                shaded[b] = lamp ? 1 : 0;
                around[b] = look ? 1 : 0;
                some[b] = lamp || look ? 1 : 0;
            }
            for_blocks(o, some, [&](const Block& block) {
                const auto b = static_cast<std::size_t>(&block - o.blocks.data());
                Words scratch;
                if (shaded[b] != 0) gather_lamps(o, block);
                if (around[b] != 0) gather_around(o, block, row_space(o, block, scratch));
                flux[b] = write(o, block, 0);
            });
            looked_around.push_back(std::move(around));
            changes.push_back(std::move(flux));
        }
        if (closes()) find_rest(objects_[moved]);
        return changes;
    }

    /// Gathers a bounce anew where the light before it changed by enough.
    /// @param always  blocks that are redone anyway
    Changes redo_bounce(int bounce, const Changes& before, const Flags& always) {
        struct Source {
            const Box* box;
            double flux;
        };
        std::vector<Source> sources;
        for (std::size_t i = 0; i < objects_.size(); ++i)
            for (std::size_t b = 0; b < before[i].size(); ++b)
                if (before[i][b] > 0.0)
                    sources.push_back({&objects_[i].blocks[b].box, before[i][b]});
        Changes changes;
        for (ObjectLight& o : objects_) {
            std::vector<std::uint8_t> some(o.blocks.size(), 0);
            std::vector<double> flux(o.blocks.size(), 0.0);
            tbb::parallel_for(std::size_t{0}, o.blocks.size(), [&](std::size_t b) {
                double bound = 0.0;
                if (!always.empty() && always[o.object][b] != 0) {
                    some[b] = 1;
                    return;
                }
                for (const Source& source : sources) {
                    // Irradiance over pi of a flux at this distance; nearer, of one that fills the
                    // view with no more than its own radiance.
                    const double way = distance(*source.box, o.blocks[b].box);
                    bound += source.flux / (std::numbers::pi * std::max(way * way, 1.0));
                    if (bound > options_.tolerance) break;
                }
                some[b] = bound > options_.tolerance ? 1 : 0;
            });
            for_blocks(o, some, [&](const Block& block) { reflect(o, block, bounce); });
            // Blocks whose direct light alone changed have another sum too.
            tbb::parallel_for(std::size_t{0}, o.blocks.size(),
                              [&](std::size_t b) { flux[b] = write(o, o.blocks[b], bounce); });
            changes.push_back(std::move(flux));
        }
        return changes;
    }

    void start_report(std::uint64_t passes) {
        report_ = {};
        rays_ = sides_done_ = 0;
        done_ = next_ = total_ = 0;
        for (const ObjectLight& o : objects_) {
            report_.cells += scene_.objects[o.object].attributes.cells().count();
            report_.sides += o.sides.size();
        }
        total_ = report_.sides * passes;
    }
    LightReport finish_report() {
        report_.sides_done = sides_done_;
        report_.rays = rays_;
        return report_;
    }
    void add_progress(std::uint64_t sides) {
        if (!options_.progress) return;
        const std::lock_guard lock(mutex_);
        done_ += sides;
        if (done_ < next_ && done_ != total_) return;
        next_ = done_ + total_ / 200;
        report(options_.progress, {"light", done_, total_});
    }

    LitScene& scene_;
    LightOptions options_;
    std::optional<LitWorld> world_;
    std::vector<ObjectLight> objects_;
    CellWords cells_;
    std::vector<std::shared_ptr<Words>> words_;  // the light as it is stored, for each number of
                                                 // bounces, from 0
    Words rest_;  // of each side, what an even light around it adds up to; see find_rest()
    bool keeps_rows_ = false;

    LightReport report_;
    std::atomic<std::uint64_t> rays_ = 0, sides_done_ = 0;
    std::mutex mutex_;
    std::uint64_t done_ = 0, next_ = 0, total_ = 0;
};

CellLighter::CellLighter(LitScene& scene, const LightOptions& options)
    : state_(std::make_unique<State>(scene, options)) {}
CellLighter::~CellLighter() = default;

LightReport CellLighter::light_all() {
    return state_->light_all();
}
LightReport CellLighter::change_light(std::size_t which, const Light& light) {
    return state_->change_light(which, light);
}
LightReport CellLighter::move_object(std::size_t which, const dmat4& placement) {
    return state_->move_object(which, placement);
}
std::uint64_t CellLighter::size_bytes() const {
    return state_->size_bytes();
}

LightReport light_cells(LitScene& scene, const LightOptions& options) {
    return CellLighter(scene, options).light_all();
}

}  // namespace octavo
