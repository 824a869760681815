// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>

#include "octavo/core/progress.h"
#include "octavo/light/lit_scene.h"

namespace octavo {

/// How the light of cells is found. Counts of rays are for each side of a cell.
struct LightOptions {
    static constexpr int kMostBounces = 8;

    int bounces = 2;       // between the first surface that light meets and the last; 0 to 8
    int lamp_rays = 16;    // towards each lamp that reaches the cell; a quarter where they agree
    int around_rays = 64;  // over the hemisphere, for the sky and all bounces together
    int source_rays = 64;  // towards an uneven sky; as many towards cells that shine

    /// Adds what is sent on more than `bounces` times, as far as it is known from what surrounds a
    /// cell; see docs/adr/0024. Nothing with bounces 0.
    bool estimate_rest = true;

    /// Of update(): a side is redone where its light may have changed by more than this, as a part
    /// of white in full light.
    double tolerance = 1.0 / 1024;
    /// Of move_object(): a side looks around anew where the object covers more than this part of
    /// what it sees, before or after.
    double move_tolerance = 1.0 / 32;

    /// For what each ray met, 4 bytes each, kept for all bounces and for changes. Where that does
    /// not fit, rays are traced for each bounce; the result is the same.
    std::uint64_t kept_bytes = std::uint64_t{1} << 30;

    int threads = 0;                 // 0: all; the result does not depend on it
    ProgressFunction progress = {};  // phase "light", in sides of cells, all passes together
};

/// What was done.
struct LightReport {
    std::uint64_t cells = 0;       // of the objects that were looked at
    std::uint64_t sides = 0;       // of these cells, those that can be seen
    std::uint64_t sides_done = 0;  // that were found anew, every pass counted
    std::uint64_t rays = 0;
};

/// Keeps the light of a scene's cells up to date: [J]'s lit voxels.
///
/// Direct light comes by shadow rays in the geometry itself. Rays over the hemisphere bring the
/// light of the sky and remember which cells they met, so that a bounce reads the light of these
/// without a ray. Each side of a cell sends its rays from four places of its surface, found by rays
/// from the face of the cell inwards: so they begin on the voxels, and neither hit their own cell
/// nor skip a wall that is thinner than it.
///
/// The result is the same for any number of threads, and the same again each time.
class CellLighter {
public:
    /// @param scene   outlives this; its objects' `light` is written. Objects without attributes
    ///                are not lit, but shade the others
    /// @throws Error  bad_argument where an option is out of range; limit where the objects have
    ///                more than CellLight::kMostCells cells together
    /// Cost           a walk over the cells; about 80 bytes for each side, and 12 more for each
    ///                bounce; and options.kept_bytes at most
    CellLighter(LitScene& scene, const LightOptions& options);
    ~CellLighter();
    CellLighter(const CellLighter&) = delete;
    CellLighter& operator=(const CellLighter&) = delete;

    /// Lights every cell. @throws Error cancelled
    LightReport light_all();

    /// Light number `which` of the scene becomes this one; beyond the last it is added.
    ///
    /// Direct light is redone within its reach before and after, and a bounce where the change that
    /// it brings can pass the tolerance: the flux by which each block of cells changed, spread from
    /// where it is, bounds what reaches any other. Everything else stays as it is, to the bit.
    ///
    /// @throws Error  bad_argument where `which` is more than one past the last
    LightReport change_light(std::size_t which, const Light& light);

    /// Moves an object other than the first.
    ///
    /// Its own cells are lit anew, and of the others those that it shades, or takes a part of the
    /// sky or of a shining cell from, where it was or where it is; then bounces as change_light()
    /// does. So the cost is that of what the object reaches. Where a picture is the sky, whose
    /// bright places may shade anything, every cell looks around anew.
    ///
    /// @throws Error  bad_argument where there is no such object, or the placement has no inverse
    LightReport move_object(std::size_t which, const dmat4& placement);

    /// Bytes kept beside the light itself.
    [[nodiscard]] std::uint64_t size_bytes() const;

private:
    class State;
    std::unique_ptr<State> state_;
};

/// Lights every cell of a scene, once.
LightReport light_cells(LitScene& scene, const LightOptions& options);

}  // namespace octavo
