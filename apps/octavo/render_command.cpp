// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "arguments.h"
#include "camera_arguments.h"
#include "commands.h"
#include "help.h"
#include "lit_arguments.h"
#include "lit_render.h"
#include "octavo/backend/device.h"
#include "octavo/io/octv.h"
#include "octavo/render/image.h"
#include "octavo/render/render.h"
#include "output.h"
#include "progress_meter.h"
#include "scene_input.h"
#include "triangle_tracer.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo render scene.octv -o scene.png\n"
    "  octavo render scene.octv -o view.exr --size 1920x1080 --eye 4,2,6 --at 0,1,0 --fov 50\n"
    "  octavo render scene.octv -o evening.png --sun 250,12 --shadows soft --ao 128\n"
    "  octavo render scene.octv -o scene.png --device vulkan\n"
    "  octavo render scene.glb --primary mesh --dag scene.octv -o hybrid.png\n"
    "  octavo render scene.octv -o lit.png --gi\n"
    "  octavo render scene.octv -o lamp.png --light disc:0,3,0:to=0,0,0:size=0.2 --light scene\n";

constexpr int kReferenceSamples = 256;

struct RenderArguments {
    std::filesystem::path file;
    bool trusted = false;
    std::filesystem::path output;
    RenderOptions options;
    uvec2 size{1280, 720};
    CameraArguments camera;
    bool samples_given = false;
    std::optional<std::array<double, 2>> sun;
    std::vector<std::string> lights;
    std::string gi;  // "", "gathered" or "cached"
    bool reference = false;
    std::optional<std::string> sky;
    int bounces = LightOptions{}.bounces;
    double exposure = 0.0;
    bool flat_normals = false;
    std::string device = "cpu";
    bool primary_mesh = false;
    std::filesystem::path dag;
    bool no_color = false;
    bool force = false;
    bool quiet = false;
};

Shadows parse_shadows(const std::string& text) {
    if (text == "none") return Shadows::none;
    if (text == "hard") return Shadows::hard;
    if (text == "soft") return Shadows::soft;
    throw Error(Errc::bad_argument, "'" + text + "' is not none, hard or soft");
}

bool parse_primary(const std::string& text) {
    if (text == "voxels") return false;
    if (text == "mesh") return true;
    throw Error(Errc::bad_argument, "'" + text + "' is not voxels or mesh");
}

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

void check_extension(const std::filesystem::path& file) {
    const std::string extension = file.extension().string();
    if (extension != ".png" && extension != ".exr")
        throw Error(Errc::bad_argument, file, "a picture's name ends in .png or .exr");
}

double aspect_of(const RenderArguments& arguments) {
    return static_cast<double>(arguments.size.x) / arguments.size.y;
}

void choose_camera(RenderArguments& arguments, const Model& model) {
    arguments.options.camera =
        chosen_camera(arguments.camera, model, arguments.options.up, aspect_of(arguments));
}

/// Last before the picture, so that an error has its line to itself.
void remark_on_camera(const RenderArguments& arguments, const Model& model) {
    if (arguments.quiet) return;
    const std::string remark =
        camera_remark(arguments.camera, *arguments.options.camera, model, aspect_of(arguments));
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
    lit.sun = arguments.sun;
    lit.lights = arguments.lights;
    lit.sky = arguments.sky;
    lit.light.bounces = arguments.bounces;
    lit.light.threads = arguments.options.threads;
    lit.quiet = arguments.quiet;
    RenderOptions& options = arguments.options;
    if (lit.lighting == Lighting::reference && !arguments.samples_given)
        options.samples = kReferenceSamples;
    ProgressMeter meter(arguments.quiet);
    lit.light.progress = options.progress = meter.function();
    const LitInput input = read_lit_input(arguments.file, lit, options.up);
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
    check_extension(arguments.output);
    check_output(arguments.output, arguments.force,
                 {arguments.file, arguments.dag, sky_picture(arguments.sky.value_or(""))});
    if (!arguments.gi.empty() && arguments.gi != "gathered" && arguments.gi != "cached")
        throw Error(Errc::bad_argument,
                    "--gi: '" + arguments.gi + "' is not cached; write --gi behind the file");
    arguments.options.width = static_cast<int>(arguments.size.x);
    arguments.options.height = static_cast<int>(arguments.size.y);
    arguments.options.smooth_normals = !arguments.flat_normals;
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
    if (arguments.sky) options.sky = parse_sky(*arguments.sky, options.up);
    if (!arguments.no_color && !model.attributes.empty()) options.attributes = &model.attributes;
    choose_camera(arguments, model);
    options.lights = asked_lights(arguments.sun, arguments.lights, model, options.up);

    ProgressMeter meter(arguments.quiet);
    options.progress = meter.function();
    const auto device = device_for(arguments);
    const auto dag = options.attributes ? device->upload(model.dag, model.attributes)
                                        : device->upload(model.dag);
    remark_on_camera(arguments, model);
    write_image(arguments.output, device->render(*dag, model.grid(), options), arguments.exposure);
}

void add_light_options(CLI::App& command, RenderArguments& arguments) {
    add_light_choice(command, arguments.sun, arguments.lights);
    command
        .add_option("--shadow-samples", arguments.options.shadow_samples,
                    "Soft shadows: rays for each pixel and light, 16")
        ->type_name("N")
        ->check(within(1, 65536));
    add_parsed(command, "--shadows", arguments.options.shadows, parse_shadows,
               "none, hard or soft (the default)", "KIND");
    command
        .add_option("--ao", arguments.options.ao_samples,
                    "Ambient occlusion: rays for each pixel, 64; 0: none")
        ->type_name("N")
        ->check(within(0, 65536));
    command
        .add_option("--ao-radius", arguments.options.ao_radius,
                    "How far it reaches, in world units; otherwise 0.06 of the scene's diagonal")
        ->type_name("R")
        ->check(zero_or_more());
    command
        .add_option_function<double>(
            "--ao-cone",
            [&arguments](double degrees) {
                arguments.options.ao_cone = degrees * kRadiansPerDegree;
            },
            "Ambient rays may stop at cells that look smaller than this: darker, and faster where "
            "there is much detail; 0: never")
        ->type_name("DEGREES")
        ->check(within(0.0, 90.0));
    command
        .add_option("--sky", arguments.sky,
                    "clear (the default), none, color:R,G,B, "
                    "gradient:zenith=R,G,B:horizon=R,G,B:ground=R,G,B, or an .exr or .hdr picture; "
                    "with :power=FACTOR, a picture also with :turn=DEGREES")
        ->type_name("SKY");
    CLI::Option* gi =
        command
            .add_option("--gi", arguments.gi,
                        "Light that surfaces send on, by --ao rays for each pixel; with `cached`, "
                        "only what `octavo light` stored. Uses the lights and the sky of that, "
                        "unless others are given: then cells are lit first")
            ->type_name("[cached]")
            ->expected(0, 1)
            ->default_str("gathered");
    command
        .add_flag("--reference", arguments.reference,
                  "Trace whole paths of light instead, one for each sample, 256: slow and exact")
        ->excludes(gi);
    command
        .add_option(
            "--frame", arguments.options.frame,
            "Another number gives other noise: 0, then 1 and so on for the frames of a film")
        ->type_name("N");
    command
        .add_option("--bounces", arguments.bounces,
                    "How often light is sent on, where cells are lit here; 2")
        ->type_name("N")
        ->check(within(0, LightOptions::kMostBounces));
    command.add_option("--exposure", arguments.exposure, "Stops; each doubles the light. PNG only")
        ->type_name("STOPS")
        ->check(within(-32.0, 32.0));
}

}  // namespace

void add_render_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("render", "Ray-trace a picture of an .octv file");
    const auto arguments = std::make_shared<RenderArguments>();
    set_help(command, kExamples);
    command
        .add_option("FILE", arguments->file,
                    "An .octv file; with --primary mesh the scene that it was built from, or "
                    "sample:NAME")
        ->required()
        ->type_name("");
    command.add_flag("--trusted", arguments->trusted, kTrustedHelp);
    command.add_option("-o,--output", arguments->output, "The picture to write, .png or .exr")
        ->required()
        ->type_name("FILE");
    add_parsed(command, "--size", arguments->size, parse_size, "Pixels; 1280x720", "WxH");
    add_camera_options(command, arguments->camera);
    add_parsed(command, "--up", arguments->options.up, parse_vec3, "Which way is up; 0,1,0",
               "X,Y,Z");
    add_light_options(command, *arguments);
    command.add_option("--samples", arguments->options.samples, "Primary rays for each pixel, 4")
        ->type_name("N")
        ->check(within(1, 65536));
    add_parsed(command, "--primary", arguments->primary_mesh, parse_primary,
               "What is seen: the voxels; or the triangles of a scene (mesh), to which the voxels "
               "of --dag give shadow and ambient occlusion",
               "voxels|mesh");
    command.add_option("--dag", arguments->dag, "With --primary mesh: the scene's .octv file")
        ->type_name("FILE");
    command
        .add_option("--bias", arguments->options.bias,
                    "With --primary mesh: how far above the triangles rays start, 1; less shows "
                    "acne, more leaves gaps")
        ->type_name("FACTOR")
        ->check(within(0.0, 1000.0));
    command.add_flag("--no-color", arguments->no_color,
                     "Clay, even where the file has colours and emission");
    command.add_flag("--flat", arguments->flat_normals, "Shade the voxels' faces as they are");
    command
        .add_option(
            "--device", arguments->device,
            "What to render on: cpu (the default), cuda, vulkan, one of `octavo devices`, or "
            "auto: a GPU where there is one")
        ->type_name("DEVICE");
    command.add_flag_callback(
        "--no-wide", [arguments] { arguments->options.wide = false; },
        "Trace the picture's rays by the shared text alone, one at a time, without SIMD lanes and "
        "tables: the same picture, slower");
    command.add_option("--threads", arguments->options.threads, "Threads to use; 0: all")
        ->type_name("N")
        ->check(within(0, 4096));
    command.add_flag("-f,--force", arguments->force, "Replace the file where it exists");
    command.add_flag("-q,--quiet", arguments->quiet, "Print errors only");
    command.callback([arguments, &command] {
        arguments->samples_given = command.count("--samples") > 0;
        run_render(*arguments);
    });
}

}  // namespace octavo::cli
