// The light stored for cells, and no other: octavo::render_lit with Lighting::cached. Include after
// one surface text and looks.glsl.
uniform highp usampler2D hits;
uniform highp sampler2D sum_before;  // of the samples before this one
uniform bool first;                  // there is none
uniform int sky_kind;  // of sky_radiance.h
uniform float sky_factor;
uniform vec3 sky_colors[3];  // zenith, horizon, ground
uniform vec3 up;

layout(location = 0) out vec4 sum;  // alpha: rays

vec3 open_sky(vec3 direction) {
    SkyView sky;
    sky.kind = sky_kind;
    sky.factor = sky_factor;
    sky.zenith = sky_colors[0];
    sky.horizon = sky_colors[1];
    sky.ground = sky_colors[2];
    sky.up = up;
    return sky_radiance(sky, direction);
}

vec4 picture_of(DagView dag, GridRay ray, GridHit hit) {
    if (hit.face == kFaceNone) return vec4(open_sky(ray.dir), 1.0);
    int seen = hit.face;
    if (hit.face >= kFaceInside) {
        vec3 way = abs(ray.dir);
        int axis = way.x >= max(way.y, way.z) ? 0 : (way.y >= way.z ? 1 : 2);
        seen = 2 * axis + (ray.dir[axis] < 0.0 ? 1 : 0);
    }
    vec3 towards = vec3(0.0);
    towards[seen / 2] = (seen & 1) == 1 ? 1.0 : -1.0;
    CellLook look = seen_look(dag, hit, towards);
    GridRay surface = surface_ray(flat_point(ray, hit, 0u));
    SurfacePoint point = surface_point(dag, ray, hit, 0u);
    LightView light;
    light.begin = cell_begins[5];
    vec3 arriving = cached_light(dag, cell_looks().cells, light, surface, point, hit.face);
    return vec4(look.emission + look.albedo * arriving, 9.0);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    GridHit hit = unpack_hit(texelFetch(hits, at, 0));
    sum = picture_of(dag_view(), sample_ray(pixel_of(at)), hit);
    if (!first) sum += texelFetch(sum_before, at, 0);
}
