// SPDX-License-Identifier: MIT
// What the reader accepts must bear everything that one can do with it.
#include <algorithm>
#include <array>
#include <filesystem>
#include <string>

#include "folder.h"
#include "octavo/io/octv.h"
#include "octavo/io/validate.h"
#include "octavo/light/light_cells.h"
#include "octavo/render/render.h"
#include "octavo/render/render_lit.h"
#include "octavo/trace/dag_view.h"
#include "octavo/trace/trace.h"
#include "promise.h"

namespace octavo::fuzz {
namespace {

/// A ray crosses at most 3 N planes and goes down, and up again, at most the depth for each.
void trace_with_bound(const Dag& dag, const dvec3& origin, const dvec3& direction) {
    const dvec3 cell = glm::floor(origin);
    const shared::GridRay ray{.cell = ivec3(cell),
                              .frac = vec3(origin - cell),
                              .dir = vec3(direction),
                              .t_min = 0.0f,
                              .t_max = 1e30f};
    const shared::GridHit hit = shared::trace_closest(shared::view(dag), ray, {0, 0.0f, 0.0f});
    const auto bound = (3.0 * dag.resolution() + 1.0) * (2.0 * dag.depth());
    require(hit.steps <= bound, "a ray takes at most 6 N depth steps");
    if (hit.face != shared::kFaceNone)
        require(dag.voxel(hit.path), "what a ray hits is a voxel of the DAG");
}

void trace_some(const Model& model) {
    const Dag& dag = model.dag;
    const double n = dag.resolution();
    for (const dvec3& from : {dvec3(-1.0), dvec3(n + 1.0, 0.3 * n, -2.0), dvec3(0.5 * n)}) {
        for (const dvec3& to : {dvec3(0.5 * n), dvec3(n, 0.0, n), dvec3(0.1, 0.9, 0.4) * n}) {
            const dvec3 direction = to - from;
            if (glm::length(direction) == 0.0) continue;
            trace_with_bound(dag, from, glm::normalize(direction));
            const Hit hit = trace_closest(dag, {.origin = from, .direction = direction});
            require(
                static_cast<bool>(hit) == trace_any(dag, {.origin = from, .direction = direction}),
                "any hit and closest hit agree");
            if (hit)
                (void)leave_hit(dag, {.origin = from, .direction = direction}, hit, -direction);
        }
    }
}

void render_small(const Model& model) {
    const Box box = content_bounds(model.dag, model.grid());
    require(box.empty() == model.dag.empty(), "bounds are empty where there are no voxels");
    RenderOptions options;
    options.width = options.height = 8;
    options.shadow_samples = 1;
    options.ao_samples = 1;
    options.samples = 1;
    options.threads = 1;
    try {
        (void)render(model.dag, model.grid(), options);
        if (model.metadata.cameras.empty()) return;
        options.camera = model.metadata.cameras.front();
        options.lights = model.metadata.lights;
        (void)render(model.dag, model.grid(), options);
    } catch (const Error& error) {
        // A camera of the file may be one that no picture can be taken with.
        require(error.code() == Errc::bad_argument || error.code() == Errc::limit,
                "rendering fails for arguments only");
    }
}

/// Every way of asking for the looks of cells: of all of them where they are few.
void look_up_attributes(const Model& model) {
    const Attributes& attributes = model.attributes;
    const std::uint64_t count = attributes.cells().count();
    const vec3 towards(0.3f, -1.0f, 0.2f);
    for (std::uint64_t i = 0; i < count; i += 1 + i / 300) {
        for (const vec3& from : {vec3(0.0f), towards, -towards}) {
            (void)attributes.color(i, from);
            require(finite(dvec3(attributes.emission(i, from))), "emission is finite");
            require(finite(dvec3(attributes.normal(i, from))), "normals are finite");
        }
        const uvec3 cell = attributes.cells().cell(i);
        require(attributes.cells().find(cell) == i, "a cell has the number of its place");
        for (int level = 0; level <= model.dag.depth(); ++level) {
            const int shift = attributes.level() - level;
            const uvec3 path = shift >= 0 ? cell >> static_cast<unsigned>(shift)
                                          : cell << static_cast<unsigned>(-shift);
            (void)attributes.color(path, level, towards);
            (void)attributes.emission(path, level, towards);
            (void)attributes.normal(path, level, towards);
        }
        for (int d = 0; d < 6 && !model.light.empty(); ++d)
            require(finite(dvec3(model.light.get(i, d))), "light is finite");
    }
}

/// Lights the cells where they are few, and takes a picture with their light in each way.
void render_looks(const Model& model) {
    constexpr std::uint64_t kFewCells = 64;
    LitScene scene;
    scene.objects.push_back({.dag = model.dag,
                             .grid = model.grid(),
                             .attributes = model.attributes,
                             .light = model.light});
    scene.lights = model.metadata.lights;
    scene.sky = Sky::constant(vec3(0.5f));
    RenderOptions options;
    options.width = options.height = 4;
    options.shadow_samples = options.ao_samples = options.samples = 1;
    options.threads = 1;
    try {
        if (model.attributes.cells().count() <= kFewCells)
            light_cells(
                scene,
                {.bounces = 1, .lamp_rays = 1, .around_rays = 1, .source_rays = 1, .threads = 1});
        for (const Lighting lighting :
             {Lighting::cached, Lighting::gathered, Lighting::reference}) {
            if (lighting == Lighting::cached && scene.objects[0].light.empty()) continue;
            (void)render_lit(scene, lighting, options);
        }
    } catch (const Error& error) {
        require(error.code() == Errc::bad_argument || error.code() == Errc::limit,
                "lighting fails for arguments only");
    }
}

}  // namespace

void run_octv(Bytes bytes) {
    const std::filesystem::path file = put("a.octv", bytes);
    const std::uint64_t limit = std::uint64_t{1} << 26;
    const Validation validation = validate_octv(file, {.strict = true, .max_dag_bytes = limit});
    const Validation lenient = validate_octv(file, {.max_dag_bytes = limit});
    require(!validation.valid() || lenient.valid(), "strict is stricter");
    // The first of the two takes the slow check, the second the quick one.
    static constexpr std::array<std::string_view, 6> kHarmless = {
        "node-duplicate", "node-order", "node-unreachable", "padding", "gap", "trailing-bytes"};
    require(validation.findings.size() == 100 ||
                lenient.valid() == std::ranges::all_of(validation.findings,
                                                       [](const Finding& finding) {
                                                           return std::ranges::find(kHarmless,
                                                                                    finding.code) !=
                                                                  kHarmless.end();
                                                       }),
            "quick and slow checks agree");
    require(validation.findings.size() <= 100, "at most 100 findings");

    Model model;
    bool accepted = true;
    try {
        model = read_octv(file, {.max_dag_bytes = limit});
    } catch (const Error& error) {
        require(error.code() == Errc::bad_input || error.code() == Errc::unsupported ||
                    error.code() == Errc::limit,
                "what is wrong with a file is bad input, unsupported or a limit");
        accepted = false;
    }
    require(accepted || !lenient.valid(), "what validate accepts can be read");
    for (const Finding& finding : lenient.findings)
        require(!accepted || finding.code == "octree-count" || finding.code == "section-checksum",
                "what can be read has no other findings");
    if (!accepted) return;
    if (lenient.valid())
        require(compute_statistics(model.dag).voxels == model.metadata.statistics.voxels,
                "voxels are as many as stated");
    require(encode_metadata(decode_metadata(encode_metadata(model.metadata))) ==
                encode_metadata(model.metadata),
            "metadata survives");
    trace_some(model);
    render_small(model);
    if (!model.attributes.empty()) {
        look_up_attributes(model);
        render_looks(model);
    }
}

void run_metadata(Bytes bytes) {
    try {
        const Metadata metadata =
            decode_metadata({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        const std::string again = encode_metadata(metadata);
        require(encode_metadata(decode_metadata(again)) == again, "metadata survives");
    } catch (const Error& error) {
        require(error.code() == Errc::bad_input, "bad metadata is bad input");
    }
}

}  // namespace octavo::fuzz
