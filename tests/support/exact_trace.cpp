// SPDX-License-Identifier: MIT
#include "support/exact_trace.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace octavo::test {
namespace {

void visit(const Dag& dag, const ExactRay& ray, std::uint64_t node, std::uint64_t voxels,
           const uvec3& corner, std::uint32_t width, ExactHit& best) {
    double low = 0.0;
    double high = 0.0;
    clip(ray, dvec3(corner), dvec3(corner + width), low, high);
    if (!(low < high) || (best.found && low >= best.t)) return;
    if (width == 1) {
        best = {true, low, corner};
        return;
    }
    if (width == 4) voxels = dag.leaf(node);
    const std::uint32_t half = width / 2;
    std::uint64_t pointer = node + 1;
    for (unsigned i = 0; i < 8; ++i) {
        const uvec3 child = corner + half * uvec3(i & 1, i >> 1 & 1, i >> 2);
        if (width > 4) {
            if (dag.words()[node] >> i & 1u)
                visit(dag, ray, dag.words()[pointer++], 0, child, half, best);
        } else {
            const unsigned bits = width == 4 ? 8 : 1;
            const std::uint64_t part = voxels >> (i * bits) & (width == 4 ? 0xffu : 1u);
            if (part != 0) visit(dag, ray, 0, part, child, half, best);
        }
    }
}

}  // namespace

void clip(const ExactRay& ray, const dvec3& box_low, const dvec3& box_high, double& low,
          double& high) {
    low = ray.t_min;
    high = ray.t_max;
    for (int axis = 0; axis < 3; ++axis) {
        double d = ray.direction[axis];
        if (std::abs(d) < 1e-20) d = d < 0.0 ? -1e-20 : 1e-20;
        const double t0 = (box_low[axis] - ray.origin[axis]) / d;
        const double t1 = (box_high[axis] - ray.origin[axis]) / d;
        low = std::max(low, std::min(t0, t1));
        high = std::min(high, std::max(t0, t1));
    }
}

ExactHit trace_exact(const Dag& dag, const ExactRay& ray) {
    ExactHit best;
    if (!dag.empty()) visit(dag, ray, 0, 0, uvec3(0), dag.resolution(), best);
    return best;
}

bool differ_by_a_graze(const ExactRay& ray, bool found, const uvec3& voxel, const ExactHit& exact,
                       double tolerance) {
    const auto meets = [&](const uvec3& v, double grow) {
        double low = 0.0;
        double high = 0.0;
        clip(ray, dvec3(v) - grow, dvec3(v) + 1.0 + grow, low, high);
        return low < high;
    };
    // Each explains the other's answer only if it is about a voxel on the edge of the ray.
    const bool invented = found && !meets(voxel, 0.0) && meets(voxel, tolerance);
    const bool overlooked = exact.found && !meets(exact.voxel, -tolerance);
    // A voxel at the very end of the ray: t_min and t_max are rounded too.
    double low = 0.0;
    double high = 0.0;
    bool at_the_end = false;
    for (int k = 0; k < 2; ++k) {
        if (!(k == 0 ? found : exact.found)) continue;
        const uvec3& v = k == 0 ? voxel : exact.voxel;
        clip({ray.origin, ray.direction, -1e30, 1e30}, dvec3(v), dvec3(v) + 1.0, low, high);
        const double length = glm::length(ray.direction);
        at_the_end |= std::abs(low - ray.t_max) * length < tolerance ||
                      std::abs(high - ray.t_min) * length < tolerance;
    }
    return invented || overlooked || at_the_end;
}

}  // namespace octavo::test
