// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "octavo/light/cell_words.h"
#include "octavo/light/kept_ends.h"
#include "octavo/light/light_cells.h"
#include "octavo/light/lit_sides.h"
#include "octavo/light/lit_world.h"

namespace octavo {

/// The light of one object's cells, in all its stages.
struct ObjectLight : ObjectSides {
    std::vector<vec3> from_lamps, from_sources;  // of each side
    std::vector<std::vector<vec3>> reflected;    // for each pass, from 1
    std::vector<std::uint32_t> rows;  // if they are kept: for each side and ray over its hemisphere
                                      // the word that the ray met
};

/// The light of all sides of a scene's cells: direct light, bounces one after the other, and what
/// is stored of their sum. Each step is for one block of an object, and may run beside others of
/// other blocks; which blocks are done when is CellLighter's business.
class SideLight {
public:
    /// @throws Error  as CellLighter
    SideLight(LitScene& scene, const LightOptions& options);

    [[nodiscard]] std::vector<ObjectLight>& objects() { return objects_; }
    [[nodiscard]] const LitWorld& world() const { return *world_; }
    /// The scene's lights or places have changed.
    void renew_world() { world_.emplace(scene_); }

    /// Finds the light of the lamps.
    void gather_lamps(ObjectLight& o, const SideBlock& block);

    /// Finds the light of the sky and of shining cells, and what cells the rays meet.
    void gather_around(ObjectLight& o, const SideBlock& block);

    /// The same after an object moved: only rays that it may touch are traced, the others ended
    /// where they end. The same bits as gather_around(), if what the block's rays met is kept and
    /// was that of the world before. Not under an uneven sky.
    void gather_around(ObjectLight& o, const SideBlock& block, const MovedObject& moved);

    /// Whether what rays met is kept.
    [[nodiscard]] bool keeps_rows() const { return keeps_rows_; }

    /// How often light is gathered from the light before it: for each bounce, and once more where
    /// the rest is estimated. How even the light is differs from side to side, and so does how
    /// wrong the estimate is: what is shown has its mean over all that a side sees.
    [[nodiscard]] int passes() const { return options_.bounces + (closes() ? 1 : 0); }

    /// What each side of a cell sends back, by its word; as four numbers, which are read at once.
    /// A pass asks for each of them many times.
    using Sent = std::vector<vec4>;
    /// Of the light before a bounce. @param bounce  1 to passes()
    [[nodiscard]] Sent sent_before(int bounce) const;

    /// Gathers a bounce. @param sent  of the light before it
    void reflect(ObjectLight& o, const SideBlock& block, int bounce, const Sent& sent);

    /// Finds for each side what a light that is even around it adds up to by being sent on again
    /// and again: the sum over k of A^k 1, where A is one bounce. The first terms are found one by
    /// one; from then on they are taken to shrink by a constant ratio, that of the last two.
    /// Nothing where the options ask for no such estimate.
    void find_rest();

    /// The same for sides that look at other things now: one step from what is known.
    /// @param some  for each object and block whether it is one of theirs
    void find_rest(const std::vector<std::vector<std::uint8_t>>& some);

    /// Stores what the light of a block sums up to. @return the flux by which it changed
    double write(ObjectLight& o, const SideBlock& block, int bounce);

    /// Lets others see the light.
    void show();

    /// Since the last call of start_counting().
    [[nodiscard]] std::uint64_t rays() const { return rays_; }
    [[nodiscard]] std::uint64_t sides_done() const { return sides_done_; }
    void start_counting() { rays_ = sides_done_ = 0; }

    [[nodiscard]] std::uint64_t size_bytes() const;

private:
    using Words = std::vector<std::uint32_t>;

    void check_size();
    [[nodiscard]] bool closes() const { return options_.estimate_rest && options_.bounces > 0; }
    [[nodiscard]] std::size_t row_length() const {
        return static_cast<std::size_t>(options_.around_rays);
    }
    [[nodiscard]] std::span<std::uint32_t> row_space(ObjectLight& o, const SideBlock& block,
                                                     Words& scratch) const;
    [[nodiscard]] std::span<const std::uint32_t> rows(ObjectLight& o, const SideBlock& block,
                                                      Words& scratch);
    void gather_rows(ObjectLight& o, const SideBlock& block, std::span<std::uint32_t> rows,
                     const MovedObject* moved = nullptr);
    [[nodiscard]] Sent sent_back(const Words& light, float more) const;
    [[nodiscard]] vec3 sum(const ObjectLight& o, std::size_t side, int bounce) const;

    /// Calls visit(side, row) for the sides of a block.
    template <class Visit>
    void for_rows(ObjectLight& o, const SideBlock& block, const Visit& visit);
    /// Calls begin(side, cell) for each side of a block, and where that is true add(point, part,
    /// seed) for the points that its rays start from.
    template <class Begin, class Add>
    void for_points(const ObjectLight& o, const SideBlock& block, int pass, const Begin& begin,
                    const Add& add) const;

    LitScene& scene_;
    LightOptions options_;
    std::optional<LitWorld> world_;
    std::vector<ObjectLight> objects_;
    CellWords cells_;
    std::vector<std::shared_ptr<Words>> words_;  // the light as it is stored, after each pass from
                                                 // 0; with the rest from that of all bounces on
    Words rest_;  // of each side, what an even light around it adds up to; see find_rest()
    bool keeps_rows_ = false;
    std::atomic<std::uint64_t> rays_ = 0, sides_done_ = 0;
};

}  // namespace octavo
