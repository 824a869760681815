// SPDX-License-Identifier: MIT
//
// The rays from a point to a lamp of any kind, and the light that each brings. Shared text: include
// after shadow.h and surface.h. A backend includes before it lamp_triangle.h and
//     its own  struct LampTriangles { ...; };                     all triangles of a lamp
//     and      LampTriangle lamp_triangle(LampTriangles triangles, int number);
#pragma once

OCTAVO_SHARED_BEGIN

const int kSunLamp = 0;
const int kPointLamp = 1;  // spots too
const int kPatchLamp = 2;  // a disc or rectangle, which shines to one side
const int kMeshLamp = 3;   // triangles, which shine to both

// Rays from which on the two walks of a bundle cost less than they save.
const int kRaysForABeam = 16;

// For the choice of a triangle; the place on it takes the seed as it is.
const uint kTriangleSeed = 0x7f4a7c15u;

// Triangles that a ray chooses among, and what makes the choice.
const int kCandidates = 8;
const uint kChoiceSeed = 0x1b56c4e9u;

// Voxels above a lamp's surface where rays to it end: above the square root of 3, the farthest that
// a voxel which touches the surface reaches. Lamps with an area are often voxels as well, and these
// must not shade the lamp.
OCTAVO_FN float above_lamp() {
    return 1.75f;
}

// A light in a grid.
struct PlacedLamp {
    LampTriangles triangles;  // of a mesh
    int triangle_count;
    int kind;
    ivec3 cell;  // where it stands: cell + frac; of a patch the middle
    vec3 frac;
    vec3 direction;  // the way the light travels, unit length; not of points and meshes
    float radius;    // sun: angular; others: voxels
    vec3 u;          // of a patch, see LampPatch
    vec3 v;
    int shape;
    float area;        // square voxels
    float voxel_size;  // world units: of a point the light falls off with their square
    float cos_inner;   // of a spot's angles; both -2 for a point that shines all round
    float cos_outer;
    vec3 low;  // of a mesh: its bounds, counted from cell + frac
    vec3 high;
};

// A lamp as one point of a surface sees it.
struct SeenPlacedLamp {
    GridRay start;
    int face;
    vec3 normal;
    LampPatch target;  // of all but a mesh
    float light;       // of each ray where they are all alike, else 0
    int dark;          // 1: no light can come from it, whatever is in the way
};

// A ray towards a lamp, and the light that comes along it where nothing is in the way: a part of
// the lamp's intensity, the cosine at the point included. A ray without light need not be traced.
struct LampSample {
    GridRay ray;
    float light;
};

OCTAVO_FN vec3 way_to(GridRay start, ivec3 cell, vec3 frac) {
    return vec3(cell - start.cell) + (frac - start.frac);
}

// What a radiance of 1 that leaves `area` square voxels in all directions brings to the point.
// direction: of the ray, which ends above the lamp.
OCTAVO_FN float area_light(vec3 direction, vec3 normal, vec3 lamp_normal, float area) {
    vec3 way = direction - above_lamp() * lamp_normal;
    float squared = max(dot(way, way), above_lamp() * above_lamp());
    float at_point = max(0.0f, dot(way, normal));
    float at_lamp = max(0.0f, -dot(way, lamp_normal));
    return area * at_point * at_lamp / (squared * squared);
}

// start, face: see sky_ray(). normal: unit length. hard: not 0 where all rays go to the lamp's
// middle; a mesh has none.
OCTAVO_FN SeenPlacedLamp see_lamp(PlacedLamp lamp, GridRay start, int face, vec3 normal, int hard) {
    SeenPlacedLamp seen;
    seen.start = start;
    seen.face = face;
    seen.normal = normal;
    seen.light = 0.0f;
    seen.dark = 0;
    seen.target = facing_disc(vec3(0.0f, 1.0f, 0.0f), 0.0f, 1.0f);
    float radius = hard != 0 ? 0.0f : lamp.radius;
    if (lamp.kind == kMeshLamp) {
        seen.dark = lamp.triangle_count == 0 ? 1 : 0;
    } else if (lamp.kind == kSunLamp) {
        seen.target = facing_disc(-lamp.direction, radius, 1e30f);
        seen.light = dot(normal, seen.target.centre);
        seen.dark = seen.light > 0.0f ? 0 : 1;
    } else if (lamp.kind == kPointLamp) {
        vec3 way = way_to(start, lamp.cell, lamp.frac);
        vec3 towards = normalize(way);
        float distance = max(length(way) * lamp.voxel_size, 1e-15f);
        seen.target = facing_disc(way, radius, 1.0f);
        seen.light = dot(normal, towards) / (distance * distance);
        if (lamp.cos_outer > -1.5f) {
            float into = (-dot(towards, lamp.direction) - lamp.cos_outer) /
                         (lamp.cos_inner - lamp.cos_outer);
            float part = clamp(into, 0.0f, 1.0f);
            seen.light *= part * part * (3.0f - 2.0f * part);
        }
        seen.dark = seen.light > 0.0f ? 0 : 1;
    } else {
        vec3 way = way_to(start, lamp.cell, lamp.frac);
        seen.dark = dot(way, lamp.direction) >= 0.0f ? 1 : 0;  // behind it
        seen.target.centre = way + above_lamp() * lamp.direction;
        seen.target.u = lamp.u;
        seen.target.v = lamp.v;
        seen.target.shape = lamp.shape;
        if (hard != 0) {
            seen.light = area_light(seen.target.centre, normal, lamp.direction, lamp.area);
            seen.target.u = vec3(0.0f);
            seen.target.v = vec3(0.0f);
            if (!(seen.light > 0.0f)) seen.dark = 1;
        }
    }
    return seen;
}

// The triangle in which this much of the mesh's area is reached.
OCTAVO_FN int triangle_at_area(PlacedLamp lamp, float area) {
    int low = 0;
    int high = lamp.triangle_count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (lamp_triangle(lamp.triangles, middle).area_so_far > area)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

// A point of one triangle. Some triangles are drawn by their area, and one of these by its
// distance: where a lamp is spread over the scene, say all lanterns of a street, most rays so go to
// what is near. After Talbot, Cline and Egbert, "Importance Resampling for Global Illumination",
// 2005.
OCTAVO_FN LampSample mesh_sample(PlacedLamp lamp, SeenPlacedLamp seen, int i, uint seed) {
    float place = sample_1d(uint(i), seed ^ kTriangleSeed);
    float left = sample_1d(uint(i), seed ^ kChoiceSeed);
    vec3 to_lamp = way_to(seen.start, lamp.cell, lamp.frac);
    int chosen = 0;
    float sum = 0.0f;
    float weight = 1.0f;
    for (int k = 0; k < kCandidates; k += 1) {
        int at = triangle_at_area(lamp, lamp.area * ((place + float(k)) / float(kCandidates)));
        LampTriangle candidate = lamp_triangle(lamp.triangles, at);
        vec3 way = to_lamp + candidate.middle;
        float by_distance = 1.0f / (dot(way, way) + candidate.squared);
        sum += by_distance;
        // The random number is used up bit by bit: what is left of it is even in [0, 1) again.
        float part = by_distance / sum;
        if (left < part) {
            chosen = at;
            weight = by_distance;
            left /= part;
        } else {
            left = (left - part) / (1.0f - part);
        }
    }
    LampTriangle triangle = lamp_triangle(lamp.triangles, chosen);
    vec3 way = way_to(seen.start, triangle.cell, triangle.frac);
    vec3 normal = dot(way, triangle.normal) > 0.0f ? -triangle.normal : triangle.normal;
    LampPatch target;
    target.centre = way + above_lamp() * normal;
    target.u = triangle.u;
    target.v = triangle.v;
    target.shape = kTriangleShape;
    target.t_end = 1.0f;
    LampSample result;
    result.ray = lamp_ray(seen.start, seen.face, target, i, seed);
    result.light = sum / (float(kCandidates) * weight) *
                   area_light(result.ray.dir, seen.normal, normal, lamp.area);
    return result;
}

// Ray i of the pixel with this seed. The mean over all i is the light that the lamp gives.
OCTAVO_FN LampSample lamp_sample(PlacedLamp lamp, SeenPlacedLamp seen, int i, uint seed) {
    if (lamp.kind == kMeshLamp) return mesh_sample(lamp, seen, i, seed);
    LampSample result;
    result.ray = lamp_ray(seen.start, seen.face, seen.target, i, seed);
    result.light = seen.light;
    if (!(seen.light > 0.0f))
        result.light = area_light(result.ray.dir, seen.normal, lamp.direction, lamp.area);
    return result;
}

// All rays to the lamp are in here.
OCTAVO_FN Bundle seen_lamp_bundle(PlacedLamp lamp, SeenPlacedLamp seen) {
    if (lamp.kind != kMeshLamp) return lamp_bundle(seen.start, seen.face, seen.target);
    vec3 way = way_to(seen.start, lamp.cell, lamp.frac);
    float above = 1.001f * above_lamp();
    return shadow_bundle(seen.start, seen.face, way + lamp.low - above, way + lamp.high + above,
                         1.0f);
}

// The times between which geometry may be on rays to the lamp ([K13] section 4): (t_min, t_max),
// and nothing where t_min >= t_max.
OCTAVO_FN vec2 lamp_interval(DagView dag, PlacedLamp lamp, SeenPlacedLamp seen) {
    Bundle bundle = seen_lamp_bundle(lamp, seen);
    bundle.t_min = beam_start(dag, bundle, stop_at_voxels());
    float t_max = bundle.t_min;
    if (bundle.t_min < bundle.t_max) t_max = beam_end(dag, bundle, stop_at_voxels());
    return vec2(bundle.t_min, t_max);
}

// The light of the samples [first, end) of a pixel: of those that see the lamp, and of all. With
// shadows 0 all see it. Rays are cut to `interval`, and where that is empty they are not traced:
// with that of lamp_interval() they see the same, to the bit, as with (0, 1e30).
OCTAVO_FN vec2 lamp_light(DagView dag, PlacedLamp lamp, SeenPlacedLamp seen, vec2 interval,
                          int first, int end, uint seed, int shadows) {
    vec2 light = vec2(0.0f);
    if (seen.dark != 0) return light;
    for (int i = first; i < end; i += 1) {
        LampSample one = lamp_sample(lamp, seen, i, seed);
        if (!(one.light > 0.0f)) continue;
        one.ray.t_min = max(one.ray.t_min, interval.x);
        one.ray.t_max = min(one.ray.t_max, interval.y);
        bool open = shadows == 0 || !(one.ray.t_min < one.ray.t_max) ||
                    !trace_any(dag, one.ray, stop_at_voxels());
        light += vec2(open ? one.light : 0.0f, one.light);
    }
    return light;
}

OCTAVO_SHARED_END
