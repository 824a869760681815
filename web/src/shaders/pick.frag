// The first cell behind one pixel.
uniform ivec2 picked;  // pixel

layout(location = 0) out uvec4 cell;  // path; face and height
layout(location = 1) out uvec4 way;   // time, as bits
layout(location = 2) out uvec4 albedo;    // linear, as bits; alpha 1: the cell has a colour
layout(location = 3) out uvec4 emission;  // as bits

void main() {
    GridRay ray = camera_ray(camera(), picked, vec2(0.5));
    GridHit hit = first_seen(dag_view(), ray, primary_stop);
    CellLook look;
    look.albedo = vec3(-1.0);
    look.emission = vec3(0.0);
    if (hit.face != kFaceNone && cell_level != 0) {
        DagView dag = dag_view();
        look = cell_look(dag, cell_looks(), hit.path, dag.depth - hit.height, -ray.dir);
    }
    albedo = uvec4(floatBitsToUint(look.albedo), look.albedo.x < 0.0 ? 0u : 1u);
    emission = uvec4(floatBitsToUint(look.emission), 0u);
    cell = uvec4(hit.path, uint(hit.face) | uint(hit.height) << 8);
    way = uvec4(floatBitsToUint(hit.t), uint(hit.steps), 0u, 0u);
}
