// SPDX-License-Identifier: MIT
//
// The light stored for cells, smoothed over them. Shared text: include after trace/traverse.h,
// attributes/cell_rank.h, cell_value.h and light/surface.h. A backend includes before it
//     its own  struct LightView { ...; };                 see attributes/cell_light.h for the words
//     and      uint light_load(LightView light, uint word);
#pragma once

OCTAVO_SHARED_BEGIN

const uint kHiddenLight = 0xf8000000u;

// The light of the side of a cell that a ray met, which came from where `towards` points; any
// length. A ray that runs along an edge of a wall may meet a side that is hidden: then that of the
// sides that it could see, by how much they face it, and never of those behind, which may lie on
// the wall's other side.
OCTAVO_FN vec3 side_light(LightView light, uint cell, int direction, vec3 towards) {
    uint word = light_load(light, 6u * cell + uint(direction));
    if (word != kHiddenLight) return unpack_rgb9e5(word);
    vec3 sum = vec3(0.0f);
    float weights = 0.0f;
    for (int axis = 0; axis < 3; axis += 1) {
        word = light_load(light, 6u * cell + uint(2 * axis + (towards[axis] > 0.0f ? 1 : 0)));
        if (word == kHiddenLight) continue;
        sum += abs(towards[axis]) * unpack_rgb9e5(word);
        weights += abs(towards[axis]);
    }
    return weights > 0.0f ? sum / weights : vec3(0.0f);
}

// Whether voxels hide the place before a side of a cell from a point.
//
//   shift  log2 of the width of a cell in voxels
OCTAVO_FN bool side_is_hidden(DagView dag, SurfacePoint from, ivec3 cell, int direction,
                              int shift) {
    vec3 to = vec3(cell) + 0.5f;
    to[direction / 2] += (direction & 1) == 1 ? 0.75f : -0.75f;
    ivec3 own = from.cell >> shift;
    GridRay ray = surface_ray(from);
    ray.dir = bend_outwards(
        (to - vec3(own)) * float(1 << shift) - (vec3(from.cell - (own << shift)) + from.frac),
        from.face);
    ray.t_max = 1.0f;
    return trace_any(dag, ray, stop_at_voxels());
}

// What a white surface at a hit sends back, by the light of the cells around it.
//
// Each axis of the normal has the direction in which it points, and counts by its square (the
// ambient cube of McTaggart, "Half-Life 2 / Valve Source Shading", GDC 2004). For each, the eight
// cells around the point half a cell below the surface are weighted as in trilinear filtering;
// those that are empty, or hidden in this direction, are left out. So are those whose face cannot
// be seen from before the hit: a wall has dark cells, or bright ones, on its other side, and none
// of their light comes through.
//
//   surface  a ray from the hit, on its face (leave_hit)
//   before   where the surface is seen from, and its normal: lifted off the face, or on it
//   face     of the cell that was hit
OCTAVO_FN vec3 cached_light(DagView dag, CellView cells, LightView light, GridRay surface,
                            SurfacePoint before, int face) {
    vec3 normal = before.normal;
    int shift = dag.depth - cells.level;
    float width = float(1 << shift);
    vec3 at = (vec3(surface.cell) + surface.frac) / width - 0.5f * normal - 0.5f;
    ivec3 low = ivec3(floor(at));
    vec3 part = at - vec3(low);
    // The voxel behind the face that was hit, in cells.
    vec3 behind = (vec3(surface.cell) + surface.frac) / width;
    if (face < kFaceInside) behind[face / 2] += ((face & 1) == 1 ? -0.5f : 0.5f) / width;
    ivec3 own = ivec3(floor(behind));

    vec3 sums[3];
    vec3 weights = vec3(0.0f);
    for (int axis = 0; axis < 3; axis += 1) sums[axis] = vec3(0.0f);
    for (int i = 0; i < 8; i += 1) {
        ivec3 far_half = ivec3(i & 1, (i >> 1) & 1, i >> 2);
        vec3 near_weights = mix(1.0f - part, part, vec3(far_half));
        float weight = near_weights.x * near_weights.y * near_weights.z;
        ivec3 cell = low + far_half;
        if (weight < 0.002f || any(notEqual(cell >> cells.level, ivec3(0)))) continue;
        uint rank = cell_rank(dag, cells, uvec3(cell));
        if (rank == kNoCell) continue;
        for (int axis = 0; axis < 3; axis += 1) {
            if (normal[axis] * normal[axis] < 0.002f) continue;
            int direction = 2 * axis + (normal[axis] > 0.0f ? 1 : 0);
            uint word = light_load(light, 6u * rank + uint(direction));
            if (word == kHiddenLight) continue;
            bool was_hit = direction == face && all(equal(cell, own));
            if (!was_hit && side_is_hidden(dag, before, cell, direction, shift)) continue;
            sums[axis] += weight * unpack_rgb9e5(word);
            weights[axis] += weight;
        }
    }
    vec3 sum = vec3(0.0f);
    float total = 0.0f;
    for (int axis = 0; axis < 3; axis += 1) {
        if (weights[axis] <= 0.0f) continue;
        float square = normal[axis] * normal[axis];
        sum += square / weights[axis] * sums[axis];
        total += square;
    }
    if (total > 0.0f) return sum / total;
    if (any(notEqual(own >> cells.level, ivec3(0)))) return vec3(0.0f);
    uint rank = cell_rank(dag, cells, uvec3(own));
    if (rank == kNoCell || face >= kFaceInside) return vec3(0.0f);
    return side_light(light, rank, face, normal);
}

OCTAVO_SHARED_END
