// SPDX-License-Identifier: MIT
//
// What one thread of a GPU does in each pass over rays or pixels: it reads from arrays, calls the
// shared text of trace/ and render/, and writes to arrays. Shared text for CUDA, GLSL 4.6 and, in
// tests, C++; include after render/effects.h, or the files that it names.
//
// A job is what all threads of a pass have in common. Its first member is the DAG; arrays come
// before numbers, so that C++ and GLSL's scalar layout agree on where each lies.
#pragma once

OCTAVO_SHARED_BEGIN

OCTAVO_ARRAY(RayArray, GridRay)
OCTAVO_ARRAY(HitArray, GridHit)
OCTAVO_ARRAY(PointArray, SurfacePoint)
OCTAVO_ARRAY(ColorArray, vec3)
OCTAVO_ARRAY(FloatArray, float)
OCTAVO_ARRAY(UintArray, uint)
OCTAVO_ARRAY(LightArray, vec2)

// Rays that somebody else made: thread i traces ray i.
struct RayJob {
    DagView dag;
    RayArray rays;
    HitArray hits;       // of closest_pass()
    UintArray occluded;  // of any_pass(): 1 where the ray hits something
    Stop stop;
};

OCTAVO_FN void closest_pass(RayJob job, uint i) {
    job.hits.at[i] = trace_closest(job.dag, job.rays.at[i], job.stop);
}

OCTAVO_FN void any_pass(RayJob job, uint i) {
    job.occluded.at[i] = trace_any(job.dag, job.rays.at[i], job.stop) ? 1u : 0u;
}

// The pixels of a band of a picture, or the points of a G-buffer. Pixels lie in the arrays tile by
// tile, so that the 64 threads of a group work on the 8x8 pixels of a beam: thread i has pixel
// i % 64 of tile first_tile + i / 64.
struct PixelJob {
    DagView dag;
    FloatArray starts;     // by tile: before this time its rays meet nothing
    HitArray hits;         // primary
    FloatArray depths;     // of sample 0, voxels
    PointArray points;     // where secondary rays start
    UintArray sky_seen;    // ambient rays so far that met nothing
    LightArray lamp_seen;  // of this lamp's rays so far, see lamp_light()
    ColorArray light;      // of the lamps so far
    ColorArray colors;     // sum of the samples so far

    // a G-buffer: three numbers of each point, `stride` floats apart
    FloatArray positions;
    FloatArray normals;
    FloatArray shadow;   // out: the part of the lamp that is seen
    FloatArray ambient;  // out: the part of the sky

    // the picture
    CameraView camera;
    Stop stop;  // of primary rays
    ivec2 size;
    int tile_columns;
    int first_tile;
    int beams;  // 0: primary rays start at the camera
    int sample_number;
    int samples;
    int smoothed;  // 0: the faces' own normals
    uint frame;
    vec3 up;

    // the G-buffer
    vec3 grid_origin_high;  // world space; the sum of both is the grid's origin
    vec3 grid_origin_low;
    float voxels_per_unit;
    float bias;  // see visibility_bias()
    int position_stride;
    int normal_stride;
    uint first_point;

    // secondary rays: samples [first, end) of each pixel
    int first;
    int end;
    int sky_rays;  // in all passes together
    int lamp_rays;
    float sky_radius;  // voxels
    Stop sky_stop;
    int lamp_number;
    int shadows;  // 0: none
    int hard;     // not 0: rays to the lamp's middle alone
    int lamp_beams;
    vec3 intensity;
    PlacedLamp lamp;
};

OCTAVO_FN ivec2 tile_corner(PixelJob job, uint tile) {
    int t = job.first_tile + int(tile);
    return 8 * ivec2(t % job.tile_columns, t / job.tile_columns);
}
OCTAVO_FN ivec2 pixel_of(PixelJob job, uint i) {
    return tile_corner(job, i / 64u) + ivec2(int(i & 7u), int((i >> 3) & 7u));
}

OCTAVO_FN GridRay primary_ray(PixelJob job, uint i) {
    ivec2 pixel = pixel_of(job, i);
    vec2 inside = vec2(0.5f);
    if (job.samples > 1)
        inside = sample_2d(uint(job.sample_number),
                           pixel_seed(uint(pixel.x), uint(pixel.y), job.frame) ^ 0x2545f491u);
    return camera_ray(job.camera, pixel, inside);
}

// Thread i has tile i.
OCTAVO_FN void beam_pass(PixelJob job, uint i) {
    ivec2 low = tile_corner(job, i);
    ivec2 end = min(low + 8, job.size);
    job.starts.at[i] = beam_start(job.dag, camera_bundle(job.camera, low, end), job.stop);
}

OCTAVO_FN void primary_pass(PixelJob job, uint i) {
    ivec2 pixel = pixel_of(job, i);
    GridHit hit = make_miss(1e30f, 0);
    if (pixel.x < job.size.x && pixel.y < job.size.y) {
        GridRay ray = primary_ray(job, i);
        if (job.beams != 0) ray.t_min = job.starts.at[i / 64u];
        hit = trace_closest(job.dag, ray, job.stop);
    }
    job.hits.at[i] = hit;
    if (job.sample_number == 0) {
        job.depths.at[i] = hit.face != kFaceNone ? job.camera.t_before + hit.t : -1.0f;
        job.colors.at[i] = vec3(0.0f);
    }
}

OCTAVO_FN void surface_pass(PixelJob job, uint i) {
    SurfacePoint point;
    point.exists = 0;
    GridHit hit = job.hits.at[i];
    if (hit.face != kFaceNone) {
        GridRay ray = primary_ray(job, i);
        ivec2 pixel = pixel_of(job, i);
        uint seed = pixel_seed(uint(pixel.x), uint(pixel.y), job.frame);
        hit = move_to_open_face(job.dag, ray, hit);
        if (job.smoothed != 0)
            point = smoothed_point(job.dag, ray, hit, smooth_normal_32(job.dag, ray, hit), seed);
        else
            point = flat_point(ray, hit, seed);
    }
    job.points.at[i] = point;
    job.sky_seen.at[i] = 0u;
    job.lamp_seen.at[i] = vec2(0.0f);
    job.light.at[i] = vec3(0.0f);
}

// The point of a G-buffer's position and normal. One that is not finite, or a normal of no length,
// is no point.
OCTAVO_FN void gbuffer_pass(PixelJob job, uint i) {
    uint p = i * uint(job.position_stride);
    uint n = i * uint(job.normal_stride);
    vec3 world = vec3(job.positions.at[p], job.positions.at[p + 1u], job.positions.at[p + 2u]);
    vec3 given = vec3(job.normals.at[n], job.normals.at[n + 1u], job.normals.at[n + 2u]);
    float size = length(given);
    vec3 normal = given / size;
    // A voxel of the conservative rule reaches this far above its triangle (visibility_bias()).
    float reach = abs(normal.x) + abs(normal.y) + abs(normal.z) + 1e-3f;
    vec3 grid = exact_madd(job.voxels_per_unit,
                           (world - job.grid_origin_high) - job.grid_origin_low, vec3(0.0f));
    vec3 origin = exact_madd(job.bias * reach, normal, grid);
    float largest = max3(abs(origin));
    SurfacePoint point;
    point.exists = size > 0.0f && size < 1e30f && largest < 536870912.0f ? 1 : 0;
    if (point.exists != 0) {
        point.cell = ivec3(floor(origin));
        point.frac = origin - floor(origin);
        point.normal = normal;
        point.face = kFaceNone;
        point.seed = pixel_seed(job.first_point + i, 0u, job.frame);
    }
    job.points.at[i] = point;
    job.sky_seen.at[i] = 0u;
    job.lamp_seen.at[i] = vec2(0.0f);
}

OCTAVO_FN void sky_pass(PixelJob job, uint i) {
    SurfacePoint point = job.points.at[i];
    if (point.exists == 0) return;
    job.sky_seen.at[i] +=
        uint(sky_samples_seen(job.dag, surface_ray(point), point.face, point.normal, job.sky_radius,
                              job.sky_stop, job.first, job.end, point.seed ^ 0x68bc21ebu));
}

OCTAVO_FN void lamp_pass(PixelJob job, uint i) {
    SurfacePoint point = job.points.at[i];
    if (point.exists == 0) return;
    SeenPlacedLamp seen =
        see_lamp(job.lamp, surface_ray(point), point.face, point.normal, job.hard);
    job.lamp_seen.at[i] +=
        lamp_light(job.dag, job.lamp, seen, job.first, job.end,
                   lamp_seed(point.seed, job.lamp_number), job.shadows, job.lamp_beams);
}

// After the last lamp_pass() of a lamp.
OCTAVO_FN void light_pass(PixelJob job, uint i) {
    float seen = job.lamp_seen.at[i].x / float(job.lamp_rays);
    job.light.at[i] += 0.31830989f * seen * job.intensity;
    job.lamp_seen.at[i] = vec2(0.0f);
}

// After the last pass of a sample.
OCTAVO_FN void shade_pass(PixelJob job, uint i) {
    SurfacePoint point = job.points.at[i];
    if (point.exists == 0) {
        job.colors.at[i] += sky_color(primary_ray(job, i).dir, job.up);
        return;
    }
    float part = job.sky_rays == 0 ? 1.0f : float(job.sky_seen.at[i]) / float(job.sky_rays);
    vec3 ambient = part * sky_light(point.normal, job.up);
    job.colors.at[i] += clay() * (ambient + job.light.at[i]);
}

OCTAVO_FN void ambient_out_pass(PixelJob job, uint i) {
    bool exists = job.points.at[i].exists != 0;
    job.ambient.at[i] = exists ? float(job.sky_seen.at[i]) / float(job.sky_rays) : 1.0f;
}

OCTAVO_FN void shadow_out_pass(PixelJob job, uint i) {
    vec2 light = job.lamp_seen.at[i];
    float part = light.y > 0.0f ? light.x / light.y : 0.0f;
    job.shadow.at[i] = job.points.at[i].exists != 0 ? part : 1.0f;
}

OCTAVO_SHARED_END
