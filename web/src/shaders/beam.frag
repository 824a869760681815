// One pixel for a block of 8x8 of the picture: the time before which none of its rays meets anything.
layout(location = 0) out uvec4 start;

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    ivec2 low = ivec2(8 * block.x, max(0, picture.y - 8 * (block.y + 1)));
    ivec2 end = ivec2(min(low.x + 8, picture.x), picture.y - 8 * block.y);
    start = uvec4(floatBitsToUint(beam_start(dag_view(), camera_bundle(camera(), low, end), primary_stop)));
}
