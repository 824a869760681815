// SPDX-License-Identifier: MIT
#include "octavo/render/settings.h"

#include <cmath>
#include <string>

#include "octavo/core/error.h"

namespace octavo {

void check(const RenderOptions& o) {
    const auto refuse = [](const std::string& what) { throw Error(Errc::bad_argument, what); };
    if (o.width < 1 || o.height < 1 || o.width > 65536 || o.height > 65536)
        refuse("a picture's sides are 1 to 65536 pixels");
    if (o.samples < 1 || o.samples > 65536) refuse("samples per pixel are 1 to 65536");
    if (o.ao_samples < 0 || o.ao_samples > 65536) refuse("ambient samples are 0 to 65536");
    if (o.shadow_samples < 1 || o.shadow_samples > 65536) refuse("shadow samples are 1 to 65536");
    if (!(o.ao_radius >= 0.0) || !std::isfinite(o.ao_radius))
        refuse("the ambient radius is negative or not finite");
    if (!(o.ao_cone >= 0.0) || !std::isfinite(o.ao_cone))
        refuse("the ambient cone is negative or not finite");
    if (!(o.least_light >= 0.0f) || !std::isfinite(o.least_light))
        refuse("the least light is negative or not finite");
    if (!(o.bias >= 0.0) || !std::isfinite(o.bias)) refuse("the bias is negative or not finite");
    for (const Light& light : o.lights.value_or(std::vector<Light>{}))
        if (!(light.size >= 0.0) || !std::isfinite(light.size))
            refuse("a light's size is negative or not finite");
}

Camera picture_camera(const RenderOptions& options, const Box& framed) {
    if (!options.camera)
        return default_camera(framed, options.up,
                              static_cast<double>(options.width) / options.height);
    const Camera& asked = *options.camera;
    return look_along(asked.eye, asked.forward, asked.up, asked.vertical_fov);
}

RenderSettings settle(const Dag& dag, const Grid& grid, const RenderOptions& options) {
    check(options);
    const Box content = content_bounds(dag, grid);
    const Camera camera = picture_camera(options, content.empty() ? grid.bounds() : content);
    RenderSettings settings{PixelRays(camera, grid, options.width, options.height),
                            options.lights.value_or(std::vector{default_sun(camera, options.up)}),
                            vec3(glm::normalize(options.up)),
                            0.0f,
                            shared::stop_at_voxels(),
                            shared::stop_at_voxels(),
                            camera.eye,
                            content};
    const double diagonal = content.empty() ? 1.0 : glm::length(content.size());
    const double radius = options.ao_radius > 0.0 ? options.ao_radius : kAmbientReach * diagonal;
    settings.ao_radius = static_cast<float>(radius / grid.voxel_size);
    settings.ao_stop.cone = static_cast<float>(options.ao_cone);
    // A ray stands for its share of the pixel: with four, cells of half a pixel still count.
    settings.primary_stop.cone =
        options.level_of_detail
            ? settings.rays.pixel_pitch() / std::sqrt(static_cast<float>(options.samples))
            : 0.0f;
    settings.primary_stop.time_before = settings.rays.t_before();
    return settings;
}

}  // namespace octavo
