// SPDX-License-Identifier: MIT
//
// From a primary hit to the point where its secondary rays start. Shared text: include after
// trace/traverse.h.
#pragma once

OCTAVO_SHARED_BEGIN

OCTAVO_FN ivec3 step_across(int face) {
    ivec3 way = ivec3(0);
    way[face / 2] = (face & 1) == 1 ? 1 : -1;
    return way;
}

// The unit normal of the face that was hit; against the ray where it starts inside a cell.
OCTAVO_FN vec3 face_normal(GridRay ray, GridHit hit) {
    if (hit.face >= kFaceInside) return -normalize(ray.dir);
    return vec3(step_across(hit.face));
}

// Does this cell hold a voxel? False outside the grid.
OCTAVO_FN bool cell_exists(DagView dag, ivec3 cell, int height) {
    if (any(notEqual(cell >> (dag.depth - height), ivec3(0)))) return false;
    uint node = 0u;
    uvec2 mask = uvec2(0u);
    int child = 0;
    for (int h = dag.depth; h > height; h -= 1) {
        if (h >= 2) mask = load_mask(dag, node, h);
        uint children = children_of(mask, h, child);
        child = child_number((cell >> (h - 1 - height)) & 1);
        if (((children >> child) & 1u) == 0u) return false;
        if (h > 2) node = load_child(dag, node, child);
    }
    return true;
}

// The hit, on a face of its cell that open space lies before: the face that looks most towards the
// ray. A point on any other would be black, for its rays start inside the surface. Rays meet such a
// face in two ways:
//
// - A ray that enters a cell over an edge crosses two planes at one time, and one face is named.
// - A ray that first stops at larger cells comes through the empty half of one, which it was still
//   too near to stop at, into the side of the next, and that is inside as larger cells draw it.
OCTAVO_FN GridHit move_to_open_face(DagView dag, GridRay ray, GridHit hit) {
    ivec3 cell = ivec3(hit.path);
    if (hit.face >= kFaceInside || !cell_exists(dag, cell + step_across(hit.face), hit.height))
        return hit;
    float best = 0.0f;
    for (int face = 0; face < kFaceInside; face += 1) {
        float towards = -ray.dir[face / 2] * ((face & 1) == 1 ? 1.0f : -1.0f);
        if (towards <= best || cell_exists(dag, cell + step_across(face), hit.height)) continue;
        best = towards;
        hit.face = face;
    }
    return hit;
}

// Where secondary rays start. With face kFaceNone the point is in open space; else it lies on that
// face of a cell, which rays must not go into.
struct SurfacePoint {
    ivec3 cell;
    vec3 frac;
    vec3 normal;  // unit length
    int face;
    uint seed;   // of its random numbers
    int exists;  // 0: no surface here
};

OCTAVO_FN GridRay surface_ray(SurfacePoint point) {
    GridRay ray;
    ray.cell = point.cell;
    ray.frac = point.frac;
    ray.dir = point.normal;
    ray.t_min = 0.0f;
    ray.t_max = 1e30f;
    return ray;
}

// How far secondary rays of a smoothed surface start above it, in cells: the steps of a slanted
// plane are up to one cell high, and its shading must not see them.
OCTAVO_FN float surface_lift() {
    return 1.5f;
}

// Moves a point off its face by this way, or as much of it as it can without ending inside a voxel:
// in a crevice, where the point would be black. Where it cannot it stays on its face.
OCTAVO_FN SurfacePoint lift_point(DagView dag, SurfacePoint point, vec3 way) {
    for (int i = 0; i < 3; i += 1) {
        float part = i == 0 ? 1.0f : (i == 1 ? 0.6f : 0.3f);
        vec3 frac = exact_madd(part, way, point.frac);
        SurfacePoint lifted = point;
        lifted.cell = point.cell + ivec3(floor(frac));
        lifted.frac = frac - floor(frac);
        lifted.face = kFaceNone;
        GridRay inside = surface_ray(lifted);
        inside.t_max = 1e-4f;
        if (!trace_any(dag, inside, stop_at_voxels())) return lifted;
    }
    return point;
}

// The point of a hit that shows the face as it is. hit: from move_to_open_face().
OCTAVO_FN SurfacePoint flat_point(GridRay ray, GridHit hit, uint seed) {
    vec3 normal = face_normal(ray, hit);
    GridRay start = leave_hit(ray, hit, normal);
    SurfacePoint point;
    point.cell = start.cell;
    point.frac = start.frac;
    point.normal = normal;
    point.face = hit.face;
    point.seed = seed;
    point.exists = 1;
    return point;
}

// The point of a hit on a surface with this smoothed normal.
OCTAVO_FN SurfacePoint smoothed_point(DagView dag, GridRay ray, GridHit hit, vec3 normal,
                                      uint seed) {
    SurfacePoint point = flat_point(ray, hit, seed);
    point.normal = normal;
    return lift_point(dag, point, surface_lift() * float(1 << hit.height) * normal);
}

OCTAVO_SHARED_END
