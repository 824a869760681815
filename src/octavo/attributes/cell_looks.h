// SPDX-License-Identifier: MIT
//
// What cells look like, for every backend: octavo::Attributes in 32 bits and linear light. Shared
// text: include after cell_rank.h, cell_value.h and srgb.h.
#pragma once

OCTAVO_SHARED_BEGIN

// The arrays that are there.
const int kHasColor = 1;
const int kHasBack = 2;
const int kHasEmission = 4;
const int kHasBackEmission = 8;

struct CellLooks {
    CellView cells;
    ValueView color;
    ValueView back;
    ValueView emission;
    ValueView back_emission;
    int has;
    int padding;  // as in C++
};

struct CellLook {
    vec3 albedo;    // linear; its red is negative where there is no colour
    vec3 emission;  // radiance
};

// As octavo::linear_from_srgb8(), within rounding.
OCTAVO_FN vec3 linear_from_rgb8(uint value) {
    vec3 shown = vec3(uvec3(value, value >> 8, value >> 16) & 255u) / 255.0f;
    return vec3(linear_from_srgb(shown.x), linear_from_srgb(shown.y), linear_from_srgb(shown.z));
}

// As octavo::unpack_coarse_direction(), of another length.
OCTAVO_FN vec3 coarse_direction(uint number) {
    uint row = number / 11u;
    float x = float(number % 11u) / 5.0f - 1.0f;
    float y = float(row) / 5.0f - 1.0f;
    float z = 1.0f - abs(x) - abs(y);
    if (z >= 0.0f) return vec3(x, y, z);
    return vec3((x < 0.0f ? -1.0f : 1.0f) * (1.0f - abs(y)),
                (y < 0.0f ? -1.0f : 1.0f) * (1.0f - abs(x)), z);
}

// One cell, seen from this direction, from the surface to the eye.
OCTAVO_FN CellLook look_of_cell(CellLooks looks, uint cell, vec3 towards) {
    uint back = (looks.has & kHasBack) != 0 ? cell_value(looks.back, cell) : 0u;
    bool behind = back != 0u && dot(coarse_direction((back >> 24) & 127u), towards) < 0.0f;
    CellLook look;
    look.albedo = vec3(-1.0f);
    if ((looks.has & kHasColor) != 0)
        look.albedo = linear_from_rgb8(behind ? back : cell_value(looks.color, cell));
    look.emission = vec3(0.0f);
    if (behind && (looks.has & kHasBackEmission) != 0)
        look.emission = unpack_rgb9e5(cell_value(looks.back_emission, cell));
    else if ((looks.has & kHasEmission) != 0)
        look.emission = unpack_rgb9e5(cell_value(looks.emission, cell));
    return look;
}

// The cells [x, y) that lie in a cell of a level above cells.level: CellIndex::cells_in().
OCTAVO_FN uvec2 cells_in(DagView dag, CellView cells, uvec3 cell, int level) {
    uint node = 0u;
    uvec2 range = uvec2(0u);
    if (dag.depth == 0) return range;
    int leaf_level = dag.depth - 2;
    int bottom = min(cells.level - 1, leaf_level);
    if (bottom > 0) range.y = cell_sum(cells, 0u);
    for (int l = 0; l < min(level, bottom); l += 1) {
        uvec3 bits = (cell >> uint(level - 1 - l)) & 1u;
        uint child_bit = 1u << (bits.x | (bits.y << 1) | (bits.z << 2));
        uint mask = dag_load(dag, node) & 255u;
        if ((mask & child_bit) == 0u) return uvec2(0u);
        uint pointer = node + 1u + uint(count_bits8(mask & (child_bit - 1u)));
        uint first = range.x;
        range.x = first + cell_sum(cells, pointer);
        if (mask >= 2u * child_bit) range.y = first + cell_sum(cells, pointer + 1u);
        node = dag_load(dag, pointer);
    }
    if (level < bottom || (level == bottom && bottom > 0)) return range;

    // Of a leaf whose voxels are the cells: all of them, or those of one child.
    uvec2 leaf = uvec2(dag_load(dag, node), dag_load(dag, node + 1u));
    int child = 8;
    if (level > bottom) {
        uvec3 bits = cell & 1u;
        child = int(bits.x | (bits.y << 1) | (bits.z << 2));
    }
    uint first = range.x;
    for (int i = 0; i < 8; i += 1) {
        uint count = uint(count_bits8(leaf_voxels(leaf, i)));
        if (i < child) first += count;
        if (i == child) return uvec2(first, first + count);
    }
    return uvec2(range.x, first);
}

// A cell of any level: of a finer one its parent, of a coarser one the mean of up to 16, evenly
// chosen. Black light and no colour where it is empty.
OCTAVO_FN CellLook cell_look(DagView dag, CellLooks looks, uvec3 path, int level, vec3 towards) {
    CellLook mean;
    mean.albedo = vec3(-1.0f);
    mean.emission = vec3(0.0f);
    if (level >= looks.cells.level) {
        uint rank = cell_rank(dag, looks.cells, path >> uint(level - looks.cells.level));
        if (rank == kNoCell) return mean;
        return look_of_cell(looks, rank, towards);
    }
    uvec2 range = cells_in(dag, looks.cells, path, level);
    uint size = range.y - range.x;
    uint some = min(size, 16u);
    if (some == 0u) return mean;
    mean.albedo = vec3(0.0f);
    for (uint i = 0u; i < some; i += 1u) {
        uint step = i;
        if (size > 16u) step = (2u * i + 1u) * (size / 32u) + (2u * i + 1u) * (size % 32u) / 32u;
        CellLook look = look_of_cell(looks, range.x + step, towards);
        mean.albedo += look.albedo;
        mean.emission += look.emission;
    }
    mean.albedo /= float(some);
    mean.emission /= float(some);
    return mean;
}

// The number of the cell that holds a point of the grid, or one that the point touches, up to a
// thousandth of a cell away: Attributes::cell_at().
OCTAVO_FN uint cell_at(DagView dag, CellView cells, ivec3 voxel, vec3 frac) {
    int shift = dag.depth - cells.level;
    ivec3 own = voxel >> shift;
    vec3 inside = (vec3(voxel - (own << shift)) + frac) / float(1 << shift);
    ivec3 across =
        ivec3(greaterThanEqual(inside, vec3(0.999f))) - ivec3(lessThanEqual(inside, vec3(0.001f)));
    for (int i = 0; i < 8; i += 1) {
        ivec3 steps = ivec3(i & 1, (i >> 1) & 1, i >> 2);
        if (any(notEqual(steps * (1 - abs(across)), ivec3(0)))) continue;
        ivec3 cell = own + steps * across;
        if (any(notEqual(cell >> cells.level, ivec3(0)))) continue;
        uint rank = cell_rank(dag, cells, uvec3(cell));
        if (rank != kNoCell) return rank;
    }
    return kNoCell;
}

OCTAVO_SHARED_END
