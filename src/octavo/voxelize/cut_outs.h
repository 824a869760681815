// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "octavo/core/grid.h"
#include "octavo/core/vec.h"
#include "octavo/mesh/hole_maps.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// The holes that alpha textures make in the triangles of a scene: the rule for cut-outs of
/// docs/voxel-rules.md. Nothing here depends on tiles, and everything is computed in double.
class CutOuts {
public:
    /// Cost: the textures' pixels. @param scene  its textures decoded; outlives this
    CutOuts(const Scene& scene, const Grid& grid) : scene_(scene), grid_(grid), maps_(scene) {}

    /// Whether any triangle of the scene has holes.
    [[nodiscard]] bool empty() const { return maps_.empty(); }

    /// One triangle with holes.
    class Triangle {
    public:
        /// Those of a block's voxels that are no hole.
        /// @param block   in blocks of 4x4x4 voxels, grid space
        /// @param voxels  in Morton order
        [[nodiscard]] std::uint64_t keep(const ivec3& block, std::uint64_t voxels) const;

    private:
        friend class CutOuts;
        [[nodiscard]] OpacityMap::Found find(const ivec3& low, int width, int margin) const;

        const OpacityMap* map_ = nullptr;  // none: all of it is hole
        int u_ = 0, v_ = 1;                // the plane that it looks most towards
        glm::dvec2 first_{0.0};            // pixels at the grid's corner
        glm::dvec2 along_u_{0.0}, along_v_{0.0};
        glm::dvec2 low_{0.0}, high_{0.0};  // of the corners
    };

    /// The triangle with its holes. @return false where it has none
    [[nodiscard]] bool find(std::size_t scene_triangle, Triangle& out) const;

    /// Gives back what find() needs. The triangles that it found stay good.
    void forget_triangles() { maps_.forget_triangles(); }

    /// A number that differs where the holes do.
    [[nodiscard]] std::uint64_t hash() const { return maps_.hash(); }

private:
    const Scene& scene_;
    Grid grid_;
    HoleMaps maps_;
};

/// The holes of triangles that are known by a number of their own.
class HoleLookup {
public:
    virtual ~HoleLookup() = default;

    /// @return false where the triangle has none
    [[nodiscard]] virtual bool find(std::size_t triangle, CutOuts::Triangle& out) const = 0;
};

}  // namespace octavo
