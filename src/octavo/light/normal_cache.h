// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/light/normal.h"
#include "octavo/light/point_text.h"

namespace octavo {

/// The smoothed normals of the cells that a thread has met: close to a surface many pixels share
/// one. A slot holds the last normal that fell on it, which depends on the cell and face alone, so
/// the picture does not depend on what is found here.
class NormalCache {
public:
    vec3 get(const shared::DagView& dag, const shared::GridRay& ray, const shared::GridHit& hit) {
        const std::uint32_t key = shared::mix_bits(
            hit.path.x + shared::mix_bits(hit.path.y + shared::mix_bits(hit.path.z)));
        Entry& entry = entries_[key % entries_.size()];
        if (entry.face != hit.face || entry.height != hit.height || entry.path != hit.path ||
            hit.face == shared::kFaceInside)
            entry = {hit.path, hit.height, hit.face, smooth_normal(dag, ray, hit)};
        return entry.normal;
    }

private:
    struct Entry {
        uvec3 path{0};
        int height = 0;
        int face = shared::kFaceNone;
        vec3 normal{0.0f};
    };
    std::vector<Entry> entries_ = std::vector<Entry>(4096);
};

}  // namespace octavo
