// SPDX-License-Identifier: MIT
//
// The other way through a DAG: [B18]'s list of children that exist and that the ray meets, in the
// ray's order, with a stack of what is left of each list. Shared text. It visits exactly the voxels
// that trace_closest() does, by other steps, so it is that function's oracle to the bit;
// docs/adr/0004-traversal.md compares their speed.
#pragma once

#include "octavo/trace/dag_view.h"

OCTAVO_SHARED_BEGIN

// For each axis, the real children on the far side of the middle plane.
OCTAVO_FN uvec3 far_children(ivec3 down) {
    return uvec3(down.x != 0 ? 0x55u : 0xAAu, down.y != 0 ? 0x33u : 0xCCu,
                 down.z != 0 ? 0x0Fu : 0xF0u);
}

// All bits if the condition holds, else none.
OCTAVO_FN uint all_bits_if(bool condition) {
    return 0u - uint(condition);
}

// The child that the ray is in, or would be if it were in the node, at time t: one bit, and others
// above bit 7. middle: when the ray crosses the node's middle planes.
OCTAVO_FN uint child_at(uvec3 far_half, vec3 middle, float t) {
    return ~((far_half.x ^ all_bits_if(middle.x <= t)) | (far_half.y ^ all_bits_if(middle.y <= t)) |
             (far_half.z ^ all_bits_if(middle.z <= t)));
}

// The children that the ray meets in [t, t_exit): where it is at t, and where each crossing of a
// middle plane leads it. Without branches, which would be mispredicted every other time.
OCTAVO_FN uint children_met(uvec3 far_half, vec3 middle, float t, float t_exit) {
    uint in_x = uint(middle.x > t) & uint(middle.x < t_exit);
    uint in_y = uint(middle.y > t) & uint(middle.y < t_exit);
    uint in_z = uint(middle.z > t) & uint(middle.z < t_exit);
    return child_at(far_half, middle, t) | ((0u - in_x) & child_at(far_half, middle, middle.x)) |
           ((0u - in_y) & child_at(far_half, middle, middle.y)) |
           ((0u - in_z) & child_at(far_half, middle, middle.z));
}

// The first child in the ray's order, as one bit. What a ray meets it meets in order of mirrored
// child number, because it only ever crosses a middle plane from the near side to the far one.
OCTAVO_FN uint first_child(uvec3 far_half, uint children) {
    uint near_half = children & ~far_half.z;
    children = near_half != 0u ? near_half : children;
    near_half = children & ~far_half.y;
    children = near_half != 0u ? near_half : children;
    near_half = children & ~far_half.x;
    return near_half != 0u ? near_half : children;
}

// Mirrored offset of a child, in child widths.
OCTAVO_FN ivec3 child_offset(UpwardRay up, int child) {
    return ivec3(child & 1, (child >> 1) & 1, child >> 2) ^ up.down;
}

// The first cell that the ray is in during [t_min, t_max) and at which it may stop.
OCTAVO_FN GridHit trace_by_lists(DagView dag, GridRay ray, Stop stop) {
    UpwardRay up = mirror_ray(ray.cell, ray.frac, ray.dir, dag.depth);
    uvec3 far_half = far_children(up.down);
    float t = max(ray.t_min, max3(plane_time(up, ivec3(0))));
    float t_exit = min(ray.t_max, min3(plane_time(up, ivec3(1 << dag.depth))));
    if (dag.depth == 0 || !(t < t_exit)) return make_miss(ray.t_max, 0);

    uint nodes[kPathCells];     // by height: the node on the path, from height 3
    uint to_visit[kPathCells];  // its children still to visit, from height 1
    float exits[kPathCells];    // and when the ray leaves it
    uvec2 leaf = uvec2(0u);     // the leaf on the path
    uint node = 0u;
    ivec3 corner = ivec3(0);  // mirrored low corner of the cell that the ray is in from t to t_exit
    int height = dag.depth;
    uint children = 0u;
    int child = 0;
    int steps = 0;
    while (true) {
        steps += 1;
        if (height <= stop.height ||
            (stop.cone > 0.0f && may_stop(stop, height, max3(plane_time(up, corner)))))
            return make_hit(up, dag.depth, corner, height, t, steps);

        if (height > 2) {
            children = dag_load(dag, node);
            nodes[height] = node;
        } else if (height == 2) {
            leaf = uvec2(dag_load(dag, node), dag_load(dag, node + 1u));
            children = leaf_children(leaf);
        } else {
            children = leaf_voxels(leaf, child);
        }
        vec3 middle = plane_time(up, corner + (1 << (height - 1)));
        children &= 255u & children_met(far_half, middle, t, t_exit);
        exits[height] = t_exit;

        if (children == 0u) {
            while (children == 0u) {
                height += 1;
                if (height > dag.depth) return make_miss(ray.t_max, steps);
                children = to_visit[height];
            }
            corner &= -(1 << height);
            middle = plane_time(up, corner + (1 << (height - 1)));
            t_exit = exits[height];
        }
        uint child_bit = first_child(far_half, children);
        to_visit[height] = children ^ child_bit;
        child = lowest_bit(child_bit);
        if (height > 2) node = load_child(dag, nodes[height], child);

        // The ray is in the child from the last of the near planes to the first of the far ones.
        // The planes that the child shares with its parent are in t and t_exit already: a child
        // that is visited after another is entered through a middle plane.
        height -= 1;
        ivec3 offset = child_offset(up, child);
        corner += offset << height;
        bvec3 far_side = notEqual(offset, ivec3(0));
        t = max(t, max3(mix(vec3(ray.t_min), middle, far_side)));
        t_exit = min(t_exit, min3(mix(middle, vec3(ray.t_max), far_side)));
    }
}

OCTAVO_SHARED_END
