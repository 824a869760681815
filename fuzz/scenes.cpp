// SPDX-License-Identifier: MIT
// Scene files, camera paths, lights and skies: what is taken can be drawn.
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>

#include "../apps/octavo/camera_path.h"
#include "../apps/octavo/light_arguments.h"
#include "../apps/octavo/scene_file.h"
#include "../apps/octavo/sky_arguments.h"
#include "folder.h"
#include "octavo/render/render_lit.h"
#include "promise.h"

namespace octavo::fuzz {
namespace {

namespace fs = std::filesystem;

void draw(const LitScene& scene, const std::optional<Camera>& camera) {
    RenderOptions options;
    options.width = options.height = 4;
    options.shadow_samples = options.ao_samples = options.samples = 1;
    options.threads = 1;
    options.camera = camera;
    try {
        (void)render_lit(scene, Lighting::gathered, options);
    } catch (const Error& error) {
        require(error.code() == Errc::bad_argument || error.code() == Errc::limit,
                "a scene is drawn or refused");
    }
}

}  // namespace

void run_scene(Bytes bytes) {
    static const bool kModelsAreThere = [] {
        put("a.octv", full_octv(4, 2));
        put("b.octv", random_octv(3, true));
        return true;
    }();
    require(kModelsAreThere, "models for the test itself");
    const fs::path file = put("scene.json", bytes);
    cli::SceneFile scene;
    try {
        scene = cli::read_scene_file(file, dvec3(0.0, 1.0, 0.0));
    } catch (const Error& error) {
        require(error.code() != Errc::bad_argument, "a bad scene file is bad input");
        require_one_line(error);
        return;
    }
    require(!scene.scene.objects.empty() && scene.scene.objects.size() == scene.models.size(),
            "every object has a model");
    if (scene.scene.objects.size() > 50) return;  // drawn in proportion
    if (scene.lights) scene.scene.lights = *scene.lights;
    draw(scene.scene, scene.camera);
}

void run_path(Bytes bytes) {
    const fs::path file = put("path.json", bytes);
    try {
        const cli::CameraPath path = cli::read_camera_path(file);
        require(path.frames >= 1 && path.frames <= 100000, "frames are in range");
        for (int frame = 0; frame < path.frames; frame += 1 + path.frames / 16) {
            const Camera camera = path.camera(frame, path.frames);
            require(finite(camera.eye) && finite(camera.forward) && finite(camera.up),
                    "cameras of a path are finite");
        }
    } catch (const Error& error) {
        require(error.code() == Errc::bad_input, "a bad path is bad input");
        require_one_line(error);
    }
}

void run_lights(Bytes bytes) {
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const dvec3 up(0.0, 1.0, 0.0);
    const Box lit{dvec3(-1.0), dvec3(2.0)};
    try {
        const cli::LightArgument light = cli::parse_light(text, up);
        require(std::isfinite(light.power) && light.power >= 0.0, "power is a number");
        require(finite(light.light.position) && finite(light.light.direction) &&
                    finite(light.light.half_u) && finite(light.light.half_v) &&
                    finite(dvec3(light.light.intensity)) && light.light.size >= 0.0,
                "a light is finite");
        LitScene scene;
        scene.objects.push_back({.dag = Dag(2, {0, 2}, {1u, 0x8000u}), .grid = {{}, 0.5, 2}});
        scene.lights = cli::chosen_lights({light}, {}, lit);
        draw(scene, std::nullopt);
    } catch (const Error& error) {
        require(error.code() == Errc::bad_argument, "a bad light is a bad argument");
    }
    // Names of pictures would be opened: sky_image is for what is in them.
    if (text.find(".exr") != std::string::npos || text.find(".hdr") != std::string::npos) return;
    try {
        const Sky sky = cli::parse_sky(text, up);
        const vec3 light = sky.radiance(vec3(0.0f, 0.6f, 0.8f));
        require(!(light.x < 0.0f) && !std::isnan(light.x), "a sky's light is a number");
    } catch (const Error& error) {
        require(error.code() == Errc::bad_argument, "a bad sky is a bad argument");
    }
}

void run_sky_image(Bytes bytes) {
    const bool exr = bytes.size() >= 4 && std::memcmp(bytes.data(), "\x76\x2f\x31\x01", 4) == 0;
    const fs::path file = put(exr ? "a.exr" : "a.hdr", bytes);
    try {
        const SkyImage image = load_sky_image(file);
        require(image.color.size() ==
                    static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
                "a picture has its pixels");
        if (image.color.size() > 4096) return;
        const Sky sky = Sky::image(image, dvec3(0.0, 1.0, 0.0), 0.3);
        require(!std::isnan(sky.radiance(vec3(0.0f, 0.6f, 0.8f)).x), "a sky's light is a number");
    } catch (const Error& error) {
        require(error.code() == Errc::bad_input || error.code() == Errc::unsupported ||
                    error.code() == Errc::limit,
                "a bad picture is bad input");
    }
}

}  // namespace octavo::fuzz
