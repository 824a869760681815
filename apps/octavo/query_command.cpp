// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "arguments.h"
#include "commands.h"
#include "help.h"
#include "octavo/io/octv.h"
#include "octavo/trace/trace.h"
#include "output.h"
#include "summary.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo query scene.octv --point 1,0.5,-2\n"
    "  octavo query scene.octv --ray 0,10,0,0,-1,0 --json\n";

struct QueryArguments {
    std::filesystem::path file;
    bool trusted = false;
    std::optional<dvec3> point;
    std::optional<RayArgument> ray;
    bool json = false;
};

template <typename Vector>
Json vector_json(const Vector& v) {
    return {v.x, v.y, v.z};
}

template <typename Vector>
std::string vector_text(const Vector& v) {
    return fmt::format("{},{},{}", v.x, v.y, v.z);
}

/// The voxel that holds a point of grid space, if the point is in the grid.
std::optional<uvec3> voxel_at(const dvec3& grid_point, const Grid& grid) {
    const double n = grid.resolution();
    const auto inside = [&](double x) { return x >= 0.0 && x < n; };
    if (!inside(grid_point.x) || !inside(grid_point.y) || !inside(grid_point.z))
        return std::nullopt;
    return uvec3(grid_point);
}

/// What the surface looks like in a cell, seen from there.
struct Looks {
    std::optional<Rgb8> color;
    std::optional<vec3> emission, normal;

    Looks(const Attributes& attributes, const uvec3& path, int level, const vec3& towards)
        : color(attributes.color(path, level, towards)),
          emission(attributes.emission(path, level, towards)),
          normal(attributes.normal(path, level, towards)) {}

    void add_to(Json& json) const {
        if (color) json["color"] = *color;
        if (emission) json["emission"] = vector_json(*emission);
        if (normal) json["surface_normal"] = vector_json(*normal);
    }
    [[nodiscard]] std::string text() const {
        std::string text;
        if (color)
            text +=
                fmt::format(", color #{:02x}{:02x}{:02x}", (*color)[0], (*color)[1], (*color)[2]);
        if (emission) text += ", emission " + vector_text(*emission);
        if (normal) text += ", surface normal " + vector_text(*normal);
        return text;
    }
};

std::string answer_point(const Model& model, const dvec3& point, bool json) {
    const auto voxel = voxel_at(model.grid().to_grid(point), model.grid());
    const bool set = voxel && model.dag.voxel(*voxel);
    std::optional<Looks> looks;
    if (set && !model.attributes.empty())
        looks.emplace(model.attributes, *voxel, model.dag.depth(), vec3(0.0f));
    if (json) {
        Json answer{{"point", vector_json(point)},
                    {"inside", voxel.has_value()},
                    {"voxel", voxel ? vector_json(*voxel) : Json()},
                    {"set", set}};
        if (looks) looks->add_to(answer);
        return answer.dump(2) + "\n";
    }
    if (!voxel) return "outside the grid\n";
    return fmt::format("voxel {} is {}{}\n", vector_text(*voxel), set ? "set" : "empty",
                       looks ? looks->text() : "");
}

std::string answer_ray(const Model& model, const RayArgument& ray, bool json) {
    const Hit hit = trace_closest(model.dag, model.grid(),
                                  Ray{.origin = ray.origin, .direction = ray.direction});
    const dvec3 position = hit ? ray.origin + hit.t * ray.direction : dvec3(0.0);
    std::optional<Looks> looks;
    if (hit && !model.attributes.empty())
        looks.emplace(model.attributes, hit.path, hit.level, vec3(-ray.direction));
    if (json) {
        Json answer{{"origin", vector_json(ray.origin)},
                    {"direction", vector_json(ray.direction)},
                    {"hit", static_cast<bool>(hit)},
                    {"t", hit ? Json(hit.t) : Json()},
                    {"position", hit ? vector_json(position) : Json()},
                    {"voxel", hit ? vector_json(hit.path) : Json()},
                    {"normal", hit ? vector_json(hit.normal()) : Json()}};
        if (looks) looks->add_to(answer);
        return answer.dump(2) + "\n";
    }
    if (!hit) return "the ray hits nothing\n";
    return fmt::format("hits voxel {} at {}, t = {}, normal {}{}\n", vector_text(hit.path),
                       vector_text(position), hit.t, vector_text(hit.normal()),
                       looks ? looks->text() : "");
}

void run_query(const QueryArguments& arguments) {
    const Model model = read_octv(arguments.file, {.trusted = arguments.trusted});
    print(arguments.point ? answer_point(model, *arguments.point, arguments.json)
                          : answer_ray(model, *arguments.ray, arguments.json));
}

}  // namespace

void add_query_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("query", "Ask whether a point is in a voxel, or what a ray hits");
    const auto arguments = std::make_shared<QueryArguments>();
    set_help(command, kExamples);
    command.add_option("FILE", arguments->file, "An .octv file")->required()->type_name("");
    command.add_flag("--trusted", arguments->trusted, kTrustedHelp);
    CLI::Option_group& question =
        *command.add_option_group("Question", "One of these; world space");
    add_parsed(question, "--point", arguments->point, parse_vec3, "Is this point in a voxel?",
               "X,Y,Z");
    add_parsed(question, "--ray", arguments->ray, parse_ray,
               "What does the ray from this point in this direction hit first?",
               "OX,OY,OZ,DX,DY,DZ");
    question.require_option(1);
    command.add_flag("--json", arguments->json, "Answer as JSON");
    command.callback([arguments] { run_query(*arguments); });
}

}  // namespace octavo::cli
