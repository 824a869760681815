// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "octavo/attributes/attributes.h"
#include "octavo/core/grid.h"
#include "octavo/core/progress.h"
#include "octavo/dag/dag.h"
#include "octavo/light/sky.h"
#include "octavo/mesh/scene.h"
#include "octavo/render/camera.h"
#include "octavo/render/content_bounds.h"
#include "octavo/render/image.h"
#include "octavo/trace/trace.h"

namespace octavo {

class Partitions;

enum class Shadows { none, hard, soft };

/// What an ambient radius of 0 stands for: this part of the diagonal of the voxels' bounds.
inline constexpr double kAmbientReach = 0.06;

/// Where a primary ray meets a surface; t is infinite where it meets none.
struct SurfaceHit {
    double t = std::numeric_limits<double>::infinity();  // in multiples of the ray's direction
    vec3 normal{0.0f};                                   // any length and side
};

/// Finds the first surface along some rays that are close together; world space. Called by many
/// threads at a time.
using PrimaryFunction = std::function<void(std::span<const Ray> rays, std::span<SurfaceHit> hits)>;

/// What a picture is made of. Counts of rays are per pixel, shared out evenly among its `samples`
/// and rounded up to a multiple of them; hard shadows take one for each sample.
struct RenderOptions {
    int width = 1280;
    int height = 720;
    std::optional<Camera> camera = {};  // none: frames the voxels, see default_camera()
    dvec3 up{0.0, 1.0, 0.0};            // of the sky, and of the default camera; any length

    std::optional<std::vector<Light>> lights = {};  // none: default_sun(); empty: the sky alone
    std::optional<Sky> sky = {};                    // none: the clear sky of shade.h
    Shadows shadows = Shadows::soft;                // soft by the lights' own sizes
    int shadow_samples = 16;                        // towards each light
    // The CPU asks a lamp only where a white surface would send back this much or more of it, see
    // LightGrid: cost then follows the lamps near a point. 0: every lamp everywhere, as GPUs do
    float least_light = 1.0f / 2048;

    int ao_samples = 64;     // 0: no ambient occlusion
    double ao_radius = 0.0;  // world units; 0: by kAmbientReach
    double ao_cone = 0.0;  // radians: an ambient ray may stop at cells that look smaller; 0: never

    int samples = 4;              // primary rays, jittered inside the pixel; 1: its centre
    bool smooth_normals = true;   // from the occupancy around the voxel; else the face that was hit
    bool level_of_detail = true;  // a primary ray stops at cells that look smaller than its
                                  // share of a pixel
    bool beam = true;             // 8x8-pixel beams; the picture is the same without
    bool wide = true;             // rays in SIMD lanes, and tables of walls; the same, too

    PrimaryFunction primary = {};  // none: the voxels. Else what is seen comes from here, from
                                   // the triangles say, and the voxels give shadow and ambient
                                   // occlusion alone ([K13] section 4)
    double bias = 1.0;             // with `primary`: see VisibilityOptions
    std::uint32_t frame = 0;       // another number gives other noise

    Partitions* partitions = nullptr;  // of the DAG, kept for the next picture; none: made for this

    const Attributes* attributes = nullptr;  // of the DAG's cells: colour and light; none: clay

    int threads = 0;                 // 0: all; the picture does not depend on it
    ProgressFunction progress = {};  // phase "render", in pixels
};

/// Renders a DAG: primary rays, direct light with shadow, sky light with ambient occlusion [K13].
///
/// @return        width * height pixels, see Image; an empty DAG gives the sky
/// @throws Error  bad_argument where an option is out of range or not finite; cancelled
/// Cost           (samples + lights near it * shadow_samples + ao_samples) rays for each pixel that
///                hits
[[nodiscard]] Image render(const Dag& dag, const Grid& grid, const RenderOptions& options);

}  // namespace octavo
