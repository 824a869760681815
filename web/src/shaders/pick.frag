// The first cell behind one pixel.
uniform ivec2 picked;  // pixel

layout(location = 0) out uvec4 cell;  // path; face and height
layout(location = 1) out uvec4 way;   // time, as bits

void main() {
    GridRay ray = camera_ray(camera(), picked, vec2(0.5));
    GridHit hit = trace_closest(dag_view(), ray, primary_stop);
    cell = uvec4(hit.path, uint(hit.face) | uint(hit.height) << 8);
    way = uvec4(floatBitsToUint(hit.t), uint(hit.steps), 0u, 0u);
}
