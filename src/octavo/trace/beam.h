// SPDX-License-Identifier: MIT
//
// A bundle of rays with one origin, and the time before which none of them can meet anything.
// Shared text: include after traverse.h.
//
// After the beams of Laine and Karras, "Efficient Sparse Voxel Octrees", 2010, as [K13] section 4
// uses them. Differs: they trace the four corner rays, between which the corner of a large cell can
// poke through unseen. Here a plane has an interval of times instead of one, so the answer holds
// for every ray of the bundle, to the last bit: a ray that starts there gives the hit that it gives
// from t_min.
#pragma once

OCTAVO_SHARED_BEGIN

// Rays from cell + frac whose directions lie in the box [dir_low, dir_high].
struct Bundle {
    ivec3 cell;
    vec3 frac;
    vec3 dir_low;
    vec3 dir_high;
    float t_min;
    float t_max;
    float spread;  // about the bundle's width at t = 1: cells below t * spread are not opened
};

// Renumbers children from real to mirrored, or back.
OCTAVO_FN uint mirror_children(uint children, ivec3 down) {
    if (down.x != 0) children = ((children & 0x55u) << 1) | ((children >> 1) & 0x55u);
    if (down.y != 0) children = ((children & 0x33u) << 2) | ((children >> 2) & 0x33u);
    if (down.z != 0) children = ((children & 0x0Fu) << 4) | ((children >> 4) & 0x0Fu);
    return children;
}

// The least over the bundle of the time when a ray may first be in a cell where it would stop; or
// the greatest of the time when one may last be.
OCTAVO_FN float beam_bound(DagView dag, Bundle beam, Stop stop, bool last) {
    if (any(notEqual(lessThan(beam.dir_low, vec3(0.0f)), lessThan(beam.dir_high, vec3(0.0f)))))
        return last ? beam.t_max : beam.t_min;
    float best = last ? beam.t_min : beam.t_max;
    if (dag.depth == 0) return best;
    UpwardRay slow = mirror_ray(beam.cell, beam.frac, beam.dir_low, dag.depth);
    UpwardRay fast = mirror_ray(beam.cell, beam.frac, beam.dir_high, dag.depth);

    uint nodes[kPathCells];
    uint to_visit[kPathCells];
    uvec2 mask = uvec2(0u);
    uint node = 0u;
    ivec3 corner = ivec3(0);
    int height = dag.depth;
    int child = 0;
    while (true) {
        vec3 low_slow = plane_time(slow, corner);
        vec3 low_fast = plane_time(fast, corner);
        ivec3 far_corner = corner + (1 << height);
        float enter = max(beam.t_min, max3(min(low_slow, low_fast)));
        float leave = min3(max(plane_time(slow, far_corner), plane_time(fast, far_corner)));
        leave = min(leave, beam.t_max);
        float latest_entry = max3(max(low_slow, low_fast));

        // Only what can better the answer is looked into.
        uint children = 0u;
        if (last ? max(enter, best) < leave : enter < min(leave, best)) {
            if (may_stop(stop, height, latest_entry) || float(1 << height) < enter * beam.spread) {
                best = last ? leave : enter;
            } else {
                nodes[height] = node;
                if (height >= 2) mask = load_mask(dag, node, height);
                children = mirror_children(children_of(mask, height, child), slow.down);
            }
        }
        while (children == 0u) {
            height += 1;
            if (height > dag.depth) return best;
            children = to_visit[height];
        }
        // A mirrored child comes after those that lie before it on all axes.
        int mirrored = last ? highest_bit(children) : lowest_bit(children);
        to_visit[height] = children ^ (1u << mirrored);
        ivec3 offset = ivec3(mirrored & 1, (mirrored >> 1) & 1, mirrored >> 2);
        child = child_number(offset ^ slow.down);
        if (height > 2) node = load_child(dag, nodes[height], child);
        corner &= -(1 << height);
        height -= 1;
        corner += offset << height;
    }
}

// When a ray of the bundle may first be in a cell where it would stop; t_max if never. A bundle
// with directions of both signs on an axis gets no help: t_min.
OCTAVO_FN float beam_start(DagView dag, Bundle beam, Stop stop) {
    return beam_bound(dag, beam, stop, false);
}

// When one may last be in such a cell; t_min if never. For rays to a lamp: nothing beyond needs to
// be looked for. A bundle with directions of both signs on an axis gets no help: t_max.
OCTAVO_FN float beam_end(DagView dag, Bundle beam, Stop stop) {
    return beam_bound(dag, beam, stop, true);
}

OCTAVO_SHARED_END
