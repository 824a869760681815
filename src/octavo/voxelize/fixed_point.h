// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "octavo/core/grid.h"
#include "octavo/core/prefetch.h"
#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// A corner in fixed point. Padded to 16 bytes so that one load fetches it.
struct alignas(16) FixedPoint {
    std::int32_t x, y, z;
    std::int32_t kind;  // see FixedMesh
};

/// A scene's triangles with every corner rounded once to an integer grid that is finer than the
/// voxels. From here on all geometry is exact integer arithmetic, so no answer depends on how space
/// is cut.
///
/// A unit is 2^-fraction_bits of a voxel. Coordinates are relative to `base`, a voxel, so that they
/// stay small: 0 <= coordinate <= 2^25 + 1. The scene (the part of it within one grid width of the
/// grid) is at least 2^24 units across in its longest direction, and a voxel 2^6 to 2^24 units; so
/// a scene smaller than a voxel has fewer across.
///
/// Triangles that reach further than one grid width from the grid are first clipped, in double
/// precision, to the cube of three grid widths around it; what is left of them is rounded like the
/// rest. So a vertex outside that cube cannot overflow, and geometry that is inside is not changed
/// by it.
class FixedMesh {
public:
    FixedMesh(const Scene& scene, const Grid& grid) : FixedMesh(scene, grid, scene.bounds()) {}

    /// For a piece of a larger scene, rounded as the whole one is.
    /// @param bounds  of the whole scene
    FixedMesh(const Scene& piece, const Grid& grid, const Box& bounds);

    /// How corners are written: equal for all pieces of a scene.
    struct Frame {
        int fraction_bits = 0;
        ivec3 base{0};
    };

    /// Of triangles that have been rounded before.
    FixedMesh(const Frame& frame, std::vector<std::array<FixedPoint, 3>> triangles)
        : frame_(frame), clipped_(std::move(triangles)) {}

    // The spans stay valid: the storage of a vector moves along.
    FixedMesh(FixedMesh&&) = default;
    FixedMesh& operator=(FixedMesh&&) = default;

    /// Takes the scene's own list of triangles, so that the scene need not outlive this.
    void keep_triangles(std::vector<uvec3> triangles) {
        kept_triangles_ = std::move(triangles);
        scene_triangles_ = kept_triangles_;
    }

    /// Number of triangles to voxelize. Non-finite ones are among them; see `corners`.
    [[nodiscard]] std::size_t size() const { return scene_triangles_.size() + clipped_.size(); }

    /// The corners of a triangle; false where there is nothing to voxelize (non-finite, or replaced
    /// by its clipped pieces).
    [[nodiscard]] bool corners(std::size_t triangle, std::array<FixedPoint, 3>& out) const {
        const std::size_t count = scene_triangles_.size();
        if (triangle < count) {
            const uvec3& t = scene_triangles_[triangle];
            out = {points_[t.x], points_[t.y], points_[t.z]};
            return (out[0].kind | out[1].kind | out[2].kind) == kInside;
        }
        out = clipped_[triangle - count];
        return true;
    }

    /// Starts to fetch what corners() looks at first; and, when that has had time to arrive, next.
    void prefetch_triangle(std::size_t triangle) const {
        const std::size_t count = scene_triangles_.size();
        if (triangle < count)
            prefetch_line(&scene_triangles_[triangle]);
        else
            prefetch_line(&clipped_[triangle - count]);
    }
    void prefetch_corners(std::size_t triangle) const {
        if (triangle >= scene_triangles_.size()) return;
        const uvec3& t = scene_triangles_[triangle];
        prefetch_line(&points_[t.x]);
        prefetch_line(&points_[t.y]);
        prefetch_line(&points_[t.z]);
    }

    /// The scene's triangle that this is, or is a clipped piece of.
    [[nodiscard]] std::size_t scene_triangle(std::size_t triangle) const {
        const std::size_t count = scene_triangles_.size();
        return triangle < count ? triangle : clipped_from_[triangle - count];
    }

    [[nodiscard]] const Frame& frame() const { return frame_; }
    [[nodiscard]] int fraction_bits() const { return frame_.fraction_bits; }
    [[nodiscard]] const ivec3& base() const { return frame_.base; }

    [[nodiscard]] std::uint64_t degenerate_triangles() const { return degenerate_; }
    [[nodiscard]] std::uint64_t non_finite_triangles() const { return non_finite_; }

private:
    static constexpr std::int32_t kInside = 0;
    static constexpr std::int32_t kFar = 1;
    static constexpr std::int32_t kNonFinite = 2;

    void choose_precision(const Box& bounds, const Grid& grid);
    void round_points(const Scene& scene, const Grid& grid);
    void count_and_clip(const Scene& scene, const Grid& grid);
    [[nodiscard]] FixedPoint round(const dvec3& point_grid) const;

    Frame frame_;
    std::span<const uvec3> scene_triangles_;
    std::vector<uvec3> kept_triangles_;
    std::vector<FixedPoint> points_;
    std::vector<std::array<FixedPoint, 3>> clipped_;
    std::vector<std::size_t> clipped_from_;
    std::uint64_t degenerate_ = 0;
    std::uint64_t non_finite_ = 0;
};

/// Twice the triangle's area is zero: its corners lie on a line or in a point.
[[nodiscard]] bool is_degenerate(const std::array<FixedPoint, 3>& corners);

}  // namespace octavo
