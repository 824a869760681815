// SPDX-License-Identifier: MIT
//
// What does light cost when something changes? usage: bench_light FILE.octv [RAYS [BOUNCES]]
//
// Lights the cells by a sun, the clear sky and a hundred weak point lamps, then moves the sun, then
// one lamp, then a small ball in the middle. Then by 1 to 500 lamps alone, without bounces. Prints
// sides of cells, rays, seconds by the clock and those of the processor, of all threads together.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <random>
#include <string>

#include "octavo/attributes/build_attributes.h"
#include "octavo/construct/build.h"
#include "octavo/io/octv.h"
#include "octavo/light/light_cells.h"
#include "octavo/mesh/samples.h"
#include "octavo/render/render.h"

namespace {

using namespace octavo;

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

template <class Work>
void measure(const char* what, const Work& work) {
    const auto began = std::chrono::steady_clock::now();
    const double start = processor_seconds();
    const LightReport report = work();
    const double seconds = processor_seconds() - start;
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - began;
    std::printf(
        "%-16s sides %10llu  done %10llu  rays %11llu  %6.2f s  processor %6.2f s  %6.2f "
        "Mrays/s  %6.2f and core\n",
        what, static_cast<unsigned long long>(report.sides),
        static_cast<unsigned long long>(report.sides_done),
        static_cast<unsigned long long>(report.rays), wall.count(), seconds,
        static_cast<double>(report.rays) / wall.count() / 1e6,
        static_cast<double>(report.rays) / seconds / 1e6);
}

/// A hairy ball of 64^3 voxels, to be moved about.
LitObject ball() {
    const Scene triangles = make_sample("hairball", 0.01);
    BuildOptions options;
    options.depth = 6;
    const BuildResult built = build(triangles, options);
    return {.name = "ball",
            .dag = built.dag,
            .grid = built.grid,
            .attributes = build_attributes(triangles, built.dag, built.grid, {})};
}

/// Somewhere in the box, a twentieth of its diagonal wide.
dmat4 place_in(const Box& box, const dvec3& part) {
    const double scale = 0.025 * glm::length(box.size());
    dmat4 place(scale);
    place[3] = dvec4(box.low + part * box.size(), 1.0);
    return place;
}

/// A weak point lamp somewhere in the box, which reaches a thirtieth of its diagonal.
Light lamp_in(const Box& box, int number) {
    std::mt19937 random(static_cast<unsigned>(number));
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Light lamp;
    lamp.kind = Light::Kind::point;
    const double x = unit(random), y = unit(random), z = unit(random);
    lamp.position = box.low + box.size() * dvec3(x, y, z);
    const double reach = 0.03 * glm::length(box.size());
    lamp.intensity = vec3(static_cast<float>(reach * reach / 650.0));
    return lamp;
}

/// How the cost grows with the number of lamps: direct light, with the least of rays around.
void measure_lamps(const Model& model, const Box& box) {
    for (const int count : {0, 1, 10, 100, 500}) {
        LitScene scene;
        scene.objects.push_back(
            {.dag = model.dag, .grid = model.grid(), .attributes = model.attributes});
        for (int i = 0; i < count; ++i) scene.lights.push_back(lamp_in(box, i));
        LightOptions options;
        options.bounces = 0;
        options.around_rays = 1;
        CellLighter lighter(scene, options);
        measure((std::to_string(count) + " lamps").c_str(), [&] { return lighter.light_all(); });
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_light FILE.octv [RAYS [BOUNCES]]\n");
        return 2;
    }
    try {
        const Model model = read_octv(argv[1]);
        LitScene scene;
        scene.objects.push_back(
            {.dag = model.dag, .grid = model.grid(), .attributes = model.attributes});
        scene.sky = Sky::clear({0, 1, 0});
        scene.lights.push_back(sun_at(1.5, 1.15));
        const Box box = content_bounds(model.dag, model.grid());
        for (int i = 0; i < 100; ++i) scene.lights.push_back(lamp_in(box, i));
        scene.objects.push_back(ball());
        scene.objects.back().placement = place_in(box, {0.5, 0.3, 0.5});
        LightOptions options;
        if (argc > 2) options.around_rays = std::atoi(argv[2]);
        if (argc > 3) options.bounces = std::atoi(argv[3]);
        CellLighter lighter(scene, options);
        measure("all", [&] { return lighter.light_all(); });
        Light lamp = scene.lights[50];
        lamp.position.y += 0.01 * box.size().y;
        measure("one lamp moves", [&] { return lighter.change_light(50, lamp); });
        measure("the sun moves", [&] { return lighter.change_light(0, sun_at(1.4, 1.15)); });
        measure("the ball moves", [&] {
            return lighter.move_object(1, place_in(box, {0.52, 0.3, 0.5}));
        });
        std::printf("kept beside: %.1f MB\n", static_cast<double>(lighter.size_bytes()) / 1e6);
        measure_lamps(model, box);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_light: %s\n", error.what());
        return 3;
    }
    return 0;
}
