// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "octavo/core/grid.h"
#include "octavo/mesh/scene.h"
#include "octavo/render/effects.h"
#include "octavo/render/ray_queue.h"

namespace octavo {

/// A light placed in a grid, made ready to be seen from many points.
///
/// Lamps with an area are often voxels as well, and these must not shade the lamp: its rays end
/// above the surface, on the point's side, where voxels of a flat or convex lamp do not reach.
class Lamp {
public:
    Lamp(const Light& light, const Grid& grid);

    [[nodiscard]] const Light& light() const { return light_; }

private:
    friend class SeenLamp;

    struct Triangle {
        dvec3 corner;   // grid space
        vec3 u, v;      // to the other corners
        vec3 normal;    // unit length
        vec3 middle;    // seen from low_
        float squared;  // of a length: about the triangle's size
    };

    Light light_;
    Grid grid_;
    std::vector<Triangle> triangles_;
    std::vector<double> areas_;  // of triangles 0 to i together, square voxels
    dvec3 low_{0.0}, high_{0.0};
};

/// A ray towards a lamp, and the light that comes along it where nothing is in the way: a part of
/// the light's intensity, the cosine at the point included. A ray without light need not be traced.
struct LampRay {
    shared::GridRay ray;
    float light;
};

/// A lamp as one point of a surface sees it.
class SeenLamp {
public:
    /// @param start   the point; see sky_ray() for it and `face`
    /// @param normal  unit length
    /// @param hard    rays go to the lamp's middle alone; one of triangles has none
    SeenLamp(const Lamp& lamp, const shared::GridRay& start, int face, const vec3& normal,
             bool hard);

    /// No light can come from it, whatever is in the way.
    [[nodiscard]] bool dark() const { return dark_; }

    /// Ray i of the pixel with this seed. The mean over all i is the light that the lamp gives.
    [[nodiscard]] LampRay ray(int i, std::uint32_t seed) const;

    /// All its rays are in here.
    [[nodiscard]] shared::Bundle bundle() const;

private:
    [[nodiscard]] LampRay triangle_ray(int i, std::uint32_t seed) const;
    [[nodiscard]] float area_light(const vec3& direction, const vec3& lamp_normal,
                                   double area) const;

    const Lamp& lamp_;
    shared::GridRay start_;
    int face_;
    vec3 normal_;
    shared::LampPatch patch_{};  // of all but a mesh
    vec3 to_low_{0.0f};          // of a mesh
    float light_ = 0.0f;         // of each ray, where they are all alike
    bool dark_ = false;
};

/// Puts the rays [first, end) of a pixel towards a lamp into the queue's last group, which adds up
/// the light of those that see it.
///
/// With many rays, a bundle of all of them first finds the times between which geometry may be
/// ([K13] section 4): rays are cut to that interval, and where there is none they are not traced.
/// What the group sees is the same to the bit.
///
/// @return  the light of all rays, seen or not
float queue_lamp_rays(const shared::DagView& dag, const SeenLamp& lamp, int first, int end,
                      std::uint32_t seed, bool beam, RayQueue& queue);

}  // namespace octavo
