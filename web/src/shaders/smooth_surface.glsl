// The surface that a hit shows: smoothed where its normal is in the cache, else its face. Include
// after surface.h and hit.glsl.
uniform highp usampler2D cache;  // see hit.glsl
uniform bool smoothed;

SurfacePoint surface_point(DagView dag, GridRay ray, GridHit hit, uint seed) {
    if (smoothed && hit.face < kFaceInside) {
        uvec4 slot = texelFetch(cache, slot_of(hit), 0);
        if (slot.xyz == slot_key(hit)) return smoothed_point(dag, ray, hit, unpack_normal(slot.w), seed);
    }
    return flat_point(ray, hit, seed);
}
