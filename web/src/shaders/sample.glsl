// Where a sample of the pixel goes: as octavo::render, so that n samples are its picture.
uniform bool centred;  // the pixel's middle, where only one sample is asked for
uniform int sample_number;

uint seed_of(ivec2 pixel) {
    return pixel_seed(uint(pixel.x), uint(pixel.y), 0u);
}

GridRay sample_ray(ivec2 pixel) {
    vec2 inside = centred ? vec2(0.5) : sample_2d(uint(sample_number), seed_of(pixel) ^ 0x2545f491u);
    return camera_ray(camera(), pixel, inside);
}
