// A primary hit as four words: what the later passes of a sample read. Include after traverse.h.
uvec4 pack_hit(GridHit hit) {
    return uvec4(hit.path.x | uint(hit.face) << 17 | uint(hit.height) << 20, hit.path.y,
                 hit.path.z | uint(min(hit.steps, 16383)) << 17, floatBitsToUint(hit.t));
}

GridHit unpack_hit(uvec4 words) {
    const uint path_bits = (1u << 17) - 1u;
    GridHit hit;
    hit.path = words.xyz & path_bits;
    hit.face = int(words.x >> 17 & 7u);
    hit.height = int(words.x >> 20);
    hit.steps = int(words.z >> 17);
    hit.t = uintBitsToFloat(words.w);
    return hit;
}

// Smoothed normals of cells, each in a place of its number; what is there belongs to the last cell
// that was put there. A slot has the cell's and face's number, a bit that says so, and the normal.
const int kCacheSide = 1024;
const uint kSlotFilled = 1u << 31;
const uint kNormalMissing = 1u << 31;  // in the second word of a hit

ivec2 slot_of(GridHit hit) {
    uint number = mix_bits(hit.path.x + mix_bits(hit.path.y + mix_bits(hit.path.z + mix_bits(uint(hit.face + 8 * hit.height)))));
    return ivec2(number & 1023u, number >> 10 & 1023u);
}

uvec3 slot_key(GridHit hit) {
    return uvec3(hit.path.x | uint(hit.face) << 17 | uint(hit.height) << 20, hit.path.y | kSlotFilled, hit.path.z);
}

// A unit vector in a word: the octahedron's faces unfolded to a square.
uint pack_normal(vec3 n) {
    n /= abs(n.x) + abs(n.y) + abs(n.z);
    vec2 way = vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
    vec2 at = n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * way;
    return packSnorm2x16(at);
}

vec3 unpack_normal(uint word) {
    vec2 at = unpackSnorm2x16(word);
    vec3 n = vec3(at, 1.0 - abs(at.x) - abs(at.y));
    vec2 way = vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
    if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * way;
    return normalize(n);
}
