// What each pixel's hit is asked to show, added to the samples before it. The shading is that of
// octavo::render.
const int kShaded = 0;
const int kNormals = 1;
const int kLevels = 2;
const int kSteps = 3;
const int kColor = 4;

uniform highp usampler2D hits;
uniform highp usampler2D cache;      // see hit.glsl
uniform highp sampler2D sum_before;  // of the samples before this one
uniform bool first;                  // there is none
uniform bool smoothed;
uniform int mode;
uniform vec3 up;
uniform float depth_levels;  // of the whole grid
uniform int sky_samples;     // per sample of the pixel
uniform float sky_radius;    // voxels
uniform int shadows;  // 0: none; 1: towards the lamps' middles; 2: soft

layout(location = 0) out vec4 sum;  // alpha: rays

// Five colours, dark to light; the page's legend has the same.
vec3 ramp(float t) {
    const vec3 stops[5] = vec3[5](vec3(0.13, 0.10, 0.27), vec3(0.16, 0.34, 0.55), vec3(0.14, 0.60, 0.56),
                                  vec3(0.62, 0.78, 0.35), vec3(0.99, 0.91, 0.57));
    float at = 4.0 * clamp(t, 0.0, 1.0);
    int i = min(int(at), 3);
    return mix(stops[i], stops[i + 1], at - float(i));
}

vec3 srgb(vec3 x) {
    x = clamp(x, 0.0, 1.0);
    return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

SurfacePoint surface_point(DagView dag, GridRay ray, GridHit hit, uint seed) {
    if (smoothed && hit.face < kFaceInside) {
        uvec4 slot = texelFetch(cache, slot_of(hit), 0);
        if (slot.xyz == slot_key(hit)) return smoothed_point(dag, ray, hit, unpack_normal(slot.w), seed);
    }
    return flat_point(ray, hit, seed);
}

vec4 shade(DagView dag, SurfacePoint point, CellLook look) {
    Stop to_voxels;
    to_voxels.height = primary_stop.height;
    to_voxels.cone = 0.0;
    to_voxels.time_before = 0.0;
    GridRay start = surface_ray(point);
    float rays = 1.0;

    float sky = 1.0;
    if (sky_samples > 0) {
        int seen = sky_samples_seen(dag, start, point.face, point.normal, sky_radius, to_voxels,
                                    sample_number * sky_samples, (sample_number + 1) * sky_samples,
                                    point.seed ^ 0x68bc21ebu);
        sky = float(seen) / float(sky_samples);
        rays += float(sky_samples);
    }
    vec3 light = sky * sky_light(point.normal, up);

    for (int n = 0; n < lamp_count; n += 1) {
        PlacedLamp lamp = placed_lamp(n);
        SeenPlacedLamp seen = see_lamp(lamp, start, point.face, point.normal, shadows == 2 ? 0 : 1);
        if (seen.dark != 0) continue;
        LampSample one = lamp_sample(lamp, seen, sample_number, lamp_seed(point.seed, n));
        if (!(one.light > 0.0)) continue;
        if (shadows != 0) {
            rays += 1.0;
            if (trace_any(dag, one.ray, to_voxels)) continue;
        }
        light += 0.31830989 * one.light * lamp_intensity(n);
    }
    return vec4(look.albedo * light + look.emission, rays);
}

vec4 picture_of(DagView dag, GridRay ray, GridHit hit, uint seed) {
    if (mode == kSteps) return vec4(ramp(float(hit.steps) / 128.0), 1.0);
    if (hit.face == kFaceNone) {
        if (mode == kShaded) return vec4(sky_color(ray.dir, up), 1.0);
        return vec4(vec3(0.5 + 0.5 * dot(normalize(ray.dir), up)) * 0.08 + 0.05, 1.0);
    }
    if (mode == kLevels) {
        float level = float(depth - hit.height) / depth_levels;
        float facing = hit.face >= kFaceInside ? 1.0 : abs(normalize(ray.dir)[hit.face / 2]);
        return vec4(ramp(level) * (0.7 + 0.3 * facing), 1.0);
    }
    CellLook look = seen_look(dag, hit, -ray.dir);
    if (mode == kColor) return vec4(srgb(look.albedo + look.emission), 1.0);
    SurfacePoint point = surface_point(dag, ray, hit, seed);
    if (mode == kNormals) return vec4(0.5 + 0.5 * point.normal, 1.0);
    return shade(dag, point, look);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 pixel = pixel_of(at);
    GridHit hit = unpack_hit(texelFetch(hits, at, 0));
    sum = picture_of(dag_view(), sample_ray(pixel), hit, seed_of(pixel));
    if (!first) sum += texelFetch(sum_before, at, 0);
}
