// SPDX-License-Identifier: MIT
//
// The light from far away, for every backend: octavo::Sky. Shared text: include after
// trace/shared_text.h. A backend includes before it
//     its own  struct SkyPixels { ...; };               of a picture, rows from the top
//     and      vec3 sky_pixel(SkyPixels pixels, int number);
#pragma once

OCTAVO_SHARED_BEGIN

const int kSkyBlack = 0;
const int kSkyConstant = 1;
const int kSkyGradient = 2;
const int kSkyImage = 3;

struct SkyView {
    SkyPixels pixels;
    int kind;
    int width;  // of the picture
    int height;
    float factor;
    vec3 zenith;
    vec3 horizon;
    vec3 ground;
    vec3 up;  // unit length, and so are the two at right angles to it
    vec3 right;
    vec3 front;
    vec3 harmonics[9];  // of diffuse_sky(), times the factor
    int padding;        // as in C++
};

// Where a direction lies in a picture: (0, 0) to (1, 1), y downwards. See octavo::SkyImage.
OCTAVO_FN vec2 sky_place(SkyView sky, vec3 direction) {
    vec3 d = normalize(direction);
    float height = clamp(dot(d, sky.up), -1.0f, 1.0f);
    vec2 way = vec2(dot(d, sky.front), dot(d, sky.right));
    // Straight up and down GLSL's atan() may answer anything.
    float angle = way.x == 0.0f && way.y == 0.0f ? 0.0f : atan(way.y, way.x);
    return vec2(clamp(0.5f + angle * 0.15915494f, 0.0f, 1.0f), acos(height) * 0.31830989f);
}

// The number of the pixel there.
OCTAVO_FN int sky_pixel_at(SkyView sky, vec2 place) {
    int x = min(int(place.x * float(sky.width)), sky.width - 1);
    int y = min(int(place.y * float(sky.height)), sky.height - 1);
    return y * sky.width + x;
}

// What a ray sees that meets nothing. direction: any length but zero.
OCTAVO_FN vec3 sky_radiance(SkyView sky, vec3 direction) {
    if (sky.kind == kSkyBlack) return vec3(0.0f);
    if (sky.kind == kSkyConstant) return sky.factor * sky.zenith;
    if (sky.kind == kSkyImage)
        return sky.factor * sky_pixel(sky.pixels, sky_pixel_at(sky, sky_place(sky, direction)));
    float height = dot(normalize(direction), sky.up);
    if (height < 0.0f) return sky.factor * mix(sky.horizon, sky.ground, min(1.0f, sqrt(-height)));
    return sky.factor * mix(sky.horizon, sky.zenith, min(1.0f, pow(height, 0.6f)));
}

// What a white surface with this unit normal sends back where nothing hides the sky: see
// octavo::Sky::diffuse().
OCTAVO_FN vec3 diffuse_sky(SkyView sky, vec3 n) {
    if (sky.kind == kSkyBlack) return vec3(0.0f);
    // Real spherical harmonics, and the cosine's own over pi: 1, 2/3, 1/4.
    vec3 sum =
        0.282095f * sky.harmonics[0] +
        0.32573533f * (n.y * sky.harmonics[1] + n.z * sky.harmonics[2] + n.x * sky.harmonics[3]) +
        0.273137f * (n.x * n.y * sky.harmonics[4] + n.y * n.z * sky.harmonics[5] +
                     n.x * n.z * sky.harmonics[7]) +
        0.078848f * (3.0f * n.z * n.z - 1.0f) * sky.harmonics[6] +
        0.1365685f * (n.x * n.x - n.y * n.y) * sky.harmonics[8];
    return max(sum, vec3(0.0f));
}

OCTAVO_SHARED_END
