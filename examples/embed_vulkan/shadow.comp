// SPDX-License-Identifier: MIT
//
// An engine's own shader: hard shadows of a sun for the points of its G-buffer.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "octavo/trace/shared_text.h"

// The engine says where the words of the DAG lie: here in a storage buffer.
layout(set = 0, binding = 0, std430) readonly buffer Words { uint dag_words[]; };
struct DagView {
    int depth;
};
uint dag_load(DagView dag, uint word) {
    return dag_words[word];
}

#include "octavo/trace/traverse.h"

layout(set = 0, binding = 1, std430) readonly buffer Points { vec4 positions[]; };  // grid space
layout(set = 0, binding = 2, std430) writeonly buffer Lit { uint lit[]; };
layout(push_constant) uniform Constants {
    vec4 to_sun;
    int depth;
    uint points;
};
layout(local_size_x = 64) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= points) return;
    DagView dag;
    dag.depth = depth;
    GridRay ray;
    ray.cell = ivec3(floor(positions[i].xyz));
    ray.frac = positions[i].xyz - floor(positions[i].xyz);
    ray.dir = to_sun.xyz;
    ray.t_min = 0.0;
    ray.t_max = 1e30;
    Stop to_voxels;
    to_voxels.height = 0;
    to_voxels.cone = 0.0;
    to_voxels.time_before = 0.0;
    lit[i] = trace_any(dag, ray, to_voxels) ? 0u : 1u;
}
