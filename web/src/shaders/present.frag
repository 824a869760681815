// The mean of the samples, as a screen shows it: octavo::tone_map(). A picture of fewer pixels than
// the canvas is stretched.
precision highp float;
precision highp sampler2D;
uniform sampler2D sum;
uniform float samples;
uniform float exposure;  // factor
uniform bool tone_mapped;
uniform vec2 canvas;
layout(location = 0) out vec4 color;

vec3 bend(vec3 x) {
    const float shoulder = 0.6;
    vec3 bent = 1.0 - (1.0 - shoulder) * exp((shoulder - x) / (1.0 - shoulder));
    return mix(max(x, vec3(0.0)), bent, greaterThan(x, vec3(shoulder)));
}

vec3 to_srgb(vec3 x) {
    vec3 curve = 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055;
    return mix(curve, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

vec3 shown(ivec2 at) {
    vec3 mean = texelFetch(sum, clamp(at, ivec2(0), textureSize(sum, 0) - 1), 0).rgb / samples;
    return tone_mapped ? to_srgb(bend(mean * exposure)) : mean;
}

void main() {
    vec2 size = vec2(textureSize(sum, 0));
    if (size == canvas) {
        color = vec4(shown(ivec2(gl_FragCoord.xy)), 1.0);
        return;
    }
    vec2 at = gl_FragCoord.xy * size / canvas - 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 part = at - floor(at);
    vec3 below = mix(shown(low), shown(low + ivec2(1, 0)), part.x);
    vec3 above = mix(shown(low + ivec2(0, 1)), shown(low + ivec2(1, 1)), part.x);
    color = vec4(mix(below, above, part.y), 1.0);
}
