// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>

#include "octavo/trace/dag_view.h"

namespace octavo {

/// The cells of one height that exist and that a ray is in, in its order: the loop of the shared
/// text, which goes on where that one stops.
class CellWalk {
public:
    /// @param height  0 to depth - 1, and 3 or more
    CellWalk(shared::DagView dag, const shared::GridRay& ray, int height)
        : dag_(dag),
          ray_(shared::mirror_ray(ray.cell, ray.frac, ray.dir, dag.depth)),
          least_(height),
          height_(dag.depth - 1),
          t_(std::max(ray.t_min, shared::max3(shared::plane_time(ray_, ivec3(0))))),
          t_end_(
              std::min(ray.t_max, shared::min3(shared::plane_time(ray_, ivec3(1 << dag.depth))))) {
        nodes_[dag.depth] = 0;
        go_down();
    }

    /// @return false  there are no more
    [[nodiscard]] bool next() {
        if (found_) go_on();
        found_ = false;
        while (t_ < t_end_ && height_ < dag_.depth) {
            const std::uint32_t parent = nodes_[height_ + 1];
            const int child = shared::child_number(((mirrored_ >> height_) & 1) ^ ray_.down);
            if ((shared::dag_load(dag_, parent) >> child & 1u) == 0) {
                go_on();
                continue;
            }
            nodes_[height_] = shared::load_child(dag_, parent, child);
            if (height_ == least_) return found_ = true;
            --height_;
            go_down();
        }
        return false;
    }

    [[nodiscard]] std::uint32_t node() const { return nodes_[least_]; }
    /// Its real low corner.
    [[nodiscard]] ivec3 corner() const {
        const ivec3 last = ray_.down * ((1 << (dag_.depth - least_)) - 1);
        return ((mirrored_ >> least_) ^ last) << least_;
    }

private:
    /// Into the child of height_ that the ray is in at t_, from its parent.
    void go_down() {
        const vec3 middle = shared::plane_time(ray_, mirrored_ + (1 << height_));
        mirrored_ += ivec3(glm::lessThanEqual(middle, vec3(t_))) << height_;
    }

    void go_on() {
        const vec3 exits = shared::plane_time(ray_, mirrored_ + (1 << height_));
        t_ = shared::min3(exits);
        const ivec3 next = mirrored_ + (ivec3(glm::lessThanEqual(exits, vec3(t_))) << height_);
        const ivec3 changed = mirrored_ ^ next;
        height_ = std::max(
            height_,
            shared::highest_bit(static_cast<std::uint32_t>(changed.x | changed.y | changed.z)));
        mirrored_ = next & -(1 << height_);
    }

    shared::DagView dag_;
    shared::UpwardRay ray_;
    int least_;
    int height_;
    float t_, t_end_;
    bool found_ = false;
    ivec3 mirrored_{0};                   // the corner of the cell that the ray is in at t_
    std::uint32_t nodes_[kMaxDepth + 1];  // by height: the nodes on the path
};

}  // namespace octavo
