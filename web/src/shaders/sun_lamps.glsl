// Lamps that are all suns, in a text that compiles in a quarter of the time of lamp_light.h and has
// its bits. Include after lamps.glsl and shadow.h.
struct LampSample {
    GridRay ray;
    float light;
};

LampSample lamp_towards(int number, GridRay start, SurfacePoint point, bool soft, int i) {
    int at = 9 * number;
    float radius = soft ? lamp_floats(at + 2).w : 0.0;
    LampPatch disc = facing_disc(-lamp_floats(at + 3).xyz, radius, 1e30);
    LampSample one;
    one.light = dot(point.normal, disc.centre);
    one.ray = start;
    if (one.light > 0.0) one.ray = lamp_ray(start, point.face, disc, i, lamp_seed(point.seed, number));
    return one;
}
