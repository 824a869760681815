// SPDX-License-Identifier: MIT
//
// A unit normal of the surface that the voxels around a hit stand for. Shared text: include after
// surface.h. normal.h says what it does; this is the same in 32-bit words, for GPUs, and the oracle
// of the 64-bit one.
#pragma once

OCTAVO_SHARED_BEGIN

const int kNormalRadius = 5;  // cells on each side of the one that was hit
const int kNormalSide = 11;
const int kNormalRows = 121;
const uint kNormalRow = 0x7ffu;

// A set of the 11^3 cells around the one that was hit. Bit x of row 11 z + y is a cell.
struct NormalBlock {
    uint rows[kNormalRows];
};

OCTAVO_FN NormalBlock no_cells() {
    NormalBlock block;
    for (int i = 0; i < kNormalRows; i += 1) block.rows[i] = 0u;
    return block;
}

// The cells of this height around the one at `path` that exist: down the tree, leaving out what is
// outside the block.
OCTAVO_FN NormalBlock occupied_around(DagView dag, uvec3 path, int cell_height) {
    NormalBlock occupied = no_cells();
    uint nodes[kPathCells];
    uint to_visit[kPathCells];
    uvec2 mask = uvec2(0u);
    uint node = 0u;
    int child = 0;
    int height = dag.depth;
    ivec3 block = ivec3(path) - kNormalRadius;  // its low corner, in cells
    ivec3 corner = ivec3(0);                    // of the node, in cells
    bool done = false;
    while (!done) {
        int width = 1 << (height - cell_height);
        ivec3 inside = corner - block;
        uint children = 0u;
        if (all(lessThan(inside, ivec3(kNormalSide))) &&
            all(greaterThan(inside + width, ivec3(0)))) {
            if (height == cell_height) {
                occupied.rows[inside.z * kNormalSide + inside.y] |= 1u << inside.x;
            } else {
                nodes[height] = node;
                if (height >= 2) mask = load_mask(dag, node, height);
                children = children_of(mask, height, child);
            }
        }
        while (children == 0u && !done) {
            height += 1;
            done = height > dag.depth;
            if (!done) children = to_visit[height];
        }
        if (!done) {
            child = lowest_bit(children);
            to_visit[height] = children & (children - 1u);
            if (height > 2) node = load_child(dag, nodes[height], child);
            corner &= -(1 << (height - cell_height));
            height -= 1;
            corner += ivec3(child & 1, (child >> 1) & 1, child >> 2) << (height - cell_height);
        }
    }
    return occupied;
}

// The empty cells of the block that are connected through faces to this one, and it.
OCTAVO_FN NormalBlock space_connected_to(ivec3 from, NormalBlock occupied) {
    NormalBlock space = no_cells();
    space.rows[from.z * kNormalSide + from.y] = 1u << from.x;
    bool grew = true;
    while (grew) {
        grew = false;
        for (int k = 0; k < 2 * kNormalRows; k += 1) {
            int i = k < kNormalRows ? k : 2 * kNormalRows - 1 - k;  // up, then down again
            int y = i % kNormalSide;
            uint row = space.rows[i];
            uint wide = row | (row << 1) | (row >> 1);
            if (y > 0) wide |= space.rows[i - 1];
            if (y < kNormalSide - 1) wide |= space.rows[i + 1];
            if (i >= kNormalSide) wide |= space.rows[i - kNormalSide];
            if (i + kNormalSide < kNormalRows) wide |= space.rows[i + kNormalSide];
            wide &= kNormalRow & ~occupied.rows[i];
            wide |= row;
            if (wide != row) grew = true;
            space.rows[i] = wide;
        }
    }
    return space;
}

OCTAVO_FN int count_bits_of_row(uint row) {
    return count_bits8(row & 255u) + count_bits8(row >> 8);
}

// Faces, as vectors, and how many they are.
struct FaceSum {
    ivec3 sum;
    int count;
};

// The faces between occupied cells and the space; those near the hit count more.
OCTAVO_FN FaceSum faces_between(NormalBlock occupied, NormalBlock space) {
    FaceSum faces;
    faces.sum = ivec3(0);
    faces.count = 0;
    for (int radius = 1; radius <= kNormalRadius; radius += 1) {
        uint window = ((1u << (2 * radius + 1)) - 1u) << (kNormalRadius - radius);
        for (int z = kNormalRadius - radius; z <= kNormalRadius + radius; z += 1)
            for (int y = kNormalRadius - radius; y <= kNormalRadius + radius; y += 1) {
                int i = z * kNormalSide + y;
                uint cells = occupied.rows[i] & window;
                if (cells == 0u) continue;
                uint row = space.rows[i];
                ivec3 up = ivec3(count_bits_of_row((cells << 1) & row), 0, 0);
                ivec3 down = ivec3(count_bits_of_row((cells >> 1) & row), 0, 0);
                if (y < kNormalSide - 1) up.y = count_bits_of_row(cells & space.rows[i + 1]);
                if (y > 0) down.y = count_bits_of_row(cells & space.rows[i - 1]);
                if (z < kNormalSide - 1)
                    up.z = count_bits_of_row(cells & space.rows[i + kNormalSide]);
                if (z > 0) down.z = count_bits_of_row(cells & space.rows[i - kNormalSide]);
                faces.sum += up - down;
                faces.count += up.x + up.y + up.z + down.x + down.y + down.z;
            }
    }
    return faces;
}

// The normal that these faces stand for. face: the normal of the one that was hit.
//
// The steps of a plane add up to at least 1 / sqrt(3) of their number. Where faces cancel, as at
// the edge of a thin sheet, both sides of which can be seen, the face that was hit decides.
OCTAVO_FN vec3 normal_of_faces(FaceSum faces, vec3 face) {
    vec3 total = vec3(faces.sum);
    float missing = max(0.0f, 0.577f * float(faces.count) - length(total));
    vec3 normal = total + missing * face;
    float along = dot(normal, face);
    if (along <= 0.0f) normal -= along * face;
    float size = length(normal);
    return size > 0.0f ? normal / size : face;
}

OCTAVO_FN vec3 smooth_normal_32(DagView dag, GridRay ray, GridHit hit) {
    vec3 face = face_normal(ray, hit);
    if (hit.face >= kFaceInside) return face;
    NormalBlock occupied = occupied_around(dag, hit.path, hit.height);
    ivec3 before_hit = ivec3(kNormalRadius) + step_across(hit.face);
    NormalBlock space = space_connected_to(before_hit, occupied);
    return normal_of_faces(faces_between(occupied, space), face);
}

OCTAVO_SHARED_END
