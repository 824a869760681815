// What every pass knows about the camera and the scene. Include after camera_ray.h.
uniform ivec2 picture;  // pixels
uniform int depth;      // 0: nothing is loaded
uniform ivec3 eye_cell;
uniform vec3 eye_frac;
uniform vec3 view_forward;
uniform vec3 view_right;
uniform vec3 view_down;
uniform float t_before;
uniform Stop primary_stop;  // its height: that of the finest cells loaded and asked for

CameraView camera() {
    CameraView view;
    view.cell = eye_cell;
    view.frac = eye_frac;
    view.forward = view_forward;
    view.right = view_right;
    view.down = view_down;
    view.centre = 0.5 * vec2(picture);
    view.t_before = t_before;
    return view;
}

DagView dag_view() {
    DagView dag;
    dag.depth = depth;
    return dag;
}

// Targets are drawn with the last row of the picture first.
ivec2 pixel_of(ivec2 at) {
    return ivec2(at.x, picture.y - 1 - at.y);
}
