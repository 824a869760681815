// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"

namespace octavo::cli {

/// A ray in world space and float, as triangle tracers take it.
struct TriangleRay {
    vec3 origin;
    float t_max;
    vec3 direction;
};

/// The first triangle along a ray; t is infinite where there is none.
struct TriangleHit {
    float t;
    vec3 normal;  // of the triangle, any length and side
};

/// Embree 3 on the triangles of a scene: what voxels are measured against. Where alpha makes holes
/// in them rays go through, as they do in the voxels. Present where the program was built with
/// Embree (package libembree-dev).
class TriangleTracer {
public:
    enum class Width { one, sixteen };  // rays for each call of Embree

    /// @param scene   textures with holes are decoded, as read_scene() leaves them
    /// @throws Error  unsupported where the program was built without Embree
    explicit TriangleTracer(const Scene& scene);
    ~TriangleTracer();
    TriangleTracer(const TriangleTracer&) = delete;
    TriangleTracer& operator=(const TriangleTracer&) = delete;

    /// On the calling thread. `coherent`: the rays are close together and alike.
    void closest(std::span<const TriangleRay> rays, Width width, bool coherent,
                 std::span<TriangleHit> hits) const;
    void any(std::span<const TriangleRay> rays, Width width, bool coherent,
             std::span<std::uint8_t> occluded) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace octavo::cli
