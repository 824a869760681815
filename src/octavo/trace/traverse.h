// SPDX-License-Identifier: MIT
//
// One ray through a sparse voxel DAG: closest hit, any hit, secondary rays. Shared text: see
// shared_text.h for what to include first.
//
// After Kaempe, Sintorn, Assarsson, "High Resolution Sparse Voxel DAGs", 2013, section 4, and
// Billeter, "Ray-Tracing DAGs", EG tutorial 2018: a stack of nodes, each with the children that
// exist and that the ray meets and that are still to visit, in the ray's order. Differs in how it
// decides which children the ray meets: from times of integer planes, so that nothing needs an
// epsilon or the midpoint that the slides add (docs/adr/0004-traversal.md).
//
// Grid space. A cell of height h is 2^h voxels wide: height 0 is a voxel, 2 a leaf, depth the root,
// so height = depth - level. All cells hold their low planes and not their high ones, seen along
// the ray; a cell is hit when the ray is in it for some of [t_min, t_max).
//
// Precision: every time comes from plane_time(), a difference followed by a product, which no
// compiler can fuse. It is monotone, and a plane has one time whichever cell asks: so a ray neither
// skips a cell nor loops, however far it starts. Rounding only moves the ray as a whole, by some
// 1e-7 of the distance to its own origin.
#pragma once

OCTAVO_SHARED_BEGIN

const int kPathCells = 18;  // on the way from the root to a voxel at depth 17
const int kFaceInside = 6;  // the ray starts inside the cell
const int kFaceNone = 7;    // no hit

// A point cell + frac in grid space, and a direction of any length: time is in multiples of it.
// Split like this the origin stays exact far from the grid's corner. frac is in [0, 1]. A zero in
// dir counts as a tiny positive number, so that a ray along a plane is on the plane's upper side.
struct GridRay {
    ivec3 cell;
    vec3 frac;
    vec3 dir;
    float t_min;
    float t_max;
};

// Cells above the voxels where a ray may end: all of this height; and those that the ray enters at
// a time t with width < (time_before + t) * cone, time_before being how long it had travelled
// before its origin. Height 0 and cone 0 go down to the voxels.
struct Stop {
    int height;
    float cone;
    float time_before;
};

OCTAVO_FN Stop stop_at_voxels() {
    Stop stop;
    stop.height = 0;
    stop.cone = 0.0f;
    stop.time_before = 0.0f;
    return stop;
}

OCTAVO_FN bool may_stop(Stop stop, int height, float entry) {
    return height <= stop.height || float(1 << height) < (stop.time_before + entry) * stop.cone;
}

struct GridHit {
    float t;     // when the ray enters the cell, or t_min
    uvec3 path;  // the cell, in units of its own width: the way down the DAG, high bit first
    int height;
    int face;   // 2 * axis, + 1 for the face towards +axis; or kFaceInside, kFaceNone
    int steps;  // cells visited
};

OCTAVO_FN float min3(vec3 v) {
    return min(v.x, min(v.y, v.z));
}
OCTAVO_FN float max3(vec3 v) {
    return max(v.x, max(v.y, v.z));
}

// The ray mirrored on the axes where it travels down, so that it travels up on all three: the
// mirrored plane p is the real plane 2^depth - p. Child numbers stay real; `far_half` has the
// children on the far side of each middle plane.
struct UpwardRay {
    ivec3 cell;
    vec3 frac;
    vec3 inv_dir;
    ivec3 down;  // 1 on mirrored axes
};

OCTAVO_FN UpwardRay mirror_ray(ivec3 cell, vec3 frac, vec3 dir, int depth) {
    ivec3 down = ivec3(lessThan(dir, vec3(0.0f)));
    ivec3 way = 1 - 2 * down;
    UpwardRay up;
    up.cell = way * cell + (down << depth);
    up.frac = vec3(way) * frac;
    up.inv_dir = 1.0f / max(abs(dir), vec3(1e-20f));
    up.down = down;
    return up;
}

// When the ray crosses the mirrored planes x = plane.x, y = plane.y and z = plane.z.
OCTAVO_FN vec3 plane_time(UpwardRay up, ivec3 plane) {
    return (vec3(plane - up.cell) - up.frac) * up.inv_dir;
}

OCTAVO_FN int child_number(ivec3 position) {
    return position.x | (position.y << 1) | (position.z << 2);
}

// Which 2x2x2 children of a leaf hold a voxel; and the voxels of one of them ([B18], last two
// levels).
OCTAVO_FN uint leaf_children(uvec2 leaf) {
    uvec2 any4 = leaf | (leaf >> 4u);
    uvec2 any2 = any4 | (any4 >> 2u);
    uvec2 any1 = (any2 | (any2 >> 1u)) & 0x01010101u;
    uvec2 gathered = (any1 | (any1 >> 7u) | (any1 >> 14u) | (any1 >> 21u)) & 15u;
    return gathered.x | (gathered.y << 4);
}
OCTAVO_FN uint leaf_voxels(uvec2 leaf, int child) {
    return ((child < 4 ? leaf.x : leaf.y) >> (8 * (child & 3))) & 255u;
}

// What says which children a cell of height 2 or more has: its node's mask, or its leaf's words.
OCTAVO_FN uvec2 load_mask(DagView dag, uint node, int height) {
    return uvec2(dag_load(dag, node), height == 2 ? dag_load(dag, node + 1u) : 0u);
}

// The children of a cell that exist. Of height 1 it is child number `child` of the leaf whose words
// `mask` still has.
OCTAVO_FN uint children_of(uvec2 mask, int height, int child) {
    if (height > 2) return mask.x & 255u;
    return height == 2 ? leaf_children(mask) : leaf_voxels(mask, child);
}

// The word of a node, counted from its mask, that says where this child's node is.
OCTAVO_FN uint child_word(uint mask, int child) {
    return 1u + uint(count_bits8(mask & ((1u << child) - 1u) & 255u));
}

OCTAVO_FN uint load_child(DagView dag, uint node, int child) {
    return dag_load(dag, node + child_word(dag_load(dag, node), child));
}

OCTAVO_FN GridHit make_hit(UpwardRay up, int depth, ivec3 corner, int height, float t, int steps) {
    vec3 entry = plane_time(up, corner);
    int axis = entry.x >= max(entry.y, entry.z) ? 0 : (entry.y >= entry.z ? 1 : 2);
    ivec3 last = up.down * ((1 << (depth - height)) - 1);
    GridHit hit;
    hit.t = t;
    hit.path = uvec3((corner >> height) ^ last);
    hit.height = height;
    hit.face = entry[axis] < t ? kFaceInside : 2 * axis + up.down[axis];
    hit.steps = steps;
    return hit;
}

OCTAVO_FN GridHit make_miss(float t_max, int steps) {
    GridHit miss;
    miss.t = t_max;
    miss.path = uvec3(0u);
    miss.height = 0;
    miss.face = kFaceNone;
    miss.steps = steps;
    return miss;
}

// The first cell that the ray is in during [t_min, t_max) and at which it may stop.
OCTAVO_FN GridHit trace_closest(DagView dag, GridRay ray, Stop stop) {
    UpwardRay up = mirror_ray(ray.cell, ray.frac, ray.dir, dag.depth);
    float entry = max3(plane_time(up, ivec3(0)));
    float t = max(ray.t_min, entry);
    float t_end = min(ray.t_max, min3(plane_time(up, ivec3(1 << dag.depth))));
    if (dag.depth == 0 || !(t < t_end)) return make_miss(ray.t_max, 0);
    if (may_stop(stop, dag.depth, entry)) return make_hit(up, dag.depth, ivec3(0), dag.depth, t, 0);

    uint nodes[kPathCells];  // by height: the nodes on the path
    uint parent = 0u;        // of the cell that the ray is in
    uvec2 leaf = uvec2(0u);  // the leaf on the path
    uint children_of_leaf = 0u;
    nodes[dag.depth] = 0u;
    uint children = dag_load(dag, 0u);  // of the parent
    if (dag.depth == 2) {
        leaf = uvec2(children, dag_load(dag, 1u));
        children_of_leaf = leaf_children(leaf);
        children = children_of_leaf;
    }
    int down = child_number(up.down);
    int height = dag.depth - 1;  // of the cell that the ray is in at time t, which may be empty
    ivec3 corner = ivec3(lessThanEqual(plane_time(up, ivec3(1 << height)), vec3(t))) << height;
    int child = child_number(corner >> height) ^ down;
    int steps = 0;
    while (true) {
        steps += 1;
        bool full = ((children >> child) & 1u) != 0u;
        if (full) {
            if (height <= stop.height ||
                (stop.cone > 0.0f && may_stop(stop, height, max3(plane_time(up, corner)))))
                return make_hit(up, dag.depth, corner, height, t, steps);
            if (height >= 2) {
                parent = dag_load(dag, parent + child_word(children, child));
                nodes[height] = parent;
                children = dag_load(dag, parent);
                if (height == 2) {
                    leaf = uvec2(children, dag_load(dag, parent + 1u));
                    children_of_leaf = leaf_children(leaf);
                    children = children_of_leaf;
                }
            } else {
                children = leaf_voxels(leaf, child);
            }
            height -= 1;
        }
        // Of a full cell, now open, these are the middle planes, and those passed say in which of
        // its children the ray is. Of an empty one they are the far planes, and the ray goes on
        // to the first, into the next cell.
        vec3 planes = plane_time(up, corner + (1 << height));
        t = full ? t : min3(planes);
        if (!(t < t_end)) break;
        ivec3 next = corner + (ivec3(lessThanEqual(planes, vec3(t))) << height);
        ivec3 changed = corner ^ next;
        int last = highest_bit(uint(changed.x | changed.y | changed.z));
        if (last > height) {  // the two cells have no parent in common, but an ancestor
            height = last;
            if (height >= dag.depth) break;
            parent = nodes[height + 1];
            children = height >= 2 ? dag_load(dag, parent) : children_of_leaf;
        }
        corner = next & -(1 << height);
        child = child_number((corner >> height) & 1) ^ down;
    }
    return make_miss(ray.t_max, steps);
}

// Is there such a cell at all?
OCTAVO_FN bool trace_any(DagView dag, GridRay ray, Stop stop) {
    return trace_closest(dag, ray, stop).face != kFaceNone;
}

// The nearest direction that does not go into the cell behind this face. Zero counts as upwards, so
// on a low face it takes a negative number to stay outside.
OCTAVO_FN vec3 bend_outwards(vec3 dir, int face) {
    if (face < kFaceInside) {
        int axis = face / 2;
        dir[axis] = (face & 1) == 1 ? max(dir[axis], 1e-20f) : min(dir[axis], -1e-20f);
    }
    return dir;
}

// A ray from the face of a hit. On the face's axis its origin is exact, so it needs no offset: it
// cannot meet the cell that it leaves. A direction into the cell is bent to run along the face.
OCTAVO_FN GridRay leave_hit(GridRay ray, GridHit hit, vec3 dir) {
    float width = float(1 << hit.height);
    ivec3 corner = ivec3(hit.path << uint(hit.height));
    vec3 inside = exact_madd(hit.t, ray.dir, ray.frac) - vec3(corner - ray.cell);
    inside = clamp(inside, vec3(0.0f), vec3(width));
    if (hit.face < kFaceInside) inside[hit.face / 2] = float(hit.face & 1) * width;
    GridRay next;
    next.cell = corner + ivec3(floor(inside));
    next.frac = inside - floor(inside);
    next.dir = bend_outwards(dir, hit.face);
    next.t_min = 0.0f;
    next.t_max = ray.t_max;
    return next;
}

OCTAVO_SHARED_END
