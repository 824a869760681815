// SPDX-License-Identifier: MIT
//
// One pass of backend/passes.h. Compiled once for each, with OCTAVO_PASS its function and OCTAVO_JOB
// the type of its job.
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "octavo/trace/shared_text.h"

#include "octavo/backend/vulkan/dag_view.glsl"

#include "octavo/trace/traverse.h"

#include "octavo/trace/beam.h"

#include "octavo/backend/vulkan/cell_views.glsl"

#include "octavo/attributes/cell_rank.h"
#include "octavo/attributes/cell_value.h"
#include "octavo/attributes/srgb.h"

#include "octavo/attributes/cell_looks.h"
#include "octavo/light/sky_radiance.h"

#include "octavo/light/sampling.h"

#include "octavo/render/ambient_occlusion.h"
#include "octavo/render/camera_ray.h"
#include "octavo/light/shade.h"
#include "octavo/light/shadow.h"
#include "octavo/light/surface.h"

#include "octavo/light/cached_light.h"
#include "octavo/light/lamp_triangle.h"

OCTAVO_ARRAY(LampTriangles, LampTriangle)
LampTriangle lamp_triangle(LampTriangles triangles, int number) {
    return triangles.at[number];
}

#include "octavo/light/lamp_light.h"
#include "octavo/light/smooth_normal.h"

#include "octavo/backend/passes.h"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Job {
    OCTAVO_JOB job;
};
layout(push_constant, scalar) uniform Launch {
    Job job;
    uint first;    // thread of this dispatch
    uint threads;  // of the whole pass
} launch;

void main() {
    uint i = launch.first + gl_GlobalInvocationID.x;
    if (i < launch.threads) OCTAVO_PASS(launch.job.job, i);
}
