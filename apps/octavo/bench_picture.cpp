// SPDX-License-Identifier: MIT
#include "bench_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "flight.h"
#include "help.h"
#include "machine.h"
#include "median.h"
#include "octavo/backend/device.h"
#include "octavo/core/parallel.h"
#include "octavo/io/octv.h"
#include "output.h"
#include "summary.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo bench picture scene.octv --device cuda --path fly.json\n"
    "  octavo bench picture scene.octv --device vulkan --size 960x540 --frames 4 --json\n";

struct PictureArguments {
    std::filesystem::path file;
    std::string device = "auto";
    std::filesystem::path path;
    int frames = 0;  // as the path says
    uvec2 size{1920, 1080};
    int shadow_rays = 4;
    int ambient_rays = 64;
    int threads = 0;
    bool json = false;
};

/// Rays of one picture, by the pass that traces them.
struct RayCounts {
    std::uint64_t primary = 0, lamp = 0, sky = 0;
};

/// One picture of the flight: primary rays, a soft shadow of one sun, ambient occlusion; in clay.
RenderOptions options_of(const PictureArguments& arguments, const Flight& flight, int frame) {
    RenderOptions options;
    options.width = static_cast<int>(arguments.size.x);
    options.height = static_cast<int>(arguments.size.y);
    options.camera = flight.camera(frame);
    options.lights = {flight.sun()};
    options.shadow_samples = arguments.shadow_rays;
    options.ao_samples = arguments.ambient_rays;
    options.ao_radius = flight.ambient_radius();
    options.samples = 1;
    options.threads = arguments.threads;
    return options;
}

struct Figures {
    std::string device;           // its id and name
    std::vector<double> seconds;  // of each picture, copying it from the device included
    RayCounts rays;               // of all pictures
    PassTimes passes;             // of all pictures, in a run of its own; empty on the CPU
};

Figures fly(const Model& model, const PictureArguments& arguments, const Flight& flight) {
    Figures figures;
    const auto device = open_device(arguments.device);
    figures.device = device->info().id() + ", " + device->info().name;
    const auto dag = device->upload(model.dag);
    // The first one compiles what is still to be compiled.
    (void)device->render(*dag, model.grid(), options_of(arguments, flight, 0));
    for (int frame = 0; frame < flight.frames(); ++frame) {
        const RenderOptions options = options_of(arguments, flight, frame);
        const auto start = std::chrono::steady_clock::now();
        const Image image = device->render(*dag, model.grid(), options);
        figures.seconds.push_back(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        const auto points = static_cast<std::uint64_t>(
            std::ranges::count_if(image.depth, [](float depth) { return std::isfinite(depth); }));
        figures.rays.primary += image.depth.size();
        figures.rays.lamp += points * static_cast<std::uint64_t>(options.shadow_samples);
        figures.rays.sky += points * static_cast<std::uint64_t>(options.ao_samples);
    }
    return figures;
}

/// The same pictures again, pass by pass.
PassTimes time_passes(const Model& model, const PictureArguments& arguments, const Flight& flight) {
    PassTimes times;
    const auto device = open_device(arguments.device, &times);
    const auto dag = device->upload(model.dag);
    (void)device->render(*dag, model.grid(), options_of(arguments, flight, 0));
    times.clear();
    for (int frame = 0; frame < flight.frames(); ++frame)
        (void)device->render(*dag, model.grid(), options_of(arguments, flight, frame));
    return times;
}

/// Rays that a pass traced in all pictures; 0: it traces none.
std::uint64_t rays_of(const std::string& pass, const RayCounts& rays) {
    if (pass == "primary") return rays.primary;
    if (pass == "lamp") return rays.lamp;
    if (pass == "sky") return rays.sky;
    return 0;
}

/// Passes in the order of what they take.
std::vector<std::pair<std::string, double>> longest_first(const PassTimes& times) {
    std::vector<std::pair<std::string, double>> passes(times.begin(), times.end());
    std::ranges::stable_sort(passes, std::greater(), &std::pair<std::string, double>::second);
    return passes;
}

Json json(const Figures& figures, const PictureArguments& arguments, const Model& model,
          int threads) {
    Json out = {{"bench", "picture"}};
    out.update(circumstances_json(threads));
    out["file"] = arguments.file.filename().string();
    out["resolution"] = model.dag.resolution();
    out["dag_bytes"] = model.dag.size_bytes();
    out["device"] = figures.device;
    out["path"] = arguments.path.filename().string();
    out["frames"] = figures.seconds.size();
    out["size"] = {arguments.size.x, arguments.size.y};
    out["shadow_rays"] = arguments.shadow_rays;
    out["ambient_rays"] = arguments.ambient_rays;
    out["rays"] = {
        {"primary", figures.rays.primary}, {"lamp", figures.rays.lamp}, {"sky", figures.rays.sky}};
    out["seconds"] = {{"median", median(figures.seconds)}, {"frames", figures.seconds}};
    for (const auto& [pass, seconds] : longest_first(figures.passes)) {
        Json& row = out["passes"][pass];
        row["seconds"] = seconds;
        if (const std::uint64_t rays = rays_of(pass, figures.rays); rays > 0)
            row["mrays_per_second"] = 1e-6 * static_cast<double>(rays) / seconds;
    }
    return out;
}

std::string table(const Figures& figures, const PictureArguments& arguments) {
    const double frame = median(figures.seconds);
    const auto frames = static_cast<double>(figures.seconds.size());
    const RayCounts& rays = figures.rays;
    std::string text = fmt::format(
        "{}\n{} pictures of {} x {}, {} shadow and {} ambient rays for each point\n"
        "a picture in {:.2f} ms (median), {:.1f} a second; {:.1f} MRays/s in all\n",
        figures.device, figures.seconds.size(), arguments.size.x, arguments.size.y,
        arguments.shadow_rays, arguments.ambient_rays, 1e3 * frame, 1.0 / frame,
        1e-6 * static_cast<double>(rays.primary + rays.lamp + rays.sky) / (frames * frame));
    if (figures.passes.empty()) return text;
    text += fmt::format("\n{:12} {:>12} {:>10}\n", "pass", "ms/picture", "MRays/s");
    for (const auto& [pass, seconds] : longest_first(figures.passes)) {
        text += fmt::format("{:12} {:>12.3f}", pass, 1e3 * seconds / frames);
        if (const std::uint64_t count = rays_of(pass, rays); count > 0)
            text += fmt::format(" {:>10.1f}", 1e-6 * static_cast<double>(count) / seconds);
        text += "\n";
    }
    return text;
}

void run_picture(const PictureArguments& arguments) {
    std::optional<CameraPath> path;
    if (!arguments.path.empty()) path = read_camera_path(arguments.path);
    const Model model = read_octv(arguments.file);
    const Flight flight(model, path, arguments.frames,
                        static_cast<double>(arguments.size.x) / arguments.size.y);
    const int threads = arguments.threads > 0 ? arguments.threads : available_threads();
    Figures figures;
    with_threads(threads, [&] {
        figures = fly(model, arguments, flight);
        figures.passes = time_passes(model, arguments, flight);
    });
    print(arguments.json ? json(figures, arguments, model, threads).dump(2) + "\n"
                         : table(figures, arguments));
}

}  // namespace

void add_bench_picture(CLI::App& bench) {
    CLI::App& picture = *bench.add_subcommand(
        "picture", "Whole pictures a second on a device, and what each of its passes takes");
    const auto arguments = std::make_shared<PictureArguments>();
    set_help(picture, kExamples);
    picture.add_option("FILE", arguments->file, "An .octv file")->required()->type_name("");
    picture
        .add_option("--device", arguments->device,
                    "What draws: cpu, cuda, vulkan, one of `octavo devices`, or auto, the default: "
                    "a GPU where there is one")
        ->type_name("DEVICE");
    add_flight_options(picture, arguments->path, arguments->frames);
    add_parsed(picture, "--size", arguments->size, parse_size, "Pixels; 1920x1080", "WxH");
    picture
        .add_option("--shadow-samples", arguments->shadow_rays,
                    "Rays from each point to the disc of the sun, 4")
        ->type_name("N")
        ->check(within(1, 65536));
    picture
        .add_option("--ao", arguments->ambient_rays, "Ambient rays from each point, 64; 0: none")
        ->type_name("N")
        ->check(within(0, 65536));
    add_threads(picture, arguments->threads, "Threads to use on the CPU; 0: all");
    picture.add_flag("--json", arguments->json, "As JSON, picture by picture");
    picture.callback([arguments] { run_picture(*arguments); });
}

}  // namespace octavo::cli
