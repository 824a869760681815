// A lamp of any kind out of the texture, as octavo::Lamp places it. Include after lamp_light.h.
PlacedLamp placed_lamp(int number) {
    int at = 9 * number;
    uvec4 head = lamp_texel(at);
    PlacedLamp lamp;
    lamp.kind = int(head.x);
    lamp.shape = int(head.y);
    lamp.triangle_count = int(head.z);
    lamp.triangles.begin = int(head.w);
    lamp.cell = ivec3(lamp_texel(at + 1).xyz);
    lamp.frac = lamp_floats(at + 2).xyz;
    lamp.radius = lamp_floats(at + 2).w;
    lamp.direction = lamp_floats(at + 3).xyz;
    lamp.area = lamp_floats(at + 3).w;
    lamp.u = lamp_floats(at + 4).xyz;
    lamp.voxel_size = lamp_floats(at + 4).w;
    lamp.v = lamp_floats(at + 5).xyz;
    lamp.cos_inner = lamp_floats(at + 5).w;
    lamp.low = lamp_floats(at + 6).xyz;
    lamp.cos_outer = lamp_floats(at + 6).w;
    lamp.high = lamp_floats(at + 7).xyz;
    if (lamp.kind == kPatchLamp && lamp.shape == kDiscShape) {
        LampPatch disc = facing_disc(-lamp.direction, lamp.radius, 1.0);
        lamp.u = disc.u;
        lamp.v = disc.v;
    }
    return lamp;
}

LampSample lamp_towards(int number, GridRay start, SurfacePoint point, bool soft, int i) {
    PlacedLamp lamp = placed_lamp(number);
    SeenPlacedLamp seen = see_lamp(lamp, start, point.face, point.normal, soft ? 0 : 1);
    LampSample none;
    none.ray = start;
    none.light = 0.0;
    if (seen.dark != 0) return none;
    return lamp_sample(lamp, seen, i, lamp_seed(point.seed, number));
}
