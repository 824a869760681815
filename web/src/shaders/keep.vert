// One point for each normal that has been made: it lands on its cell's slot.
uniform highp usampler2D hits;
uniform highp usampler2D normals;
uniform int first_row;

flat out uvec4 filled;

void main() {
    ivec2 size = textureSize(hits, 0);
    ivec2 at = ivec2(gl_VertexID % size.x, first_row + gl_VertexID / size.x);
    uint normal = texelFetch(normals, at, 0).x;
    GridHit hit = unpack_hit(texelFetch(hits, at, 0));
    filled = uvec4(slot_key(hit), normal);
    vec2 place = (vec2(slot_of(hit)) + 0.5) / float(kCacheSide) * 2.0 - 1.0;
    gl_Position = normal != 0u ? vec4(place, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
}
