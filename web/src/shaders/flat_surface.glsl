// The surface that a hit shows: its face. Include after surface.h and hit.glsl.
SurfacePoint surface_point(DagView dag, GridRay ray, GridHit hit, uint seed) {
    return flat_point(ray, hit, seed);
}
