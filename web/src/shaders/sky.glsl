// The sky that the stored light is of. Files have no picture of one. Include before sky_radiance.h.
struct SkyPixels {
    int none;
};
vec3 sky_pixel(SkyPixels pixels, int number) {
    return vec3(0.0);
}
