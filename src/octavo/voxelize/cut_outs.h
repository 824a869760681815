// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "octavo/core/grid.h"
#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// Which pixels of a texture are no hole, so that it can be asked of any rectangle of them.
class OpacityMap {
public:
    /// @param texture      decoded
    /// @param least_alpha  alpha from which a pixel is no hole
    OpacityMap(const Texture& texture, int least_alpha);

    /// Of the pixels from `first` to `last`, which may lie beyond the edges, are there any that are
    /// no hole, and any that are?
    struct Found {
        bool solid = false;
        bool hole = false;
    };
    using Pixel = std::array<std::int64_t, 2>;
    [[nodiscard]] Found find(const Pixel& first, const Pixel& last) const;

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] bool all_solid() const { return levels_.back().nodes[0] == kSolid; }

private:
    static constexpr std::uint8_t kSolid = 1, kHole = 2;  // what a square of pixels holds
    struct Level {
        int width, height;
        std::vector<std::uint8_t> nodes;
    };
    [[nodiscard]] std::uint8_t find_in(int level, int x, int y, const std::array<int, 4>& range,
                                       std::uint8_t found) const;

    int width_, height_;
    Texture::Wrap wrap_u_, wrap_v_;
    std::vector<Level> levels_;  // from the pixels to a single node, each half as wide
};

/// The holes that alpha textures make in the triangles of a scene: the rule for cut-outs of
/// docs/voxel-rules.md. Nothing here depends on tiles, and everything is computed in double.
class CutOuts {
public:
    /// Cost: the textures' pixels. @param scene  its textures decoded; outlives this
    CutOuts(const Scene& scene, const Grid& grid);

    /// Whether any triangle of the scene has holes.
    [[nodiscard]] bool empty() const { return maps_of_.empty(); }

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
    void forget_triangles() { maps_of_ = {}; }

    /// A number that differs where the holes do.
    [[nodiscard]] std::uint64_t hash() const { return hash_; }

private:
    static constexpr std::uint32_t kNoHoles = 0xffffffffu, kAllHole = 0xfffffffeu;

    const Scene& scene_;
    Grid grid_;
    std::vector<OpacityMap> maps_;
    std::vector<std::uint32_t> maps_of_;  // for each triangle an index; or empty
    std::uint64_t hash_ = 0;
};

/// The holes of triangles that are known by a number of their own.
class HoleLookup {
public:
    virtual ~HoleLookup() = default;

    /// @return false where the triangle has none
    [[nodiscard]] virtual bool find(std::size_t triangle, CutOuts::Triangle& out) const = 0;
};

}  // namespace octavo
