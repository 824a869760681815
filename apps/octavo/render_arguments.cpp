// SPDX-License-Identifier: MIT
#include "render_arguments.h"

#include "arguments.h"
#include "degrees.h"
#include "help.h"

namespace octavo::cli {
namespace {

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

void add_output_options(CLI::App& command, RenderArguments& arguments) {
    command.add_option("-o,--output", arguments.output, "The picture to write, .png or .exr")
        ->required()
        ->type_name("FILE");
    add_parsed(command, "--size", arguments.size, parse_size, "Pixels; 1280x720", "WxH");
    command.add_option("--exposure", arguments.exposure, "Stops; each doubles the light. PNG only")
        ->type_name("STOPS")
        ->check(within(-32.0, 32.0));
    command.add_flag("--trusted", arguments.trusted, kTrustedHelp);
    add_force(command, arguments.force);
    add_quiet(command, arguments.quiet);
}

void add_light_options(CLI::App& command, RenderArguments& arguments) {
    begin_group(command, "Light");
    add_light_choice(command, arguments.light);
    add_parsed(command, "--shadows", arguments.options.shadows, parse_shadows,
               "none, hard or soft (the default)", "KIND");
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
        .add_option("--bounces", arguments.bounces,
                    "How often light is sent on, where cells are lit here; 2")
        ->type_name("N")
        ->check(within(0, LightOptions::kMostBounces));
    command
        .add_flag("--reference", arguments.reference,
                  "Trace whole paths of light instead, one for each sample, 256: slow and exact")
        ->excludes(gi);
}

void add_surface_options(CLI::App& command, RenderArguments& arguments) {
    begin_group(command, "Surfaces");
    command.add_flag("--no-color", arguments.no_color,
                     "Clay, even where the file has colours and emission");
    command.add_flag("--flat", arguments.flat_normals, "Shade the voxels' faces as they are");
    add_parsed(command, "--primary", arguments.primary_mesh, parse_primary,
               "What is seen: the voxels; or the triangles of a scene (mesh), to which the voxels "
               "of --dag give shadow and ambient occlusion",
               "voxels|mesh");
    command.add_option("--dag", arguments.dag, "With --primary mesh: the scene's .octv file")
        ->type_name("FILE");
    command
        .add_option("--bias", arguments.options.bias,
                    "With --primary mesh: how far above the triangles rays start, 1; less shows "
                    "acne, more leaves gaps")
        ->type_name("FACTOR")
        ->check(within(0.0, 1000.0));
}

void add_quality_options(CLI::App& command, RenderArguments& arguments) {
    begin_group(command, "Quality");
    RenderOptions& options = arguments.options;
    command.add_option("--samples", options.samples, "Primary rays for each pixel, 4")
        ->type_name("N")
        ->check(within(1, 65536));
    command
        .add_option("--shadow-samples", options.shadow_samples,
                    "Soft shadows: rays for each pixel and light, 16")
        ->type_name("N")
        ->check(within(1, 65536));
    command
        .add_option("--ao", options.ao_samples,
                    "Ambient occlusion: rays for each pixel, 64; 0: none")
        ->type_name("N")
        ->check(within(0, 65536));
    command
        .add_option("--ao-radius", options.ao_radius,
                    "How far it reaches, in world units; otherwise 0.06 of the scene's diagonal")
        ->type_name("R")
        ->check(zero_or_more());
    command
        .add_option_function<double>(
            "--ao-cone",
            [&options](double degrees) { options.ao_cone = degrees * kRadiansPerDegree; },
            "Ambient rays may stop at cells that look smaller than this: darker, and faster where "
            "there is much detail; 0: never")
        ->type_name("DEGREES")
        ->check(within(0.0, 90.0));
    command
        .add_option(
            "--frame", options.frame,
            "Another number gives other noise: 0, then 1 and so on for the frames of a film")
        ->type_name("N");
}

void add_speed_options(CLI::App& command, RenderArguments& arguments) {
    begin_group(command, "Device and speed");
    command
        .add_option(
            "--device", arguments.device,
            "What to render on: cpu (the default), cuda, vulkan, one of `octavo devices`, or "
            "auto: a GPU where there is one")
        ->type_name("DEVICE");
    add_threads(command, arguments.options.threads);
    command.add_flag_callback(
        "--no-wide", [&arguments] { arguments.options.wide = false; },
        "Trace the picture's rays by the shared text alone, one at a time, without SIMD lanes and "
        "tables: the same picture, slower");
}

}  // namespace

void add_render_options(CLI::App& command, RenderArguments& arguments) {
    command
        .add_option("FILE", arguments.file,
                    "An .octv file; with --primary mesh the scene that it was built from, or "
                    "sample:NAME")
        ->required()
        ->type_name("");
    add_output_options(command, arguments);
    begin_group(command, "Camera");
    add_camera_options(command, arguments.camera);
    add_light_options(command, arguments);
    add_surface_options(command, arguments);
    add_quality_options(command, arguments);
    add_speed_options(command, arguments);
}

}  // namespace octavo::cli
