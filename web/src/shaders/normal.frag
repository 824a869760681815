// The smoothed normals of cells that have none yet. Of neighbours that see the same cell one does
// the work.
uniform highp usampler2D hits;
uniform int depth;
uniform int first_row;
uniform int turn;  // 0 to turns - 1: a share of the pixels each time, so that no frame takes long
uniform int turns;

layout(location = 0) out uint packed_normal;  // 0: none was made

bool same_cell(uvec4 a, ivec2 at) {
    uvec4 b = texelFetch(hits, at, 0);
    return a.x == b.x && a.y == b.y && ((a.z ^ b.z) << 15) == 0u;
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    uvec4 cell = texelFetch(hits, at, 0);
    packed_normal = 0u;
    if ((cell.y & kNormalMissing) == 0u) return;
    if ((at.x * 7 + at.y * 3) % turns != turn) return;
    if (turns == 1 && ((at.x > 0 && same_cell(cell, at - ivec2(1, 0))) ||
                       (at.y > first_row && same_cell(cell, at - ivec2(0, 1)))))
        return;
    GridRay unused_ray;
    unused_ray.cell = ivec3(0);
    unused_ray.frac = vec3(0.0);
    unused_ray.dir = vec3(1.0);
    unused_ray.t_min = 0.0;
    unused_ray.t_max = 0.0;
    DagView dag;
    dag.depth = depth;
    packed_normal = pack_normal(smooth_normal_32(dag, unused_ray, unpack_hit(cell))) | 1u;
}
