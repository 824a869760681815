// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "octavo/core/box.h"
#include "octavo/core/grid.h"
#include "octavo/dag/dag.h"
#include "octavo/trace/dag_view.h"
#include "octavo/trace/grid_ray.h"
#include "octavo/trace/partitions.h"
#include "octavo/trace/wide.h"

namespace octavo {

/// A DAG somewhere in a scene. The same DAG may stand in it many times; copies share its words.
struct Instance {
    Dag dag;
    Grid grid;             // of the DAG in its own space
    dmat4 placement{1.0};  // from its own space to the scene's; affine, with an inverse
};

/// Where a ray ends: in which object, and the ray and the cell in that object's grid. Time is the
/// same in all spaces, since a ray is transformed with the length of its direction.
struct InstanceHit {
    std::uint32_t object = 0;
    shared::GridRay ray{};
    shared::GridHit hit{};

    [[nodiscard]] explicit operator bool() const { return hit.face != shared::kFaceNone; }
};

/// Several DAGs as one scene for rays: a small tree of boxes says which objects a ray may touch,
/// and the ray goes on in the grid of each ([J]: "transform each ray to local space around the
/// object").
///
/// Rays come in *common* space: the grid space of the first object, as if it had not been placed.
/// Rays of an object that stands where that frame is are traced as they are, to the bit.
class Instances {
public:
    /// @throws Error  bad_argument where there is no object, more than 2^20, or a placement that is
    ///                not finite, not affine or has no inverse
    explicit Instances(std::vector<Instance> objects, WideWalk walk = WideWalk::by_size);

    [[nodiscard]] std::span<const Instance> objects() const { return objects_; }
    /// The frame of common space: where it lies in the scene.
    [[nodiscard]] const Grid& grid() const { return objects_.front().grid; }
    /// All voxels are in it; the scene's space.
    [[nodiscard]] Box bounds() const;

    /// Whether the object's grid space is common space.
    [[nodiscard]] bool in_place(std::uint32_t object) const { return frames_[object].same; }
    /// From common space to the object's grid space, and back.
    [[nodiscard]] const dmat4& to_object(std::uint32_t object) const {
        return frames_[object].to_object;
    }
    [[nodiscard]] const dmat4& to_common(std::uint32_t object) const {
        return frames_[object].to_common;
    }
    /// A direction, or the normal of a surface, of unit length; from the object's space to common.
    [[nodiscard]] vec3 normal_to_common(std::uint32_t object, const vec3& normal) const;

    /// Of the object's DAG, made as rays that run alike ask for them; nullptr where rays go one by
    /// one.
    [[nodiscard]] const Partitions* partitions(std::uint32_t object) const {
        return frames_[object].partitions.get();
    }

    /// @param hits  as long as `rays`; where a ray meets nothing, the hit has no face
    void trace_closest(std::span<const shared::GridRay> rays, const shared::Stop& stop,
                       std::span<InstanceHit> hits) const;
    /// @param occluded  as long as `rays`; 1 where the ray hits something, else 0
    void trace_any(std::span<const shared::GridRay> rays, const shared::Stop& stop,
                   std::span<std::uint8_t> occluded) const;
    /// One ray.
    [[nodiscard]] bool trace_any(const shared::GridRay& ray) const;

private:
    struct Frame {
        dmat4 to_object{1.0}, to_common{1.0};
        double scale = 1.0;  // voxels of common space to one of the object's, at most
        bool same = true;
        Box box;                                 // common space
        std::shared_ptr<Partitions> partitions;  // of all copies of a DAG
    };
    struct Node {
        Box box;
        std::uint32_t first = 0;  // of the order; or of two children
        std::uint32_t count = 0;  // 0: an inner node
    };
    void split(std::uint32_t node, std::uint32_t first, std::uint32_t end);
    /// Adds the number of each ray to the lists of the objects that it may touch.
    void sort_rays(std::span<const shared::GridRay> rays,
                   std::vector<std::vector<std::uint32_t>>& lists) const;
    [[nodiscard]] shared::GridRay ray_in(std::uint32_t object, const shared::GridRay& ray) const;
    [[nodiscard]] shared::Stop stop_in(std::uint32_t object, shared::Stop stop) const;

    WideWalk walk_;
    std::vector<Instance> objects_;
    std::vector<Frame> frames_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_;
};

}  // namespace octavo
