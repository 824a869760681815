// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "octavo/mesh/opacity_map.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// Where each triangle of a scene has holes: what its material's alpha makes of it.
class HoleMaps {
public:
    /// Cost: the pixels of textures with holes. @param scene  such textures are decoded
    explicit HoleMaps(const Scene& scene);

    /// Whether no triangle has holes.
    [[nodiscard]] bool empty() const { return maps_of_.empty(); }

    struct Holes {
        bool any = false;
        const OpacityMap* map = nullptr;  // of the texture; none: all of the triangle is hole
    };
    [[nodiscard]] Holes of(std::size_t triangle) const {
        if (maps_of_.empty() || maps_of_[triangle] == kNoHoles) return {};
        return {true, maps_of_[triangle] == kAllHole ? nullptr : &maps_[maps_of_[triangle]]};
    }

    /// Gives back what of() needs. The maps that it gave stay good.
    void forget_triangles() { maps_of_ = {}; }

    /// A number that differs where the holes do.
    [[nodiscard]] std::uint64_t hash() const { return hash_; }

private:
    static constexpr std::uint32_t kNoHoles = 0xffffffffu, kAllHole = 0xfffffffeu;

    std::vector<OpacityMap> maps_;
    std::vector<std::uint32_t> maps_of_;  // for each triangle an index; or empty
    std::uint64_t hash_ = 0;
};

}  // namespace octavo
