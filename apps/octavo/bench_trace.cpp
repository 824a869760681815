// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "bench_plot.h"
#include "bench_rays.h"
#include "bench_trace.h"
#include "flight.h"
#include "help.h"
#include "machine.h"
#include "median.h"
#include "nanovdb_tracer.h"
#include "octavo/backend/device.h"
#include "octavo/core/parallel.h"
#include "octavo/io/octv.h"
#include "octavo/render/camera.h"
#include "octavo/trace/wide.h"
#include "output.h"
#include "scene_input.h"
#include "summary.h"
#include "triangle_tracer.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo bench trace scene.octv\n"
    "  octavo bench trace scene.octv --mesh scene.glb --path fly.json --plot rays.svg --json\n";

/// Rays that a task traces: with them Embree and the voxels are both far above a task's cost.
constexpr std::size_t kRaysPerTask = 4096;

constexpr double kSunRadius = 0.02;  // radians, that of RenderOptions
constexpr int kSoftSamples = 4;
constexpr int kAmbientSamples = 64;
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
    bool json = false;
};

/// Seconds that all tasks of a ray set take, on all threads of the arena.
template <class Trace>
double time_rays(std::size_t count, const Trace& trace) {
    const auto start = std::chrono::steady_clock::now();
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, (count + kRaysPerTask - 1) / kRaysPerTask, 1),
        [&](const tbb::blocked_range<std::size_t>& tasks) {
            for (std::size_t i = tasks.begin(); i != tasks.end(); ++i)
                trace(i * kRaysPerTask, std::min(kRaysPerTask, count - i * kRaysPerTask));
        });
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// What one kind of ray came to, frame by frame; MRays/s.
struct Row {
    std::string name;
    std::vector<double> one;     // the shared text, a ray at a time
    std::vector<double> voxels;  // the vector walk; with --no-wide as `one`
    std::vector<double> device;  // a device's, without beams and copies
    std::vector<double> nanovdb;
    std::vector<double> embree1;
    std::vector<double> embree16;
    std::vector<double> ratio;  // of `voxels` to the better of Embree's
    std::size_t rays = 0;
    std::size_t hits = 0;
    std::size_t agreed = 0;
    std::size_t nanovdb_agreed = 0;
};

/// Ambient rays that stop at cells which look smaller than an angle: the speed, and how much darker
/// the points come out than with rays to the voxels.
struct Cone {
    double degrees;
    std::vector<double> voxels{};  // MRays/s
    double darker = 0.0;           // sums over the points, of the open part of their sky
    double squared = 0.0;
    std::size_t points = 0;
};

/// One frame's rays, traced by everything in turn.
class Race {
public:
    /// @param triangles, nanovdb, device  also race, where they are not null
    Race(const Model& model, const TriangleTracer* triangles, const NanovdbTracer* nanovdb,
         Device* device, bool wide)
        : model_(model),
          view_(shared::view(model.dag)),
          triangles_(triangles),
          nanovdb_(nanovdb),
          device_(device),
          device_dag_(device != nullptr ? device->upload(model.dag) : nullptr),
          wide_(wide) {}

    void primary(Row& row, const RaySet& set, const PixelRays& pixels, int size) {
        std::vector<shared::GridHit> hits(set.size());
        const double one = time_rays(set.size(), [&](std::size_t first, std::size_t count) {
            for (std::size_t i = first; i < first + count; ++i)
                hits[i] = shared::trace_closest(view_, set.voxel_rays[i], {0, 0.0f, 0.0f});
        });
        double wide = one;
        if (wide_)
            wide = time_rays(set.size(), [&](std::size_t first, std::size_t count) {
                std::vector<shared::GridRay> rays(
                    set.voxel_rays.begin() + as_signed(first),
                    set.voxel_rays.begin() + as_signed(first + count));
                for (std::size_t i = 0; i < count; i += kTilePixels * kTilePixels)
                    start_at_beam(pixels, (first + i) / (kTilePixels * kTilePixels), size,
                                  std::span(rays).subspan(i, kTilePixels * kTilePixels));
                trace_closest_wide(model_.dag, rays, {0, 0.0f, 0.0f},
                                   std::span(hits).subspan(first, count));
            });
        voxel_hits_ = hits;
        count(row, set, one, wide);
        if (device_ != nullptr) {
            std::vector<shared::GridHit> found(set.size());
            count_device(
                row, set,
                device_->trace_closest(*device_dag_, set.voxel_rays, {0, 0.0f, 0.0f}, found));
        }
        race_nanovdb(row, set, [&](std::size_t i) { return hits[i].face != shared::kFaceNone; });
        for (const shared::GridHit& hit : hits) row.hits += hit.face != shared::kFaceNone;
        if (triangles_ == nullptr) return;
        triangle_hits_.resize(set.size());
        const auto embree = [&](TriangleTracer::Width width) {
            return time_rays(set.size(), [&](std::size_t first, std::size_t some) {
                triangles_->closest(std::span(set.triangle_rays).subspan(first, some), width, true,
                                    std::span(triangle_hits_).subspan(first, some));
            });
        };
        compare(row, set, wide, embree(TriangleTracer::Width::one),
                embree(TriangleTracer::Width::sixteen));
        for (std::size_t i = 0; i < set.size(); ++i) {
            const bool hit = hits[i].face != shared::kFaceNone;
            const float length = glm::length(set.voxel_rays[i].dir);
            row.agreed += hit == std::isfinite(triangle_hits_[i].t) &&
                          (!hit || std::abs(hits[i].t - triangle_hits_[i].t) * length < 4.0f);
        }
    }

    void any(Row& row, const RaySet& set, bool coherent) {
        if (set.size() == 0) return;
        std::vector<std::uint8_t> single(set.size()), wide_any(set.size()), mesh(set.size());
        const double one = time_rays(set.size(), [&](std::size_t first, std::size_t count) {
            for (std::size_t i = first; i < first + count; ++i)
                single[i] = shared::trace_any(view_, set.voxel_rays[i], {0, 0.0f, 0.0f});
        });
        double wide = one;
        if (wide_)
            wide = time_rays(set.size(), [&](std::size_t first, std::size_t count) {
                trace_any_wide(model_.dag, std::span(set.voxel_rays).subspan(first, count),
                               {0, 0.0f, 0.0f}, std::span(wide_any).subspan(first, count));
            });
        else
            wide_any = single;
        count(row, set, one, wide);
        if (device_ != nullptr) {
            std::vector<std::uint32_t> occluded(set.size());
            count_device(
                row, set,
                device_->trace_any(*device_dag_, set.voxel_rays, {0, 0.0f, 0.0f}, occluded));
        }
        race_nanovdb(row, set, [&](std::size_t i) { return wide_any[i] != 0; });
        for (const std::uint8_t hit : wide_any) row.hits += hit;
        if (triangles_ == nullptr) return;
        const auto embree = [&](TriangleTracer::Width width) {
            return time_rays(set.size(), [&](std::size_t first, std::size_t some) {
                triangles_->any(std::span(set.triangle_rays).subspan(first, some), width, coherent,
                                std::span(mesh).subspan(first, some));
            });
        };
        compare(row, set, wide, embree(TriangleTracer::Width::one),
                embree(TriangleTracer::Width::sixteen));
        for (std::size_t i = 0; i < set.size(); ++i) row.agreed += wide_any[i] == mesh[i];
    }

    /// `set`: kAmbientSamples rays for each point.
    void ambient_cone(Cone& cone, const RaySet& set) const {
        if (set.size() == 0 || !wide_) return;
        std::vector<std::uint8_t> full(set.size()), coarse(set.size());
        const auto trace = [&](float angle, std::vector<std::uint8_t>& to) {
            return time_rays(set.size(), [&](std::size_t first, std::size_t count) {
                trace_any_wide(model_.dag, std::span(set.voxel_rays).subspan(first, count),
                               {0, angle, 0.0f}, std::span(to).subspan(first, count));
            });
        };
        trace(0.0f, full);
        const double seconds =
            trace(static_cast<float>(cone.degrees * std::numbers::pi / 180.0), coarse);
        cone.voxels.push_back(1e-6 * static_cast<double>(set.size()) / seconds);
        for (std::size_t i = 0; i < set.size(); i += kAmbientSamples) {
            int more = 0;
            for (std::size_t k = i; k < i + kAmbientSamples; ++k) more += coarse[k] - full[k];
            const double darker = static_cast<double>(more) / kAmbientSamples;
            cone.darker += darker;
            cone.squared += darker * darker;
            ++cone.points;
        }
    }

    /// Where the last primary rays met the triangles, or the voxels where there are none.
    [[nodiscard]] std::vector<SurfacePoint> surface(const RaySet& primary) const {
        std::vector<SurfacePoint> points;
        for (std::size_t i = 0; i < primary.size(); ++i) {
            const shared::GridRay& ray = primary.voxel_rays[i];
            const shared::GridHit& hit = voxel_hits_[i];
            const bool mesh = triangles_ != nullptr;
            if (mesh ? !std::isfinite(triangle_hits_[i].t) : hit.face >= shared::kFaceInside)
                continue;
            const double t = mesh ? triangle_hits_[i].t : hit.t;
            dvec3 normal(0.0);
            if (mesh)
                normal = dvec3(triangle_hits_[i].normal);
            else
                normal[hit.face / 2] = 1.0;
            if (!(glm::length(normal) > 0.0)) continue;
            if (glm::dot(normal, dvec3(ray.dir)) > 0.0) normal = -normal;
            const dvec3 grid = dvec3(ray.cell) + dvec3(ray.frac) + t * dvec3(ray.dir);
            points.push_back({model_.grid().to_world(grid), glm::normalize(normal)});
        }
        return points;
    }

private:
    static std::ptrdiff_t as_signed(std::size_t i) { return static_cast<std::ptrdiff_t>(i); }

    void start_at_beam(const PixelRays& pixels, std::size_t tile, int size,
                       std::span<shared::GridRay> rays) const {
        const int columns = size / kTilePixels;
        const int x = static_cast<int>(tile) % columns * kTilePixels;
        const int y = static_cast<int>(tile) / columns * kTilePixels;
        const auto beam = pixels.bundle(x, y, x + kTilePixels, y + kTilePixels);
        if (!beam) return;
        const float start = beam_start_wide(model_.dag, *beam, {0, 0.0f, 0.0f});
        for (shared::GridRay& ray : rays) ray.t_min = start;
    }

    /// `hit(i)`: what the DAG says of ray i.
    template <class Hit>
    void race_nanovdb(Row& row, const RaySet& set, const Hit& hit) const {
        if (nanovdb_ == nullptr) return;
        std::vector<std::uint8_t> found(set.size());
        const double seconds = time_rays(set.size(), [&](std::size_t first, std::size_t some) {
            nanovdb_->trace(std::span(set.voxel_rays).subspan(first, some),
                            std::span(found).subspan(first, some));
        });
        row.nanovdb.push_back(1e-6 * static_cast<double>(set.size()) / seconds);
        for (std::size_t i = 0; i < set.size(); ++i)
            row.nanovdb_agreed += (found[i] != 0) == hit(i);
    }

    static void count(Row& row, const RaySet& set, double one, double wide) {
        const double millions = 1e-6 * static_cast<double>(set.size());
        row.one.push_back(millions / one);
        row.voxels.push_back(millions / wide);
        row.rays += set.size();
    }
    static void count_device(Row& row, const RaySet& set, double seconds) {
        row.device.push_back(1e-6 * static_cast<double>(set.size()) / seconds);
    }
    static void compare(Row& row, const RaySet& set, double wide, double embree1, double embree16) {
        const double millions = 1e-6 * static_cast<double>(set.size());
        row.embree1.push_back(millions / embree1);
        row.embree16.push_back(millions / embree16);
        row.ratio.push_back(std::min(embree1, embree16) / wide);
    }

    const Model& model_;
    shared::DagView view_;
    const TriangleTracer* triangles_;
    const NanovdbTracer* nanovdb_;
    Device* device_;
    std::unique_ptr<DeviceDag> device_dag_;
    bool wide_;
    std::vector<shared::GridHit> voxel_hits_;
    std::vector<TriangleHit> triangle_hits_;
};

struct Figures {
    std::vector<Row> rows;
    std::vector<Cone> cones;
};

Figures fly(const Model& model, Race& race, const Flight& flight, int size) {
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

std::string table(const std::vector<Row>& rows, bool device, bool mesh, bool nanovdb) {
    std::string text = fmt::format("{:12} {:>12} {:>8} {:>11} {:>11}", "MRays/s", "rays", "hit",
                                   "one by one", "voxels");
    if (device) text += fmt::format(" {:>9}", "device");
    if (mesh)
        text += fmt::format(" {:>9} {:>9} {:>8} {:>8}", "Embree 1", "Embree 16", "ratio", "agree");
    if (nanovdb) text += fmt::format(" {:>9} {:>8}", "NanoVDB", "agree");
    text += "\n";
    for (const Row& row : rows) {
        const double share = 100.0 / static_cast<double>(std::max<std::size_t>(row.rays, 1));
        text +=
            fmt::format("{:12} {:>12} {:>6.1f} % {:>11.2f} {:>11.2f}", row.name, grouped(row.rays),
                        share * static_cast<double>(row.hits), median(row.one), median(row.voxels));
        if (device) text += fmt::format(" {:>9.2f}", median(row.device));
        if (mesh)
            text += fmt::format(" {:>9.2f} {:>9.2f} {:>8.2f} {:>6.2f} %", median(row.embree1),
                                median(row.embree16), median(row.ratio),
                                share * static_cast<double>(row.agreed));
        if (nanovdb)
            text += fmt::format(" {:>9.2f} {:>6.2f} %", median(row.nanovdb),
                                share * static_cast<double>(row.nanovdb_agreed));
        text += "\n";
    }
    return text;
}

std::string cone_table(const std::vector<Cone>& cones) {
    std::string text = "\nambient rays that stop at cells below an angle\n";
    for (const Cone& cone : cones) {
        const auto n = static_cast<double>(std::max<std::size_t>(cone.points, 1));
        text += fmt::format(
            "{:>3} degrees {:>8.2f} MRays/s, darker by {:.2f} % of the sky, RMS {:.2f} %\n",
            cone.degrees, median(cone.voxels), 100.0 * cone.darker / n,
            100.0 * std::sqrt(cone.squared / n));
    }
    return text;
}

/// What was asked for, and what of it is there.
struct Setting {
    std::uint64_t dag_bytes = 0;
    std::uint32_t resolution = 0;
    std::uint64_t nanovdb_bytes = 0;  // 0: not asked for
    bool mesh = false;
    std::string device;  // its id and name; empty: none
    int frames = 0;
    int threads = 0;
};

Json json(const Figures& figures, const BenchArguments& arguments, const Setting& setting) {
    Json out = {{"bench", "trace"}};
    out.update(circumstances_json(setting.threads));
    out["file"] = arguments.file.filename().string();
    out["resolution"] = setting.resolution;
    out["dag_bytes"] = setting.dag_bytes;
    if (setting.nanovdb_bytes > 0) out["nanovdb_bytes"] = setting.nanovdb_bytes;
    if (!setting.device.empty()) out["device"] = setting.device;
    out["path"] = arguments.path.filename().string();
    out["wide"] = !arguments.no_wide;
    out["frames"] = setting.frames;
    out["size"] = arguments.size;
    for (const Row& row : figures.rows) {
        Json& r = out["mrays_per_second"][row.name];
        r["rays"] = row.rays;
        r["hits"] = row.hits;
        const auto add = [&](const char* name, const std::vector<double>& values) {
            r["median"][name] = median(values);
            r["frames"][name] = values;
        };
        add("one_by_one", row.one);
        add("voxels", row.voxels);
        if (!setting.device.empty()) add("device", row.device);
        if (setting.mesh) {
            add("embree1", row.embree1);
            add("embree16", row.embree16);
            add("voxels_per_embree", row.ratio);
            r["agreed"] = row.agreed;
        }
        if (setting.nanovdb_bytes > 0) {
            add("nanovdb", row.nanovdb);
            r["nanovdb_agreed"] = row.nanovdb_agreed;
        }
    }
    for (const Cone& cone : figures.cones) {
        const auto n = static_cast<double>(std::max<std::size_t>(cone.points, 1));
        if (cone.points == 0) continue;
        out["ambient_cones"].push_back({{"degrees", cone.degrees},
                                        {"voxels", median(cone.voxels)},
                                        {"darker", cone.darker / n},
                                        {"rms", std::sqrt(cone.squared / n)}});
    }
    return out;
}

void plot(const std::filesystem::path& file, const std::string& caption,
          const std::vector<Row>& rows, const Setting& setting) {
    std::vector<PlotPanel> panels;
    for (const Row& row : rows) {
        PlotPanel panel{row.name, {{"voxels", row.voxels}, {"one by one", row.one}}};
        if (!setting.device.empty()) panel.curves.push_back({setting.device, row.device});
        if (setting.mesh) {
            panel.curves.push_back({"Embree, packets of 16", row.embree16});
            panel.curves.push_back({"Embree, single rays", row.embree1});
        }
        if (setting.nanovdb_bytes > 0) panel.curves.push_back({"NanoVDB", row.nanovdb});
        panels.push_back(std::move(panel));
    }
    write_plot(file, caption, panels);
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
    Race race(model, triangles.get(), nanovdb.get(), device.get(), !arguments.no_wide);
    Figures figures;
    with_threads(setting.threads, [&] { figures = fly(model, race, flight, arguments.size); });

    const Json found = json(figures, arguments, setting);
    if (!arguments.plot.empty())
        plot(arguments.plot,
             fmt::format("{}, {}\u00b3, {} x {} pixels, {}, {} threads, commit {}",
                         arguments.file.stem().string(), setting.resolution, arguments.size,
                         arguments.size, found["processor"].get<std::string>(), setting.threads,
                         found["commit"].get<std::string>()),
             figures.rows, setting);
    if (arguments.json) return print(found.dump(2) + "\n");
    print(fmt::format("{} frames of {} x {}, {} threads, {}; medians of the frames\n",
                      setting.frames, arguments.size, arguments.size, setting.threads,
                      found["simd"].get<std::string>()) +
          table(figures.rows, device != nullptr, setting.mesh, nanovdb != nullptr) +
          (nanovdb ? fmt::format("\nDAG {} bytes, NanoVDB {} bytes\n", grouped(setting.dag_bytes),
                                 grouped(setting.nanovdb_bytes))
                   : "") +
          (arguments.no_wide ? "" : cone_table(figures.cones)));
}

}  // namespace

void add_bench_trace(CLI::App& bench) {
    CLI::App& trace = *bench.add_subcommand(
        "trace", "Rays a second on a flight through an .octv file, by kind of ray");
    const auto arguments = std::make_shared<BenchArguments>();
    set_help(trace, kExamples);
    trace.add_option("FILE", arguments->file, "An .octv file")->required()->type_name("");
    trace
        .add_option("--mesh", arguments->mesh,
                    "The triangles it was built from, or sample:NAME: also race Embree on them")
        ->type_name("SCENE");
    trace.add_flag("--nanovdb", arguments->nanovdb,
                   "Also race NanoVDB's HDDA on the same voxels, and compare the memory");
    trace.add_flag("--no-wide", arguments->no_wide,
                   "Trace voxels by the shared text alone, one ray at a time, without SIMD lanes");
    trace
        .add_option("--device", arguments->device,
                    "Also time the same rays on a device, see `octavo devices`: without beams, and "
                    "without copies to and from it")
        ->type_name("DEVICE");
    trace
        .add_option("--path", arguments->path,
                    "A camera path, see bench/README.md; otherwise a turn about the first camera")
        ->type_name("JSON");
    trace
        .add_option("--frames", arguments->frames,
                    "Pictures along the flight; otherwise as many as the path says, or 32")
        ->type_name("N")
        ->check(within(1, 100000));
    trace.add_option("--size", arguments->size, "Pixels along a picture's side; 1024")
        ->type_name("N")
        ->check(within(8, 16384));
    trace.add_option("--threads", arguments->threads, "Threads to use; 0: all")
        ->type_name("N")
        ->check(within(0, 4096));
    trace.add_option("--plot", arguments->plot, "Draws the speed of every frame, as SVG")
        ->type_name("FILE");
    trace.add_flag("--json", arguments->json, "As JSON, frame by frame");
    trace.callback([arguments] { run_trace(*arguments); });
}

}  // namespace octavo::cli
