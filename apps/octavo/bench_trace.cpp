// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "bench_figures.h"
#include "bench_race.h"
#include "bench_rays.h"
#include "bench_trace.h"
#include "flight.h"
#include "help.h"
#include "octavo/backend/device.h"
#include "octavo/core/parallel.h"
#include "octavo/io/octv.h"
#include "octavo/render/pixel_rays.h"
#include "output.h"
#include "scene_input.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo bench trace scene.octv\n"
    "  octavo bench trace scene.octv --mesh scene.glb --path fly.json --plot rays.svg --json\n";

constexpr double kSunRadius = 0.02;  // radians, that of RenderOptions
constexpr int kSoftSamples = 4;
constexpr int kAmbientStride = 16;  // pixels; [K13]'s 64 rays for all of them take too long

struct BenchArguments {
    std::filesystem::path file;
    std::string mesh;
    std::filesystem::path path;
    std::filesystem::path plot;
    int frames = 0;  // as the path says
    int size = 1024;
    int threads = 0;
    std::string device;  // empty: none
    bool no_wide = false;
    bool nanovdb = false;
    bool differences = false;
    bool json = false;
};

Figures fly(const Model& model, Race& race, const Flight& flight, int size, bool differences) {
    Figures figures{std::vector<Row>(4), {{1.0}, {3.0}, {9.0}}};
    std::vector<Row>& rows = figures.rows;
    rows[0].name = "primary";
    rows[1].name = "hard shadow";
    rows[2].name = "soft shadow";
    rows[3].name = "ambient";
    const dvec3 to_sun = -flight.sun().direction;
    for (int frame = 0; frame < flight.frames(); ++frame) {
        const Camera camera = flight.camera(frame);
        const RaySet primary = primary_rays(camera, model.grid(), size);
        race.primary(rows[0], primary, PixelRays(camera, model.grid(), size, size), size);
        if (differences) race.differences(primary, figures.differences);
        const std::vector<SurfacePoint> points = race.surface(primary);
        race.any(rows[1], hard_shadow_rays(points, model.grid(), to_sun), true);
        race.any(rows[2], soft_shadow_rays(points, model.grid(), to_sun, kSunRadius, kSoftSamples),
                 true);
        const RaySet ambient = ambient_rays(points, model.grid(), flight.ambient_radius(),
                                            kAmbientSamples, kAmbientStride);
        race.any(rows[3], ambient, false);
        for (Cone& cone : figures.cones) race.ambient_cone(cone, ambient);
    }
    return figures;
}

void run_trace(const BenchArguments& arguments) {
    if (arguments.size % kTilePixels != 0)
        throw Error(Errc::bad_argument, "--size: a picture's side is a multiple of 8");
    if (!arguments.plot.empty() && arguments.plot.extension() != ".svg")
        throw Error(Errc::bad_argument, arguments.plot, "a plot's name ends in .svg");
    std::optional<CameraPath> path;
    if (!arguments.path.empty()) path = read_camera_path(arguments.path);
    const Model model = read_octv(arguments.file);
    std::unique_ptr<TriangleTracer> triangles;
    if (!arguments.mesh.empty())
        triangles = std::make_unique<TriangleTracer>(read_scene(arguments.mesh));
    std::unique_ptr<NanovdbTracer> nanovdb;
    if (arguments.nanovdb) nanovdb = std::make_unique<NanovdbTracer>(model);
    std::unique_ptr<Device> device;
    if (!arguments.device.empty()) device = open_device(arguments.device);

    Setting setting;
    setting.dag_bytes = model.dag.size_bytes();
    setting.resolution = model.dag.resolution();
    setting.nanovdb_bytes = nanovdb ? nanovdb->size_bytes() : 0;
    setting.mesh = triangles != nullptr;
    if (device) setting.device = device->info().id() + ", " + device->info().name;
    const Flight flight(model, path, arguments.frames, 1.0);
    setting.frames = flight.frames();
    setting.threads = arguments.threads > 0 ? arguments.threads : available_threads();
    setting.file = arguments.file.filename().string();
    setting.path = arguments.path.filename().string();
    setting.size = arguments.size;
    setting.wide = !arguments.no_wide;
    Figures figures;
    with_threads(setting.threads, [&] {
        Race race(model, triangles.get(), nanovdb.get(), device.get(), setting.wide);
        figures = fly(model, race, flight, arguments.size, arguments.differences);
        if (setting.wide) {
            setting.partitions = race.partitions().count();
            setting.partition_bytes = race.partitions().size_bytes();
        }
    });

    const Json found = figures_json(figures, setting);
    if (!arguments.plot.empty())
        plot_figures(arguments.plot,
                     fmt::format("{}, {}\u00b3, {} x {} pixels, {}, {} threads, commit {}",
                                 arguments.file.stem().string(), setting.resolution, arguments.size,
                                 arguments.size, found["processor"].get<std::string>(),
                                 setting.threads, found["commit"].get<std::string>()),
                     figures.rows, setting);
    if (arguments.json) return print(found.dump(2) + "\n");
    print(fmt::format("{} frames of {} x {}, {} threads, {}; medians of the frames\n",
                      setting.frames, arguments.size, arguments.size, setting.threads,
                      found["simd"].get<std::string>()) +
          figures_table(figures, setting));
}

}  // namespace

void add_bench_trace(CLI::App& bench) {
    CLI::App& trace = *bench.add_subcommand(
        "trace", "Rays a second on a flight through an .octv file, by kind of ray");
    const auto arguments = std::make_shared<BenchArguments>();
    set_help(trace, kExamples);
    trace.add_option("FILE", arguments->file, "An .octv file")->required()->type_name("");
    trace.add_option("--plot", arguments->plot, "Draws the speed of every frame, as SVG")
        ->type_name("FILE");
    trace.add_flag("--json", arguments->json, "As JSON, frame by frame");

    begin_group(trace, "Flight");
    add_flight_options(trace, arguments->path, arguments->frames);
    trace.add_option("--size", arguments->size, "Pixels along a picture's side; 1024")
        ->type_name("N")
        ->check(within(8, 16384));

    begin_group(trace, "Also timed");
    CLI::Option* mesh =
        trace
            .add_option("--mesh", arguments->mesh,
                        "The triangles it was built from, or sample:NAME: also race Embree on them")
            ->type_name("SCENE");
    trace
        .add_flag("--differences", arguments->differences,
                  "Also say why primary rays meet voxels elsewhere than triangles")
        ->needs(mesh);
    trace.add_flag("--nanovdb", arguments->nanovdb,
                   "Also race NanoVDB's HDDA on the same voxels, and compare the memory");
    trace
        .add_option("--device", arguments->device,
                    "Also time the same rays on a device, see `octavo devices`: without beams, and "
                    "without copies to and from it")
        ->type_name("DEVICE");

    begin_group(trace, "Speed");
    trace.add_flag("--no-wide", arguments->no_wide,
                   "Trace voxels by the shared text alone, one ray at a time, without SIMD lanes "
                   "and tables");
    add_threads(trace, arguments->threads);
    trace.callback([arguments] { run_trace(*arguments); });
}

}  // namespace octavo::cli
