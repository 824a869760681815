// The lamps of this backend: records in the texels of a texture, see view/lamps.ts. Include after
// lamp_triangle.h and before lamp_light.h.
uniform highp usampler2D lamp_texels;
uniform int lamp_count;

uvec4 lamp_texel(int number) {
    return texelFetch(lamp_texels, ivec2(number & 255, number >> 8), 0);
}
vec4 lamp_floats(int number) {
    return uintBitsToFloat(lamp_texel(number));
}

vec3 lamp_intensity(int number) {
    return lamp_floats(9 * number + 8).xyz;
}

struct LampTriangles {
    int begin;  // texel
};
LampTriangle lamp_triangle(LampTriangles triangles, int number) {
    int at = triangles.begin + 6 * number;
    vec4 place = lamp_floats(at + 1);
    LampTriangle triangle;
    triangle.cell = ivec3(lamp_texel(at).xyz);
    triangle.squared = lamp_floats(at).w;
    triangle.frac = place.xyz;
    triangle.area_so_far = place.w;
    triangle.u = lamp_floats(at + 2).xyz;
    triangle.v = lamp_floats(at + 3).xyz;
    triangle.normal = lamp_floats(at + 4).xyz;
    triangle.middle = lamp_floats(at + 5).xyz;
    return triangle;
}
