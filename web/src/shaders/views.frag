// What each pixel's hit is, without light: its normal, level, steps or colour. Include after
// plain_view.h, one surface and one looks text.
const int kNormals = 1;
const int kLevels = 2;
const int kSteps = 3;

uniform highp usampler2D hits;
uniform highp sampler2D sum_before;  // of the samples before this one
uniform bool first;                  // there is none
uniform int mode;
uniform vec3 up;
uniform float depth_levels;  // of the whole grid

layout(location = 0) out vec4 sum;  // alpha: rays

vec3 view_of(DagView dag, GridRay ray, GridHit hit) {
    if (mode == kSteps) return steps_view(hit);
    if (hit.face == kFaceNone) return empty_view(ray, up);
    if (mode == kLevels) return level_view(dag, ray, hit, depth_levels);
    if (mode == kNormals) return normal_view(surface_point(dag, ray, hit, 0u).normal);
    CellLook look = seen_look(dag, hit, -ray.dir);
    return color_view(look.albedo + look.emission);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    GridHit hit = unpack_hit(texelFetch(hits, at, 0));
    sum = vec4(view_of(dag_view(), sample_ray(pixel_of(at)), hit), 1.0);
    if (!first) sum += texelFetch(sum_before, at, 0);
}
