// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "commands.h"
#include "help.h"
#include "lit_render.h"
#include "octavo/backend/device.h"
#include "octavo/io/octv.h"
#include "octavo/render/image.h"
#include "output.h"
#include "progress_meter.h"
#include "render_arguments.h"
#include "scene_input.h"
#include "sky_arguments.h"
#include "triangle_tracer.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo render scene.octv -o scene.png\n"
    "  octavo render scene.octv -o view.exr --size 1920x1080 --eye 4,2,6 --at 0,1,0 --fov 50\n"
    "  octavo render scene.octv -o evening.png --sun 250,12 --shadows soft --ao 128\n"
    "  octavo render scene.octv -o scene.png --device vulkan\n"
    "  octavo render scene.glb --primary mesh --dag scene.octv -o hybrid.png\n"
    "  octavo render lit.octv -o lit.png --gi    # after octavo light\n"
    "  octavo render scene.octv -o lamp.png --light disc:0,3,0:to=0,0,0:size=0.2 --light scene\n";

constexpr int kReferenceSamples = 256;

/// Primary rays to the triangles of a scene.
PrimaryFunction primary_of(std::shared_ptr<const TriangleTracer> triangles) {
    return
        [triangles = std::move(triangles)](std::span<const Ray> rays, std::span<SurfaceHit> hits) {
            std::vector<TriangleRay> some;
            for (const Ray& ray : rays)
                some.push_back({vec3(ray.origin), std::numeric_limits<float>::infinity(),
                                vec3(ray.direction)});
            std::vector<TriangleHit> found(rays.size());
            triangles->closest(some, TriangleTracer::Width::sixteen, true, found);
            for (std::size_t i = 0; i < rays.size(); ++i)
                hits[i] = {static_cast<double>(found[i].t), found[i].normal};
        };
}

void choose_camera(RenderArguments& arguments, const Model& model) {
    arguments.options.camera =
        chosen_camera(arguments.camera, model, arguments.options.up, arguments.aspect());
}

/// Last before the picture, so that an error has its line to itself.
void remark_on_camera(const RenderArguments& arguments, const Model& model) {
    if (arguments.quiet) return;
    const std::string remark =
        camera_remark(arguments.camera, *arguments.options.camera, model, arguments.aspect());
    if (!remark.empty()) fmt::print(stderr, "octavo: {}\n", remark);
}

/// What draws the picture; `auto` takes the CPU where no GPU can.
std::unique_ptr<Device> device_for(const RenderArguments& arguments) {
    const std::string what = only_on_cpu(arguments.options);
    if (arguments.device == "cpu" || what.empty()) return open_device(arguments.device);
    if (arguments.device == "auto") return open_device("cpu");
    throw Error(Errc::bad_argument, "--device " + arguments.device + " draws no picture with " +
                                        what + ": give --device cpu");
}

/// With the light of the cells alone, on any device.
Image render_cached(const RenderArguments& arguments, const LitInput& input) {
    const LitObject& object = input.scene.objects.front();
    RenderOptions options = arguments.options;
    options.sky = input.scene.sky;
    const auto device = device_for(arguments);
    const auto dag = device->upload(object.dag, object.attributes, object.light);
    remark_on_camera(arguments, input.models.front());
    return device->render_cached(*dag, object.grid, options);
}

/// With the light of the cells, or by paths.
void run_lit(RenderArguments& arguments) {
    if (arguments.no_color)
        throw Error(Errc::bad_argument, "--no-color: light that surfaces send on has their colour");
    LitArguments lit;
    lit.lighting = arguments.reference        ? Lighting::reference
                   : arguments.gi == "cached" ? Lighting::cached
                                              : Lighting::gathered;
    lit.choice = arguments.light;
    lit.light.bounces = arguments.bounces;
    lit.light.threads = arguments.options.threads;
    lit.quiet = arguments.quiet;
    RenderOptions& options = arguments.options;
    if (lit.lighting == Lighting::reference && !arguments.samples_given)
        options.samples = kReferenceSamples;
    ProgressMeter meter(arguments.quiet);
    lit.light.progress = options.progress = meter.function();
    const LitInput input = read_lit_input(arguments.file, lit);
    const bool one_object = arguments.file.extension() != ".json";
    if (input.camera && arguments.camera.leave_it_open())
        options.camera = *input.camera;
    else
        choose_camera(arguments, input.models.front());
    if (lit.lighting == Lighting::cached && one_object)
        return write_image(arguments.output, render_cached(arguments, input), arguments.exposure);
    if (one_object) remark_on_camera(arguments, input.models.front());
    write_image(arguments.output, render_lit(input.scene, lit.lighting, options),
                arguments.exposure);
}

void run_render(RenderArguments& arguments) {
    check_picture_name(arguments.output);
    check_output(arguments.output, arguments.force,
                 {arguments.file, arguments.dag, sky_picture(arguments.light.sky.value_or(""))});
    if (!arguments.gi.empty() && arguments.gi != "gathered" && arguments.gi != "cached")
        throw Error(Errc::bad_argument,
                    "--gi: '" + arguments.gi + "' is not cached; write --gi behind the file");
    arguments.options.width = static_cast<int>(arguments.size.x);
    arguments.options.height = static_cast<int>(arguments.size.y);
    arguments.options.smooth_normals = !arguments.flat_normals;
    arguments.options.up = arguments.light.up;
    const bool scene_file = arguments.file.extension() == ".json";
    if (!arguments.gi.empty() || arguments.reference || scene_file) {
        if (arguments.primary_mesh)
            throw Error(Errc::bad_argument, "--primary mesh goes without --gi and --reference");
        const std::string only = scene_file            ? "scene files"
                                 : arguments.reference ? "--reference"
                                                       : "--gi";
        if (arguments.device != "cpu" && arguments.device != "auto" &&
            (scene_file || arguments.gi != "cached"))
            throw Error(Errc::bad_argument,
                        "--device " + arguments.device + ": " + only + " is for the CPU" +
                            (only == "--gi" ? "; a GPU draws --gi cached" : ""));
        return run_lit(arguments);
    }
    if (arguments.primary_mesh && arguments.dag.empty())
        throw Error(Errc::bad_argument, "--primary mesh needs --dag, the .octv file of the scene");
    if (!arguments.primary_mesh && !arguments.dag.empty())
        throw Error(Errc::bad_argument, "--dag goes with --primary mesh only");
    const Model model = read_octv(arguments.primary_mesh ? arguments.dag : arguments.file,
                                  {.trusted = arguments.trusted});
    if (arguments.primary_mesh)
        arguments.options.primary =
            primary_of(std::make_shared<TriangleTracer>(read_scene(arguments.file.string())));

    RenderOptions& options = arguments.options;
    if (arguments.light.sky) options.sky = chosen_sky(arguments.light);
    if (!arguments.no_color && !model.attributes.empty()) options.attributes = &model.attributes;
    choose_camera(arguments, model);
    options.lights = asked_lights(arguments.light, model);

    ProgressMeter meter(arguments.quiet);
    options.progress = meter.function();
    const auto device = device_for(arguments);
    const auto dag = options.attributes ? device->upload(model.dag, model.attributes)
                                        : device->upload(model.dag);
    remark_on_camera(arguments, model);
    write_image(arguments.output, device->render(*dag, model.grid(), options), arguments.exposure);
}

}  // namespace

void add_render_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("render", "Ray-trace a picture of an .octv file");
    const auto arguments = std::make_shared<RenderArguments>();
    set_help(command, kExamples);
    add_render_options(command, *arguments);
    command.callback([arguments, &command] {
        arguments->samples_given = command.count("--samples") > 0;
        run_render(*arguments);
    });
}

}  // namespace octavo::cli
