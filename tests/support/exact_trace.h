// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/dag/dag.h"

namespace octavo::test {

/// A ray in grid space, exact. A zero in the direction counts as a tiny positive number.
struct ExactRay {
    dvec3 origin;
    dvec3 direction;
    double t_min = 0.0;
    double t_max = 1e30;
};

struct ExactHit {
    bool found = false;
    double t = 0.0;
    uvec3 voxel{0};
};

/// The first voxel, in double, by trying all children of every node that the ray meets.
ExactHit trace_exact(const Dag& dag, const ExactRay& ray);

/// The ray's times in a box; it meets the box if low < high.
void clip(const ExactRay& ray, const dvec3& box_low, const dvec3& box_high, double& low,
          double& high);

/// May two traces of one ray differ in these answers, if each may err by `tolerance` voxels? The
/// nearer of the voxels (or the only one) must be one that the ray misses or leaves out by less
/// than that.
bool differ_by_a_graze(const ExactRay& ray, bool found, const uvec3& voxel, const ExactHit& exact,
                       double tolerance);

}  // namespace octavo::test
