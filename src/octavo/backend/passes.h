// SPDX-License-Identifier: MIT
//
// What one thread of a GPU does in each pass over rays or pixels: it reads from arrays, calls the
// shared text of trace/ and render/, and writes to arrays. Shared text for CUDA, GLSL 4.6 and, in
// tests, C++; include after render/effects.h, light/cell_views.h and light/sky.h, or the shared
// text that they name.
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
    FloatArray starts;      // by tile: before this time its rays meet nothing
    HitArray hits;          // primary
    FloatArray depths;      // of sample 0, voxels
    PointArray points;      // where secondary rays start
    UintArray sky_seen;     // ambient rays so far that met nothing
    LightArray lamp_times;  // of lamp_beam_pass(): lamp_interval() of this lamp
    LightArray lamp_seen;   // of this lamp's rays so far, see lamp_light()
    ColorArray light;       // of the lamps so far
    ColorArray colors;      // sum of the samples so far
    ColorArray albedos;     // of what each pixel sees, with `colored`
    ColorArray emissions;

    CellLooks looks;  // of the DAG's cells, with `colored`
    LightView cell_light;
    SkyView sky;  // with `own_sky`

    // a G-buffer: three numbers of each point, `stride` floats apart
    FloatArray positions;
    FloatArray normals;
    FloatArray shadow;   // out: the part of the lamp that is seen
    FloatArray ambient;  // out: the part of the sky
    // out, three numbers of each point; used where `wanted` has their bit
    FloatArray point_albedo;
    FloatArray point_emission;
    FloatArray point_light;

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
    int colored;   // 0: clay
    int own_sky;   // 0: the clear one of shade.h
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
    int wanted;

    // secondary rays: samples [first, end) of each pixel
    int first;
    int end;
    int sky_rays;  // in all passes together
    int lamp_rays;
    float sky_radius;  // voxels
    Stop sky_stop;
    int lamp_number;
    int shadows;     // 0: none
    int hard;        // not 0: rays to the lamp's middle alone
    int lamp_beams;  // 0: its rays start at the surface
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

// A point of a G-buffer, in grid space, lifted along its normal by `bias` times as far as a voxel
// of the conservative rule can reach above its triangle. dir: the normal, which has no length where
// the point is none: not finite, without a normal, or too far away.
OCTAVO_FN GridRay gbuffer_ray(PixelJob job, uint i, float bias) {
    uint p = i * uint(job.position_stride);
    uint n = i * uint(job.normal_stride);
    vec3 world = vec3(job.positions.at[p], job.positions.at[p + 1u], job.positions.at[p + 2u]);
    vec3 given = vec3(job.normals.at[n], job.normals.at[n + 1u], job.normals.at[n + 2u]);
    float size = length(given);
    vec3 normal = given / size;
    float reach = abs(normal.x) + abs(normal.y) + abs(normal.z) + 1e-3f;
    vec3 grid = exact_madd(job.voxels_per_unit,
                           (world - job.grid_origin_high) - job.grid_origin_low, vec3(0.0f));
    vec3 origin = exact_madd(bias * reach, normal, grid);
    bool exists = size > 0.0f && size < 1e30f && max3(abs(origin)) < 536870912.0f;
    GridRay ray;
    ray.cell = exists ? ivec3(floor(origin)) : ivec3(0);
    ray.frac = origin - floor(origin);
    ray.dir = exists ? normal : vec3(0.0f);
    ray.t_min = 0.0f;
    ray.t_max = 1e30f;
    return ray;
}

OCTAVO_FN void gbuffer_pass(PixelJob job, uint i) {
    GridRay start = gbuffer_ray(job, i, job.bias);
    SurfacePoint point;
    point.exists = start.dir != vec3(0.0f) ? 1 : 0;
    point.cell = start.cell;
    point.frac = start.frac;
    point.normal = start.dir;
    point.face = kFaceNone;
    point.seed = pixel_seed(job.first_point + i, 0u, job.frame);
    job.points.at[i] = point;
    job.sky_seen.at[i] = 0u;
    job.lamp_seen.at[i] = vec2(0.0f);
}

OCTAVO_FN void sky_pass(PixelJob job, uint i) {
    SurfacePoint point = job.points.at[i];
    if (point.exists == 0) return;
    job.sky_seen.at[i] +=
        uint(sky_samples_seen(job.dag, surface_ray(point), point.face, point.normal, job.sky_radius,
                              job.sky_stop, job.first, job.end, hemisphere_seed(point.seed)));
}

OCTAVO_FN SeenPlacedLamp see_lamp_from(PixelJob job, SurfacePoint point) {
    return see_lamp(job.lamp, surface_ray(point), point.face, point.normal, job.hard);
}

// Apart from lamp_pass(), as the walk of a bundle takes registers that rays do not need.
OCTAVO_FN void lamp_beam_pass(PixelJob job, uint i) {
    SurfacePoint point = job.points.at[i];
    if (point.exists == 0) return;
    SeenPlacedLamp seen = see_lamp_from(job, point);
    if (seen.dark == 0) job.lamp_times.at[i] = lamp_interval(job.dag, job.lamp, seen);
}

OCTAVO_FN void lamp_pass(PixelJob job, uint i) {
    SurfacePoint point = job.points.at[i];
    if (point.exists == 0) return;
    vec2 interval = job.lamp_beams != 0 ? job.lamp_times.at[i] : vec2(0.0f, 1e30f);
    job.lamp_seen.at[i] +=
        lamp_light(job.dag, job.lamp, see_lamp_from(job, point), interval, job.first, job.end,
                   lamp_seed(point.seed, job.lamp_number), job.shadows);
}

// After the last lamp_pass() of a lamp.
OCTAVO_FN void light_pass(PixelJob job, uint i) {
    float seen = job.lamp_seen.at[i].x / float(job.lamp_rays);
    job.light.at[i] += 0.31830989f * seen * job.intensity;
    job.lamp_seen.at[i] = vec2(0.0f);
}

OCTAVO_FN vec3 open_sky(PixelJob job, uint i) {
    vec3 direction = primary_ray(job, i).dir;
    return job.own_sky != 0 ? sky_radiance(job.sky, direction) : sky_color(direction, job.up);
}

// After primary_pass(): what the cells that are seen look like.
OCTAVO_FN void looks_pass(PixelJob job, uint i) {
    GridHit hit = job.hits.at[i];
    if (hit.face == kFaceNone) return;
    GridRay ray = primary_ray(job, i);
    hit = move_to_open_face(job.dag, ray, hit);
    CellLook look = cell_look(job.dag, job.looks, hit.path, job.dag.depth - hit.height, -ray.dir);
    job.albedos.at[i] = look.albedo.x < 0.0f ? clay() : look.albedo;
    job.emissions.at[i] = look.emission;
}

// After the last pass of a sample.
OCTAVO_FN void shade_pass(PixelJob job, uint i) {
    SurfacePoint point = job.points.at[i];
    if (point.exists == 0) {
        job.colors.at[i] += open_sky(job, i);
        return;
    }
    float part = job.sky_rays == 0 ? 1.0f : float(job.sky_seen.at[i]) / float(job.sky_rays);
    vec3 ambient = part * (job.own_sky != 0 ? diffuse_sky(job.sky, point.normal)
                                            : sky_light(point.normal, job.up));
    vec3 light = ambient + job.light.at[i];
    if (job.colored != 0)
        job.colors.at[i] += job.albedos.at[i] * light + job.emissions.at[i];
    else
        job.colors.at[i] += clay() * light;
}

// The face of a cell that a ray sees: where it starts inside the cell, the one that it came from.
OCTAVO_FN int face_seen(GridRay ray, GridHit hit) {
    if (hit.face < kFaceInside) return hit.face;
    vec3 way = abs(ray.dir);
    int axis = way.x >= max(way.y, way.z) ? 0 : (way.y >= way.z ? 1 : 2);
    return 2 * axis + (ray.dir[axis] < 0.0f ? 1 : 0);
}

// Instead of all passes after primary_pass(): the light stored for cells, as octavo::render_lit()
// with Lighting::cached has it.
OCTAVO_FN void cached_pass(PixelJob job, uint i) {
    GridHit hit = job.hits.at[i];
    if (hit.face == kFaceNone) {
        job.colors.at[i] += open_sky(job, i);
        return;
    }
    GridRay ray = primary_ray(job, i);
    vec3 towards = vec3(0.0f);
    int seen = face_seen(ray, hit);
    towards[seen / 2] = (seen & 1) == 1 ? 1.0f : -1.0f;
    CellLook look = cell_look(job.dag, job.looks, hit.path, job.dag.depth - hit.height, towards);
    hit = move_to_open_face(job.dag, ray, hit);
    SurfacePoint point = flat_point(ray, hit, 0u);
    GridRay surface = surface_ray(point);
    if (job.smoothed != 0)
        point = smoothed_point(job.dag, ray, hit, smooth_normal_32(job.dag, ray, hit), 0u);
    vec3 light = cached_light(job.dag, job.looks.cells, job.cell_light, surface, point, hit.face);
    vec3 albedo = look.albedo.x < 0.0f ? clay() : look.albedo;
    job.colors.at[i] += look.emission + albedo * light;
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

const int kWantAlbedo = 1;
const int kWantEmission = 2;
const int kWantLight = 4;

// What the cell at a point of a G-buffer looks like from the side of its normal, and the light
// stored around it. After gbuffer_pass().
OCTAVO_FN void gbuffer_looks_pass(PixelJob job, uint i) {
    SurfacePoint point = job.points.at[i];
    vec3 albedo = vec3(0.0f);
    vec3 emission = vec3(0.0f);
    vec3 light = vec3(0.0f);
    if (point.exists != 0) {
        GridRay surface = gbuffer_ray(job, i, 0.0f);
        surface.dir = point.normal;
        uint cell = cell_at(job.dag, job.looks.cells, surface.cell, surface.frac);
        if (cell != kNoCell) {
            CellLook look = look_of_cell(job.looks, cell, point.normal);
            albedo = look.albedo.x < 0.0f ? clay() : look.albedo;
            emission = look.emission;
        }
        if ((job.wanted & kWantLight) != 0)
            light =
                cached_light(job.dag, job.looks.cells, job.cell_light, surface, point, kFaceNone);
    }
    for (int axis = 0; axis < 3; axis += 1) {
        uint at = 3u * i + uint(axis);
        if ((job.wanted & kWantAlbedo) != 0) job.point_albedo.at[at] = albedo[axis];
        if ((job.wanted & kWantEmission) != 0) job.point_emission.at[at] = emission[axis];
        if ((job.wanted & kWantLight) != 0) job.point_light.at[at] = light[axis];
    }
}

OCTAVO_SHARED_END
