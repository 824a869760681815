// SPDX-License-Identifier: MIT
//
// After Josh Klint's post "Sparse Voxel Octrees" ([J]): one value for each of six directions, only
// for cells that exist; direct light by rays in the octree in place of shadow maps.
#include "octavo/light/light_cells.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>

#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"
#include "octavo/light/gather.h"

namespace octavo {
namespace {

constexpr int kStarts = 4;   // places of a side's surface that its rays start from
constexpr int kColumns = 4;  // along each edge of a cell: where these places are looked for
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

double distance(const Box& a, const Box& b) {
    return glm::length(glm::max(dvec3(0.0), glm::max(a.low - b.high, b.low - a.high)));
}

}  // namespace

/// The light of one object's cells, in all its stages.
struct ObjectLight {
    std::uint32_t object = 0;
    std::vector<Side> sides;
    std::vector<Block> blocks;
    std::vector<vec3> from_lamps, from_sources;  // of each side
    std::vector<std::vector<vec3>> reflected;    // for each number of bounces, from 1
    // What it sums up to, as it is stored, for each number of bounces, from 0.
    std::vector<std::shared_ptr<std::vector<std::uint32_t>>> words;
};

class CellLighter::State {
public:
    State(LitScene& scene, const LightOptions& options) : scene_(scene), options_(options) {
        check(options);
        world_.emplace(scene_);
        with_threads(options_.threads, [&] {
            for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) {
                objects_.emplace_back();
                objects_.back().object = i;
                if (!scene_.objects[i].attributes.empty()) find_sides(objects_.back());
            }
        });
    }

    LightReport light_all() {
        std::vector<std::uint32_t> all;
        for (std::uint32_t i = 0; i < objects_.size(); ++i) all.push_back(i);
        return light_objects(all);
    }

    LightReport light_objects(const std::vector<std::uint32_t>& which) {
        start_report(which, static_cast<std::uint64_t>(options_.bounces) + 1);
        with_threads(options_.threads, [&] {
            show_bounce(0);
            for (const std::uint32_t i : which)
                for_blocks(objects_[i], {}, [&](ObjectLight& o, const Block& block) {
                    gather(o, block, LightFrom::lamps, 0, o.from_lamps);
                    gather(o, block, LightFrom::sources, 0, o.from_sources);
                    write(o, block, 0);
                });
            for (int bounce = 1; bounce <= options_.bounces; ++bounce) {
                show_bounce(bounce - 1);
                for (const std::uint32_t i : which)
                    for_blocks(objects_[i], {}, [&](ObjectLight& o, const Block& block) {
                        gather(o, block, LightFrom::cells, bounce,
                               o.reflected[static_cast<std::size_t>(bounce) - 1]);
                        write(o, block, bounce);
                    });
            }
            show_bounce(options_.bounces);
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
        std::vector<std::uint32_t> all;
        for (std::uint32_t i = 0; i < objects_.size(); ++i) all.push_back(i);
        start_report(all, 0);
        with_threads(options_.threads, [&] {
            Changes changes = redo_lamps(changed);
            for (int bounce = 1; bounce <= options_.bounces; ++bounce)
                changes = redo_bounce(bounce, changes);
            show_bounce(options_.bounces);
        });
        return finish_report();
    }

    LightReport move_object(std::size_t which, const dmat4& placement) {
        if (which == 0 || which >= objects_.size())
            throw Error(Errc::bad_argument, "there is no object with this number that can move");
        const dmat4 old = scene_.objects[which].placement;
        scene_.objects[which].placement = placement;
        try {
            world_.emplace(scene_);
        } catch (...) {
            scene_.objects[which].placement = old;
            world_.emplace(scene_);
            throw;
        }
        const auto i = static_cast<std::uint32_t>(which);
        place_blocks(objects_[i]);
        return light_objects({i});
    }

    [[nodiscard]] std::uint64_t size_bytes() const {
        std::uint64_t bytes = 0;
        for (const ObjectLight& o : objects_) {
            bytes += o.sides.size() * (sizeof(Side) + (2 + o.reflected.size()) * sizeof(vec3));
            for (const auto& words : o.words) bytes += words->size() * sizeof(std::uint32_t);
        }
        return bytes;
    }

private:
    /// For each object and block the flux by which it changed, at most: of radiance times area, in
    /// square units of common space.
    using Changes = std::vector<std::vector<double>>;

    [[nodiscard]] double cell_width(const ObjectLight& o) const {
        const LitObject& object = scene_.objects[o.object];
        return std::ldexp(1.0, object.dag.depth() - object.attributes.level());
    }

    void find_sides(ObjectLight& o) {
        const LitObject& object = scene_.objects[o.object];
        const CellIndex& cells = object.attributes.cells();
        if (cells.count() > CellLight::kMostCells)
            throw Error(Errc::limit, "light is for at most 715 million cells; this object has " +
                                         std::to_string(cells.count()));
        // A small file may have attributes of very many cells, where they are all alike.
        const std::uint64_t bytes = 6 * sizeof(std::uint32_t) * cells.count() *
                                    (static_cast<std::uint64_t>(options_.bounces) + 1);
        if (bytes > machine_memory_bytes() / 2)
            throw Error(Errc::limit,
                        "the light of " + std::to_string(cells.count()) + " cells and " +
                            std::to_string(options_.bounces) + " bounces takes " +
                            std::to_string(bytes) +
                            " bytes, which is more than half of this machine's memory");
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
        place_blocks(o);
        o.from_lamps.resize(o.sides.size(), vec3(0.0f));
        o.from_sources.resize(o.sides.size(), vec3(0.0f));
        o.reflected.resize(static_cast<std::size_t>(options_.bounces));
        for (auto& some : o.reflected) some.resize(o.sides.size(), vec3(0.0f));
        for (int bounce = 0; bounce <= options_.bounces; ++bounce)
            o.words.push_back(std::make_shared<std::vector<std::uint32_t>>(6 * cells.count(),
                                                                           CellLight::kHidden));
    }

    void place_blocks(ObjectLight& o) const {
        const CellIndex& cells = scene_.objects[o.object].attributes.cells();
        const double width = cell_width(o);
        const dmat4& to_common = world_->instances().to_common(o.object);
        tbb::parallel_for(std::size_t{0}, o.blocks.size(), [&](std::size_t b) {
            Block& block = o.blocks[b];
            block.box = {};
            const CellRange range{o.sides[block.first].cell, o.sides[block.end - 1].cell + 1ull};
            Box box;
            cells.for_each(range, [&](std::uint64_t, const uvec3& at) {
                box.extend(width * dvec3(at));
                box.extend(width * (dvec3(at) + 1.0));
            });
            for (unsigned i = 0; i < 8; ++i)
                block.box.extend(dvec3(to_common * dvec4(i & 1 ? box.high.x : box.low.x,
                                                         i & 2 ? box.high.y : box.low.y,
                                                         i & 4 ? box.high.z : box.low.z, 1.0)));
        });
    }

    /// The places on the surface of a cell, seen from a direction, that face open space: rays that
    /// start there, on the face of a voxel. At most kStarts.
    static int find_starts(const LitObject& object, const uvec3& at, int direction,
                           std::uint32_t seed, std::array<shared::GridRay, kStarts>& starts) {
        const shared::DagView dag = shared::view(object.dag);
        const int width = 1 << (object.dag.depth() - object.attributes.level());
        const int axis = direction / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        const bool high = (direction & 1) == 1;
        const ivec3 corner = ivec3(at) * width;
        const ivec3 before = shared::step_across(direction);
        int count = 0;
        if (width == 1) {
            if (shared::cell_exists(dag, corner + before, 0)) return 0;
            for (int i = 0; i < kStarts; ++i) {
                const vec2 square = shared::sample_2d(static_cast<std::uint32_t>(i), seed);
                shared::GridRay& start = starts[static_cast<std::size_t>(count++)];
                start.cell = corner;
                start.cell[axis] += high ? 1 : 0;
                start.frac[axis] = 0.0f;
                start.frac[u] = square.x;
                start.frac[v] = square.y;
                start.t_min = 0.0f;
            }
            return count;
        }
        for (int i = 0; i < kColumns * kColumns && count < kStarts; ++i) {
            // Sobol's points fill the square evenly from the first on.
            const vec2 square = shared::sample_2d(static_cast<std::uint32_t>(i), seed);
            dvec3 from = dvec3(corner);
            from[axis] += high ? width : 0.0;
            from[u] += static_cast<double>(square.x) * width;
            from[v] += static_cast<double>(square.y) * width;
            const vec3 inwards = -vec3(before);
            const shared::GridRay ray = grid_ray(from, inwards, static_cast<float>(width));
            const shared::GridHit hit = shared::trace_closest(dag, ray, {0, 0.0f, 0.0f});
            if (hit.face != direction) continue;
            if (shared::cell_exists(dag, ivec3(hit.path) + before, 0)) continue;
            starts[static_cast<std::size_t>(count++)] = shared::leave_hit(ray, hit, -inwards);
        }
        return count;
    }

    static std::uint32_t seed_of(const uvec3& at, int direction, int pass) {
        return shared::pixel_seed(at.x + (at.y << 16), at.z * 6u + static_cast<unsigned>(direction),
                                  static_cast<std::uint32_t>(pass));
    }

    /// The normal of the surface that is seen from a direction; none where there is none.
    static std::optional<vec3> side_normal(const LitObject& object, const uvec3& at,
                                           int direction) {
        std::array<shared::GridRay, kStarts> starts{};
        if (find_starts(object, at, direction, seed_of(at, direction, 0), starts) == 0)
            return std::nullopt;
        // Of the cell as a whole, seen through its face, where that is open; else of its voxels.
        const shared::DagView dag = shared::view(object.dag);
        const int height = object.dag.depth() - object.attributes.level();
        shared::GridHit hit{0.0f, at, height, direction, 0};
        if (height > 0 &&
            shared::cell_exists(dag, ivec3(at) + shared::step_across(direction), height)) {
            const dvec3 inside = origin_of(starts[0]) - 0.5 * dvec3(shared::step_across(direction));
            hit.path = uvec3(inside);
            hit.height = 0;
        }
        return smooth_normal(dag, starts[0], hit);
    }

    template <class Work>
    void for_blocks(ObjectLight& o, const std::vector<std::uint8_t>& some, const Work& work) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, o.blocks.size(), 1),
                          [&](const auto& range) {
                              for (std::size_t b = range.begin(); b != range.end(); ++b) {
                                  if (!some.empty() && some[b] == 0) continue;
                                  work(o, o.blocks[b]);
                                  add_progress(o.blocks[b].end - o.blocks[b].first);
                              }
                          });
    }

    /// Finds the light of one kind that falls on the sides of a block.
    void gather(ObjectLight& o, const Block& block, LightFrom from, int pass,
                std::vector<vec3>& light) {
        const LitObject& object = scene_.objects[o.object];
        const CellIndex& cells = object.attributes.cells();
        Gatherer gatherer(*world_, from,
                          {options_.lamp_rays, options_.around_rays, options_.source_rays, false},
                          kStarts);
        std::array<shared::GridRay, kStarts> starts{};
        for (std::size_t i = block.first; i < block.end; ++i) {
            const Side& side = o.sides[i];
            const uvec3 at = cells.cell(side.cell);
            const std::uint32_t seed = seed_of(at, side.direction(), 0);
            const int count = find_starts(object, at, side.direction(), seed, starts);
            gatherer.begin();
            for (int part = 0; part < kStarts; ++part)
                gatherer.add(world_->point(o.object, starts[static_cast<std::size_t>(part % count)],
                                           side.direction(), side.normal()),
                             part, seed_of(at, side.direction(), pass + 1));
        }
        gatherer.trace();
        for (std::size_t i = block.first; i < block.end; ++i)
            light[i] = gatherer.light(i - block.first);
        rays_ += gatherer.rays_traced();
        sides_done_ += block.end - block.first;
    }

    [[nodiscard]] vec3 sum(const ObjectLight& o, std::size_t side, int bounce) const {
        vec3 light = o.from_lamps[side] + o.from_sources[side];
        if (bounce > 0) light += o.reflected[static_cast<std::size_t>(bounce) - 1][side];
        return light;
    }

    /// Stores what the light of a block sums up to. @return the flux by which it changed
    double write(ObjectLight& o, const Block& block, int bounce) {
        std::vector<std::uint32_t>& words = *o.words[static_cast<std::size_t>(bounce)];
        double flux = 0.0;
        for (std::size_t i = block.first; i < block.end; ++i) {
            const Side& side = o.sides[i];
            std::uint32_t& word =
                words[6 * std::size_t{side.cell} + static_cast<std::size_t>(side.direction())];
            const std::uint32_t next = pack_rgb9e5(sum(o, i, bounce));
            if (next == word) continue;
            const vec3 change = glm::abs(unpack_rgb9e5(next) - unpack_rgb9e5(word));
            const CellSide cell{o.object, side.cell, side.direction()};
            flux += static_cast<double>(greatest(change * world_->albedo(cell)));
            word = next;
        }
        // A cell shows at most sqrt(3) of its face's area in any direction.
        const dvec3 edge(world_->instances().to_common(o.object)[0]);
        const double width = cell_width(o) * glm::length(edge);
        return 1.74 * flux * width * width;
    }

    /// Lets rays see the light after this many bounces.
    void show_bounce(int bounce) {
        for (ObjectLight& o : objects_) {
            if (o.words.empty()) continue;
            const auto& words = o.words[static_cast<std::size_t>(bounce)];
            LitObject& object = scene_.objects[o.object];
            object.light = CellLight(object.attributes.level(), bounce, *words, words);
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
            for_blocks(o, some, [&](ObjectLight& lit, const Block& block) {
                gather(lit, block, LightFrom::lamps, 0, lit.from_lamps);
                flux[static_cast<std::size_t>(&block - lit.blocks.data())] = write(lit, block, 0);
            });
            changes.push_back(std::move(flux));
        }
        return changes;
    }

    [[nodiscard]] static bool reaches(const Light& light, const Box& box) {
        const double reach = light_reach(light, LightGrid::kLeast);
        if (!std::isfinite(reach)) return true;
        Box lamp;
        lamp.extend(light.position);
        for (const auto& t : light.triangles)
            for (const dvec3& corner : t) lamp.extend(corner);
        if (!light.triangles.empty()) lamp.extend(lamp.centre());
        return distance(lamp, box) <= reach;
    }

    /// Gathers a bounce anew where the light before it changed by enough.
    Changes redo_bounce(int bounce, const Changes& before) {
        show_bounce(bounce - 1);
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
                for (const Source& source : sources) {
                    // Irradiance over pi of a flux at this distance; nearer, of one that fills the
                    // view with no more than its own radiance.
                    const double way = distance(*source.box, o.blocks[b].box);
                    bound += source.flux / (std::numbers::pi * std::max(way * way, 1.0));
                    if (bound > options_.tolerance) break;
                }
                some[b] = bound > options_.tolerance ? 1 : 0;
            });
            const auto index = static_cast<std::size_t>(bounce) - 1;
            for_blocks(o, some, [&](ObjectLight& lit, const Block& block) {
                gather(lit, block, LightFrom::cells, bounce, lit.reflected[index]);
            });
            // Blocks whose direct light alone changed have another sum too.
            tbb::parallel_for(std::size_t{0}, o.blocks.size(),
                              [&](std::size_t b) { flux[b] = write(o, o.blocks[b], bounce); });
            changes.push_back(std::move(flux));
        }
        return changes;
    }

    void start_report(const std::vector<std::uint32_t>& which, std::uint64_t passes) {
        report_ = {};
        rays_ = sides_done_ = 0;
        done_ = next_ = total_ = 0;
        for (const std::uint32_t i : which) {
            report_.cells += scene_.objects[i].attributes.cells().count();
            report_.sides += objects_[i].sides.size();
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
