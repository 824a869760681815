// The primary ray of each pixel's next sample.
uniform highp usampler2D beam;  // see beam.frag
uniform bool use_beam;
uniform highp usampler2D cache;  // see hit.glsl
uniform bool smoothed;

layout(location = 0) out uvec4 packed_hit;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    GridRay ray = sample_ray(pixel_of(at));
    if (use_beam) ray.t_min = uintBitsToFloat(texelFetch(beam, at >> 3, 0).x);
    DagView dag = dag_view();
    GridHit hit = first_seen(dag, ray, primary_stop);
    if (hit.face != kFaceNone) hit = move_to_open_face(dag, ray, hit);
    packed_hit = pack_hit(hit);
    if (smoothed && hit.face < kFaceInside && texelFetch(cache, slot_of(hit), 0).xyz != slot_key(hit))
        packed_hit.y |= kNormalMissing;
}
