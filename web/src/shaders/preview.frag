// A whole picture at once, of few pixels: what is seen until the programs that shade are compiled.
// One ray, clay, the sky's light and the first lamp's, where that is a sun, without shadows.
uniform vec3 up;
uniform vec3 sun;        // towards it, unit length
uniform vec3 sun_light;  // its intensity

layout(location = 0) out vec4 sum;  // alpha: rays

void main() {
    GridRay ray = camera_ray(camera(), pixel_of(ivec2(gl_FragCoord.xy)), vec2(0.5));
    GridHit hit = first_seen(dag_view(), ray, primary_stop);
    vec3 seen = sky_color(ray.dir, up);
    if (hit.face != kFaceNone) {
        vec3 normal = face_normal(ray, hit);
        seen = clay() * (sky_light(normal, up) + 0.31830989 * max(0.0, dot(normal, sun)) * sun_light);
    }
    sum = vec4(seen, 1.0);
}
