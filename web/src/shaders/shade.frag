// Each pixel's hit in the light of the sky and of lamps, added to the samples before it. The shading
// is that of octavo::render. Include after one surface, one looks and one lamps text.
uniform highp usampler2D hits;
uniform highp sampler2D sum_before;  // of the samples before this one
uniform bool first;                  // there is none
uniform vec3 up;
uniform int sky_samples;   // per sample of the pixel
uniform float sky_radius;  // voxels
uniform int shadows;  // 0: none; 1: towards the lamps' middles; 2: soft

layout(location = 0) out vec4 sum;  // alpha: rays

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
                                    hemisphere_seed(point.seed));
        sky = float(seen) / float(sky_samples);
        rays += float(sky_samples);
    }
    vec3 light = sky * sky_light(point.normal, up);

    for (int n = 0; n < lamp_count; n += 1) {
        LampSample one = lamp_towards(n, start, point, shadows == 2, sample_number);
        if (!(one.light > 0.0)) continue;
        if (shadows != 0) {
            rays += 1.0;
            if (trace_any(dag, one.ray, to_voxels)) continue;
        }
        light += 0.31830989 * one.light * lamp_intensity(n);
    }
    return vec4(look.albedo * light + look.emission, rays);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 pixel = pixel_of(at);
    GridRay ray = sample_ray(pixel);
    GridHit hit = unpack_hit(texelFetch(hits, at, 0));
    DagView dag = dag_view();
    if (hit.face == kFaceNone)
        sum = vec4(sky_color(ray.dir, up), 1.0);
    else
        sum = shade(dag, surface_point(dag, ray, hit, seed_of(pixel)), seen_look(dag, hit, -ray.dir));
    if (!first) sum += texelFetch(sum_before, at, 0);
}
