// SPDX-License-Identifier: MIT
//
// After Josh Klint's post "Sparse Voxel Octrees" ([J]): one value for each of six directions, only
// for cells that exist; direct light by rays in the octree in place of shadow maps. Here is which
// blocks of cells are lit when, and after a change which again; how is in side_light.h.
#include "octavo/light/light_cells.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <utility>

#include "octavo/core/error.h"
#include "octavo/core/parallel.h"
#include "octavo/core/progress_counter.h"
#include "octavo/light/change_reach.h"
#include "octavo/light/side_light.h"

namespace octavo {

class CellLighter::State {
public:
    State(LitScene& scene, const LightOptions& options)
        : scene_(scene),
          options_(options),
          sides_(scene, options),
          rows_hold_(scene.objects.size()) {}

    LightReport light_all() {
        start_report(static_cast<std::uint64_t>(sides_.passes()) + 1);
        with_threads(options_.threads, [&] {
            for (ObjectLight& o : sides_.objects()) {
                for_blocks(o, {}, [&](const SideBlock& block, std::size_t) {
                    sides_.gather_lamps(o, block);
                    sides_.gather_around(o, block);
                    sides_.write(o, block, 0);
                });
                rows_hold_[o.object].assign(o.blocks.size(), 1);
            }
            sides_.find_rest();
            for (int bounce = 1; bounce <= sides_.passes(); ++bounce) {
                const SideLight::Sent sent = sides_.sent_before(bounce);
                for (ObjectLight& o : sides_.objects())
                    for_blocks(o, {}, [&](const SideBlock& block, std::size_t) {
                        sides_.reflect(o, block, bounce, sent);
                        sides_.write(o, block, bounce);
                    });
            }
            sides_.show();
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
        sides_.renew_world();
        start_report(0);
        with_threads(options_.threads, [&] {
            Changes changes = redo_lamps(changed);
            for (int bounce = 1; bounce <= sides_.passes(); ++bounce)
                changes = redo_bounce(bounce, changes, {});
            sides_.show();
        });
        return finish_report();
    }

    LightReport move_object(std::size_t which, const dmat4& placement) {
        if (which == 0 || which >= sides_.objects().size())
            throw Error(Errc::bad_argument, "there is no object with this number that can move");
        const auto moved = static_cast<std::uint32_t>(which);
        ObjectLight& o = sides_.objects()[which];
        const dmat4 old = scene_.objects[which].placement;
        const Box before = object_box(scene_, sides_.world(), o);
        const Box wide_before = box_with_margin(scene_, sides_.world(), o);
        scene_.objects[which].placement = placement;
        try {
            sides_.renew_world();
        } catch (...) {
            scene_.objects[which].placement = old;
            sides_.renew_world();
            throw;
        }
        start_report(0);
        with_threads(options_.threads, [&] {
            place_blocks(scene_, sides_.world(), o);
            const Box after = object_box(scene_, sides_.world(), o);
            Flags looked_around;
            Changes changes =
                redo_around_object({moved, wide_before, box_with_margin(scene_, sides_.world(), o)},
                                   {ball_of(before), ball_of(after)}, looked_around);
            for (int bounce = 1; bounce <= sides_.passes(); ++bounce)
                changes = redo_bounce(bounce, changes, looked_around);
            sides_.show();
        });
        return finish_report();
    }

    [[nodiscard]] std::uint64_t size_bytes() const { return sides_.size_bytes(); }

private:
    /// For each object and block the flux by which it changed, at most: of radiance times area, in
    /// square units of common space.
    using Changes = std::vector<std::vector<double>>;
    /// For each object and block 1 or 0; empty: none.
    using Flags = std::vector<std::vector<std::uint8_t>>;

    /// Calls work(block, number) for some of an object's blocks. @param some  empty: for all
    template <class Work>
    void for_blocks(ObjectLight& o, const std::vector<std::uint8_t>& some, const Work& work) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, o.blocks.size(), 1),
                          [&](const auto& range) {
                              for (std::size_t b = range.begin(); b != range.end(); ++b) {
                                  if (!some.empty() && some[b] == 0) continue;
                                  work(o.blocks[b], b);
                                  progress_->add(o.blocks[b].end - o.blocks[b].first);
                              }
                          });
    }

    Changes redo_lamps(const std::vector<Light>& changed) {
        const Grid& grid = sides_.world().instances().grid();
        Changes changes;
        for (ObjectLight& o : sides_.objects()) {
            std::vector<std::uint8_t> some(o.blocks.size(), 0);
            std::vector<double> flux(o.blocks.size(), 0.0);
            for (std::size_t b = 0; b < some.size(); ++b)
                for (const Light& light : changed) {
                    const Box box{grid.to_world(o.blocks[b].box.low),
                                  grid.to_world(o.blocks[b].box.high)};
                    const bool near = reaches(light, box);
                    some[b] = some[b] != 0 || near ? 1 : 0;
                }
            for_blocks(o, some, [&](const SideBlock& block, std::size_t b) {
                sides_.gather_lamps(o, block);
                flux[b] = sides_.write(o, block, 0);
            });
            changes.push_back(std::move(flux));
        }
        return changes;
    }

    /// For each block of an object what a move may have changed of it.
    struct Touched {
        std::vector<std::uint8_t> lamps, around;  // what comes straight from them
        std::vector<std::uint8_t> any;
    };
    /// @param balls  around the places where the moved object was and is
    [[nodiscard]] Touched touched_blocks(const ObjectLight& o, const MovedObject& moved,
                                         const std::array<Ball, 2>& balls) const {
        const std::size_t count = o.blocks.size();
        const bool all = o.object == moved.object;
        const Grid& grid = sides_.world().instances().grid();
        const Box& shining = sides_.world().emitters().bounds();
        Touched touched{Flags::value_type(count, 0), Flags::value_type(count, 0),
                        Flags::value_type(count, 0)};
        for (std::size_t b = 0; b < count; ++b) {
            const Box& box = o.blocks[b].box;
            bool lamps = all, around = all || scene_.sky.uneven();
            for (const Ball& ball : balls) {
                for (const Light& light : scene_.lights)
                    lamps = lamps || shades(ball, light, box, grid);
                around = around || covered(box, ball) > options_.move_tolerance ||
                         (!shining.empty() && between(ball, ball_of(box), ball_of(shining)));
            }
            touched.lamps[b] = lamps ? 1 : 0;
            touched.around[b] = around ? 1 : 0;
            touched.any[b] = lamps || around ? 1 : 0;
        }
        return touched;
    }

    /// Redoes what comes straight from lamps and from around where an object was or is.
    /// @param balls          around these places
    /// @param looked_around  gets the blocks whose rays over the hemisphere were sent again
    Changes redo_around_object(const MovedObject& moved, const std::array<Ball, 2>& balls,
                               Flags& looked_around) {
        const bool can_keep = sides_.keeps_rows() && !scene_.sky.uneven();
        Changes changes;
        for (ObjectLight& o : sides_.objects()) {
            Touched touched = touched_blocks(o, moved, balls);
            // Blocks that do not look around have rows of before the move from now on.
            std::vector<std::uint8_t>& hold = rows_hold_[o.object];
            hold.resize(o.blocks.size(), 0);
            const std::vector<std::uint8_t> held =
                std::exchange(hold, Flags::value_type(hold.size(), 0));
            std::vector<double> flux(o.blocks.size(), 0.0);
            for_blocks(o, touched.any, [&](const SideBlock& block, std::size_t b) {
                if (touched.lamps[b] != 0) sides_.gather_lamps(o, block);
                if (touched.around[b] != 0) {
                    if (can_keep && held[b] != 0 && o.object != moved.object)
                        sides_.gather_around(o, block, moved);
                    else
                        sides_.gather_around(o, block);
                    hold[b] = 1;
                }
                flux[b] = sides_.write(o, block, 0);
            });
            looked_around.push_back(std::move(touched.around));
            changes.push_back(std::move(flux));
        }
        sides_.find_rest(looked_around);
        return changes;
    }

    /// Gathers a bounce anew where the light before it changed by enough.
    /// @param always  blocks that are redone anyway
    Changes redo_bounce(int bounce, const Changes& before, const Flags& always) {
        struct Source {
            const Box* box;
            double flux;
        };
        const std::vector<ObjectLight>& objects = sides_.objects();
        std::vector<Source> sources;
        for (std::size_t i = 0; i < objects.size(); ++i)
            for (std::size_t b = 0; b < before[i].size(); ++b)
                if (before[i][b] > 0.0)
                    sources.push_back({&objects[i].blocks[b].box, before[i][b]});
        const SideLight::Sent sent = sides_.sent_before(bounce);
        Changes changes;
        for (ObjectLight& o : sides_.objects()) {
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
            for_blocks(o, some, [&](const SideBlock& block, std::size_t) {
                sides_.reflect(o, block, bounce, sent);
            });
            // Blocks whose direct light alone changed have another sum too.
            tbb::parallel_for(std::size_t{0}, o.blocks.size(), [&](std::size_t b) {
                flux[b] = sides_.write(o, o.blocks[b], bounce);
            });
            changes.push_back(std::move(flux));
        }
        return changes;
    }

    void start_report(std::uint64_t passes) {
        report_ = {};
        sides_.start_counting();
        for (const ObjectLight& o : sides_.objects()) {
            report_.cells += scene_.objects[o.object].attributes.cells().count();
            report_.sides += o.sides.size();
        }
        progress_.emplace(options_.progress, "light", report_.sides * passes);
    }
    LightReport finish_report() {
        report_.sides_done = sides_.sides_done();
        report_.rays = sides_.rays();
        return report_;
    }

    LitScene& scene_;
    LightOptions options_;
    SideLight sides_;
    Flags rows_hold_;  // where what rays met is what they meet in the world as it is

    LightReport report_;
    std::optional<ProgressCounter> progress_;
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
