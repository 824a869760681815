// SPDX-License-Identifier: MIT
//
// How many threads of a GPU's warp are at work? Counted on the CPU, from the steps that each ray
// takes: a warp of 32 threads goes on until the last of them has its answer, so its work is the
// longest ray's.
//
// usage: bench_warps FILE.octv PATH.json [TILES [FRAMES]]
//
// For tiles of 8x8 pixels, drawn at random from 1920x1080 pictures along the path, two warps each
// as in backend/passes.h: primary rays with their beams, 4 rays to a soft sun, 64 ambient rays in
// the order of their numbers and in that of square_order(), and ambient rays where each thread goes
// on with its next one as soon as so many of its warp have none (rays that are set up then for some
// threads only).
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <random>
#include <vector>

#include "camera_path.h"
#include "flight.h"
#include "octavo/io/octv.h"
#include "octavo/light/lamp.h"
#include "octavo/render/effects.h"
#include "octavo/render/settings.h"

namespace {

using namespace octavo;
namespace s = octavo::shared;

constexpr int kWarp = 32;
constexpr int kSunRays = 4;
constexpr int kSkyRays = 64;
constexpr s::Stop kToVoxels{0, 0.0f, 0.0f};

/// Of the threads of a warp, the steps of their rays, one after the other; none: no work.
using Warp = std::vector<std::vector<int>>;

struct Work {
    double rays = 0.0, steps = 0.0;  // of all threads
    double turns = 0.0;              // steps of a warp, whoever takes part
    double setups = 0.0;             // times that a warp sets up rays, for whichever threads

    /// All threads begin their next ray together.
    void in_step(const Warp& warp) {
        for (std::size_t ray = 0;; ++ray) {
            int longest = 0;
            bool any = false;
            for (const std::vector<int>& thread : warp) {
                if (ray >= thread.size()) continue;
                any = true;
                ++rays;
                steps += thread[ray];
                longest = std::max(longest, thread[ray]);
            }
            if (!any) return;
            turns += longest;
            ++setups;
        }
    }

    /// Threads without a ray begin their next one when there are `enough` of them, or all wait.
    void refilled(const Warp& warp, int enough) {
        std::vector<std::size_t> next(warp.size(), 0);
        std::vector<int> left(warp.size(), 0);
        while (true) {
            int waiting = 0;
            int working = 0;
            for (std::size_t i = 0; i < warp.size(); ++i) {
                if (left[i] > 0)
                    ++working;
                else if (next[i] < warp[i].size())
                    ++waiting;
            }
            if (waiting + working == 0) return;
            if (waiting >= enough || working == 0) {
                ++setups;
                for (std::size_t i = 0; i < warp.size(); ++i)
                    if (left[i] == 0 && next[i] < warp[i].size()) {
                        left[i] = warp[i][next[i]++];
                        ++rays;
                        steps += left[i];
                    }
            }
            bool any = false;
            for (int& steps_left : left)
                if (steps_left > 0) {
                    --steps_left;
                    any = true;
                }
            if (any) ++turns;
        }
    }

    void print(const char* what) const {
        std::printf("%-36s %10.0f %10.1f %12.0f %% %15.2f %12.3f\n", what, rays, steps / rays,
                    100.0 * steps / (kWarp * turns), turns / rays, setups / rays);
    }
};

struct Works {
    Work primary, sun, sky, sky_by_squares, sky_refilled_at_8, sky_refilled_at_16;
};

/// The steps of all rays of one warp: 8x4 pixels from `low` on.
class WarpRays {
public:
    WarpRays(const Model& model, const RenderSettings& settings)
        : dag_(s::view(model.dag)),
          settings_(settings),
          sun_(settings.lights.at(0), model.grid()) {}

    void add(const ivec2& low, float start, Works& works) const {
        Warp primary, sun, sky, squares;
        for (int i = 0; i < kWarp; ++i) {
            const ivec2 pixel = low + ivec2(i % 8, i / 8);
            s::GridRay ray = camera_ray(settings_.rays.view(), pixel, vec2(0.5f));
            ray.t_min = start;
            s::GridHit hit = trace_closest(dag_, ray, kToVoxels);
            primary.push_back({hit.steps});
            if (hit.face == s::kFaceNone) continue;
            const std::uint32_t seed = s::pixel_seed(static_cast<std::uint32_t>(pixel.x),
                                                     static_cast<std::uint32_t>(pixel.y), 0u);
            hit = move_to_open_face(dag_, ray, hit);
            const s::SurfacePoint point =
                smoothed_point(dag_, ray, hit, smooth_normal_32(dag_, ray, hit), seed);
            sun.push_back(sun_steps(point));
            std::vector<int> steps = sky_steps(point);
            const s::SquareOrder order = s::square_order(3, s::hemisphere_seed(point.seed));
            squares.emplace_back();
            for (std::uint32_t square = 0; square < kSkyRays; ++square)
                squares.back().push_back(steps[s::sample_in_square(order, 0u, square)]);
            sky.push_back(std::move(steps));
        }
        works.primary.in_step(primary);
        works.sun.in_step(sun);
        works.sky.in_step(sky);
        works.sky_by_squares.in_step(squares);
        works.sky_refilled_at_8.refilled(sky, 8);
        works.sky_refilled_at_16.refilled(sky, 16);
    }

private:
    [[nodiscard]] std::vector<int> sun_steps(const s::SurfacePoint& point) const {
        std::vector<int> steps;
        const SeenLamp seen(sun_, surface_ray(point), point.face, point.normal, false);
        for (int i = 0; i < kSunRays && !seen.dark(); ++i)
            steps.push_back(
                trace_closest(dag_, seen.ray(i, s::lamp_seed(point.seed, 0)).ray, kToVoxels).steps);
        return steps;
    }

    [[nodiscard]] std::vector<int> sky_steps(const s::SurfacePoint& point) const {
        std::vector<int> steps;
        for (int i = 0; i < kSkyRays; ++i)
            steps.push_back(
                trace_closest(dag_,
                              sky_ray(surface_ray(point), point.face, point.normal,
                                      settings_.ao_radius, i, s::hemisphere_seed(point.seed)),
                              kToVoxels)
                    .steps);
        return steps;
    }

    s::DagView dag_;
    const RenderSettings& settings_;
    Lamp sun_;
};

void count(const std::filesystem::path& file, const std::filesystem::path& path, int tiles,
           int frames) {
    const ivec2 size(1920, 1080);
    const Model model = read_octv(file);
    const cli::Flight flight(model, cli::read_camera_path(path), frames,
                             static_cast<double>(size.x) / size.y);
    std::mt19937 random(1);
    Works works;
    for (int frame = 0; frame < flight.frames(); ++frame) {
        RenderOptions options;
        options.width = size.x;
        options.height = size.y;
        options.camera = flight.camera(frame);
        options.lights = {flight.sun()};
        options.ao_radius = flight.ambient_radius();
        const RenderSettings settings = settle(model.dag, model.grid(), options);
        const WarpRays rays(model, settings);
        for (int tile = 0; tile < tiles; ++tile) {
            const ivec2 low = 8 * ivec2(random() % (size.x / 8u), random() % (size.y / 8u));
            const float start = beam_start(
                s::view(model.dag), camera_bundle(settings.rays.view(), low, low + 8), kToVoxels);
            rays.add(low, start, works);
            rays.add(low + ivec2(0, 4), start, works);
        }
    }
    std::printf("%-36s %10s %10s %14s %15s %12s\n", "rays", "number", "steps", "at work",
                "warp steps/ray", "set up/ray");
    works.primary.print("primary");
    works.sun.print("sun");
    works.sky.print("ambient, by number");
    works.sky_by_squares.print("ambient, by squares");
    works.sky_refilled_at_8.print("ambient, by number, refilled at 8");
    works.sky_refilled_at_16.print("ambient, by number, refilled at 16");
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 3) {
        std::fprintf(stderr, "usage: bench_warps FILE.octv PATH.json [TILES [FRAMES]]\n");
        return 2;
    }
    count(argv[1], argv[2], argc > 3 ? std::atoi(argv[3]) : 50, argc > 4 ? std::atoi(argv[4]) : 8);
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_warps: %s\n", error.what());
    return 1;
}
