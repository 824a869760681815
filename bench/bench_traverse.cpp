// SPDX-License-Identifier: MIT
//
// Question: what does one ray cost, by integer steps (the library's way) and by lists of children
// ([B18])? One thread; the two are run in turn, so that a change of the machine's clock meets both;
// median of the rounds, in ns for each ray, and cells visited for each ray.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "octavo/trace/grid_ray.h"
#include "support/children_list.h"
#include "support/small_dags.h"

namespace {

using namespace octavo;
namespace s = octavo::shared;

constexpr int kRounds = 5;

std::mt19937 random_bits(7);
double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_bits);
}
dvec3 random_direction() {
    dvec3 d;
    do d = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    while (dot(d, d) > 1 || dot(d, d) < 1e-3);
    return normalize(d);
}

struct Figures {
    double ns = 0;
    double steps = 0;
    double hits = 0;
};

template <typename Trace>
Figures one_round(const std::vector<s::GridRay>& rays, const Trace& trace) {
    const auto start = std::chrono::steady_clock::now();
    std::uint64_t hits = 0;
    std::uint64_t steps = 0;
    for (const s::GridRay& ray : rays) {
        const s::GridHit hit = trace(ray);
        hits += hit.face != s::kFaceNone;
        steps += static_cast<std::uint64_t>(hit.steps);
    }
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
    const auto n = static_cast<double>(rays.size());
    return {time.count() / n, static_cast<double>(steps) / n, static_cast<double>(hits) / n};
}

void compare(const char* scene, const char* kind, s::DagView dag,
             const std::vector<s::GridRay>& rays) {
    std::vector<double> ns[2];
    Figures last[2];
    for (int round = 0; round < kRounds; ++round) {
        last[0] = one_round(rays, [&](const s::GridRay& r) {
            return trace_closest(dag, r, {0, 0, 0});
        });
        last[1] = one_round(rays, [&](const s::GridRay& r) {
            return trace_by_lists(dag, r, {0, 0, 0});
        });
        for (int i = 0; i < 2; ++i) ns[i].push_back(last[i].ns);
    }
    for (auto& n : ns) std::nth_element(n.begin(), n.begin() + kRounds / 2, n.end());
    std::printf(
        "%-10s %-8s %8zu rays, %3.0f %% hit   steps %5.0f ns %5.1f cells   lists %5.0f ns %5.1f "
        "cells\n",
        scene, kind, rays.size(), 100 * last[0].hits, ns[0][kRounds / 2], last[0].steps,
        ns[1][kRounds / 2], last[1].steps);
}

void measure(const char* scene, const Dag& dag, const dvec3& eye01, const dvec3& target01) {
    const s::DagView v = s::view(dag);
    const double n = dag.resolution();
    const dvec3 eye = eye01 * n;
    const dvec3 forward = normalize(target01 * n - eye);
    const dvec3 right = normalize(cross(forward, dvec3(0, 1, 0)));
    const dvec3 up = cross(right, forward);
    std::vector<s::GridRay> primary;
    std::vector<s::GridRay> shadow;
    std::vector<s::GridRay> ambient;
    const vec3 sun(normalize(dvec3(0.5, 0.7, 0.3)));
    for (int y = 0; y < 270; ++y)
        for (int x = 0; x < 480; ++x) {
            const dvec3 dir =
                normalize(forward + right * ((x - 239.5) / 400) + up * ((135.5 - y) / 400));
            primary.push_back(grid_ray(eye, vec3(dir), 1e9f));
            const s::GridHit hit = trace_closest(v, primary.back(), {0, 0, 0});
            if (hit.face >= s::kFaceInside) continue;
            shadow.push_back(leave_hit(primary.back(), hit, sun));
            dvec3 normal(0);
            normal[hit.face / 2] = hit.face % 2 == 1 ? 1 : -1;
            for (int i = 0; i < 2; ++i) {
                ambient.push_back(leave_hit(primary.back(), hit,
                                            vec3(normalize(normal * 1.001 + random_direction()))));
                ambient.back().t_max = static_cast<float>(0.1 * n * uniform(0, 1));
            }
        }
    compare(scene, "primary", v, primary);
    compare(scene, "shadow", v, shadow);
    compare(scene, "ambient", v, ambient);
}

}  // namespace

int main(int argc, char** argv) {
    const int depth = argc > 1 ? std::stoi(argv[1]) : 11;
    const double n = std::exp2(depth);
    const Dag columns = test::dag_of_distance(depth, [n](const dvec3& p) {
        const dvec3 q(std::fmod(p.x, n / 4) - n / 8, p.y, std::fmod(p.z, n / 4) - n / 8);
        const double column = std::max(std::hypot(q.x, q.z) - n * 0.04, q.y - n * 0.6);
        const double floor = p.y - n * 0.05;
        const double ball = length(p - dvec3(0.5, 0.75, 0.5) * n) - n * 0.2;
        return std::min({column, floor, ball});
    });
    measure("columns", columns, {0.95, 0.4, 0.97}, {0.4, 0.3, 0.4});
    measure("dust", test::dust(depth, 0.35, 3), {1.3, 1.4, 1.6}, {0.5, 0.5, 0.5});
    measure("wall", test::slanted_wall(depth, {3, -5, 7}, static_cast<std::int64_t>(2.3 * n)),
            {0.9, 0.9, 0.05}, {0.3, 0.4, 0.6});
    measure("dust17", test::dust(17, 0.5, 3), {1.3, 1.4, 1.6}, {0.5, 0.5, 0.5});
    measure("wall17", test::slanted_wall(17, {3, -5, 7}, 300001), {0.9, 0.9, 0.05},
            {0.3, 0.4, 0.6});
}
