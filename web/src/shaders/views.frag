// What each pixel's hit is, without light: its normal, level, steps or colour. Include after one
// surface and one looks text.
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

vec4 picture_of(DagView dag, GridRay ray, GridHit hit) {
    if (mode == kSteps) return vec4(ramp(float(hit.steps) / 128.0), 1.0);
    if (hit.face == kFaceNone) return vec4(vec3(0.5 + 0.5 * dot(normalize(ray.dir), up)) * 0.08 + 0.05, 1.0);
    if (mode == kLevels) {
        float level = float(depth - hit.height) / depth_levels;
        float facing = hit.face >= kFaceInside ? 1.0 : abs(normalize(ray.dir)[hit.face / 2]);
        return vec4(ramp(level) * (0.7 + 0.3 * facing), 1.0);
    }
    if (mode == kNormals) return vec4(0.5 + 0.5 * surface_point(dag, ray, hit, 0u).normal, 1.0);
    CellLook look = seen_look(dag, hit, -ray.dir);
    return vec4(srgb(look.albedo + look.emission), 1.0);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    GridHit hit = unpack_hit(texelFetch(hits, at, 0));
    sum = picture_of(dag_view(), sample_ray(pixel_of(at)), hit);
    if (!first) sum += texelFetch(sum_before, at, 0);
}
