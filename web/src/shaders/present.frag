// The mean of the samples, as a screen shows it: octavo::tone_map(). A picture of fewer pixels than
// the canvas is stretched.
precision highp sampler2D;
uniform sampler2D sum;
uniform float samples;
uniform float exposure;  // factor
uniform bool tone_mapped;
uniform vec2 canvas;
layout(location = 0) out vec4 color;

vec3 shown(ivec2 at) {
    vec3 mean = texelFetch(sum, clamp(at, ivec2(0), textureSize(sum, 0) - 1), 0).rgb / samples;
    if (!tone_mapped) return mean;
    vec3 light = mean * exposure;
    return vec3(tone_curve(light.x), tone_curve(light.y), tone_curve(light.z));
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
