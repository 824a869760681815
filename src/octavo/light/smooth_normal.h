// SPDX-License-Identifier: MIT
//
// A unit normal of the surface that the voxels around a hit stand for. Shared text: include after
// surface.h. normal.h says what it does; this is the same in 32-bit words, for GPUs, and the oracle
// of the 64-bit one.
#pragma once

OCTAVO_SHARED_BEGIN

const int kNormalRadius = 5;  // cells on each side of the one that was hit
const int kNormalSide = 11;
const int kNormalRows = 121;  // row y of layer z is at 11 z + y; bit x of it is a cell
const uint kNormalRow = 0x7ffu;

OCTAVO_FN int count_bits_of_row(uint row) {
    return count_bits8(row & 255u) + count_bits8(row >> 8);
}

// Faces, as vectors, and how many they are.
struct FaceSum {
    ivec3 sum;
    int count;
};

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

// One function, not one for each step: shared text hands arrays over by value, and three copies of
// 121 words took 5 % more of a picture on a software GPU.
OCTAVO_FN vec3 smooth_normal_32(DagView dag, GridRay ray, GridHit hit) {
    vec3 face = face_normal(ray, hit);
    if (hit.face >= kFaceInside) return face;

    // 1. The cells of the block that exist: down the tree, leaving out what is outside the block.
    uint occupied[kNormalRows];
    for (int i = 0; i < kNormalRows; i += 1) occupied[i] = 0u;
    uint nodes[kPathCells];
    uint to_visit[kPathCells];
    uvec2 mask = uvec2(0u);
    uint node = 0u;
    int child = 0;
    int height = dag.depth;
    ivec3 block = ivec3(hit.path) - kNormalRadius;  // its low corner, in cells
    ivec3 corner = ivec3(0);                        // of the node, in cells
    bool done = false;
    while (!done) {
        int width = 1 << (height - hit.height);
        ivec3 inside = corner - block;
        uint children = 0u;
        if (all(lessThan(inside, ivec3(kNormalSide))) &&
            all(greaterThan(inside + width, ivec3(0)))) {
            if (height == hit.height) {
                occupied[inside.z * kNormalSide + inside.y] |= 1u << inside.x;
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
            corner &= -(1 << (height - hit.height));
            height -= 1;
            corner += ivec3(child & 1, (child >> 1) & 1, child >> 2) << (height - hit.height);
        }
    }

    // 2. The empty cells that are connected through faces to the one before the hit.
    uint space[kNormalRows];
    for (int i = 0; i < kNormalRows; i += 1) space[i] = 0u;
    ivec3 from = ivec3(kNormalRadius) + step_across(hit.face);
    space[from.z * kNormalSide + from.y] = 1u << from.x;
    bool grew = true;
    while (grew) {
        grew = false;
        for (int k = 0; k < 2 * kNormalRows; k += 1) {
            int i = k < kNormalRows ? k : 2 * kNormalRows - 1 - k;  // up, then down again
            int y = i % kNormalSide;
            uint row = space[i];
            uint wide = row | (row << 1) | (row >> 1);
            if (y > 0) wide |= space[i - 1];
            if (y < kNormalSide - 1) wide |= space[i + 1];
            if (i >= kNormalSide) wide |= space[i - kNormalSide];
            if (i + kNormalSide < kNormalRows) wide |= space[i + kNormalSide];
            wide &= kNormalRow & ~occupied[i];
            wide |= row;
            if (wide != row) grew = true;
            space[i] = wide;
        }
    }

    // 3. The faces between the two, as vectors, and their number; those near the hit count more.
    FaceSum faces;
    faces.sum = ivec3(0);
    faces.count = 0;
    for (int radius = 1; radius <= kNormalRadius; radius += 1) {
        uint window = ((1u << (2 * radius + 1)) - 1u) << (kNormalRadius - radius);
        for (int z = kNormalRadius - radius; z <= kNormalRadius + radius; z += 1)
            for (int y = kNormalRadius - radius; y <= kNormalRadius + radius; y += 1) {
                int i = z * kNormalSide + y;
                uint cells = occupied[i] & window;
                if (cells == 0u) continue;
                ivec3 up = ivec3(count_bits_of_row((cells << 1) & space[i]), 0, 0);
                ivec3 down = ivec3(count_bits_of_row((cells >> 1) & space[i]), 0, 0);
                if (y < kNormalSide - 1) up.y = count_bits_of_row(cells & space[i + 1]);
                if (y > 0) down.y = count_bits_of_row(cells & space[i - 1]);
                if (z < kNormalSide - 1) up.z = count_bits_of_row(cells & space[i + kNormalSide]);
                if (z > 0) down.z = count_bits_of_row(cells & space[i - kNormalSide]);
                faces.sum += up - down;
                faces.count += up.x + up.y + up.z + down.x + down.y + down.z;
            }
    }
    return normal_of_faces(faces, face);
}

OCTAVO_SHARED_END
