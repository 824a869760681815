// SPDX-License-Identifier: MIT
//
// The number of an occupied cell, for every backend: CellIndex::find() in 32 bits. Shared text: see
// trace/shared_text.h. A backend includes before it what traverse.h needs, and
//     its own  struct CellView { ...; int level; };   see attributes/cell_index.h for the sums
//     and      uint cell_sum(CellView cells, uint word);
//
// After Billeter, "Ray-Tracing DAGs", EG tutorial 2018: voxel attributes by counting.
#pragma once

OCTAVO_SHARED_BEGIN

const uint kNoCell = 0xffffffffu;

// The cell of level cells.level with these coordinates, all below 2^level; kNoCell where it is
// empty.
OCTAVO_FN uint cell_rank(DagView dag, CellView cells, uvec3 cell) {
    if (dag.depth == 0) return kNoCell;
    int leaf_level = dag.depth - 2;
    int bottom = min(cells.level - 1, leaf_level);
    uint node = 0u;
    uint rank = 0u;
    for (int level = 0; level < bottom; ++level) {
        uvec3 bits = (cell >> uint(cells.level - 1 - level)) & 1u;
        uint child_bit = 1u << (bits.x | (bits.y << 1) | (bits.z << 2));
        uint mask = dag_load(dag, node);
        if ((mask & child_bit) == 0u) return kNoCell;
        uint pointer = node + 1u + uint(count_bits8(mask & (child_bit - 1u) & 255u));
        rank += cell_sum(cells, pointer);
        node = dag_load(dag, pointer);
    }

    // The last node: its child mask, or a leaf's, or of a leaf the one child that holds the voxel.
    uint mask = dag_load(dag, node);
    if (bottom == leaf_level) {
        uvec2 leaf = uvec2(mask, dag_load(dag, node + 1u));
        mask = leaf_children(leaf);
        if (cells.level == dag.depth) {
            uvec3 half_bits = (cell >> 1u) & 1u;
            int child = int(half_bits.x | (half_bits.y << 1) | (half_bits.z << 2));
            for (int i = 0; i < child; ++i) rank += uint(count_bits8(leaf_voxels(leaf, i)));
            mask = leaf_voxels(leaf, child);
        }
    }
    uvec3 last_bits = cell & 1u;
    uint last_bit = 1u << (last_bits.x | (last_bits.y << 1) | (last_bits.z << 2));
    if ((mask & last_bit) == 0u) return kNoCell;
    return rank + uint(count_bits8(mask & (last_bit - 1u) & 255u));
}

OCTAVO_SHARED_END
