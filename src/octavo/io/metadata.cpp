// SPDX-License-Identifier: MIT
#include "octavo/io/metadata.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "octavo/core/error.h"
#include "octavo/dag/node.h"

namespace octavo {
namespace {

using Json = nlohmann::ordered_json;  // keeps the order of keys: equal metadata, equal bytes

constexpr int kMaxNesting = 8;
constexpr std::size_t kMaxValues = 1'000'000;
template <typename Vector>
Json vector_json(const Vector& v) {
    // dump() would write null, and the file could not be read back.
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        throw Error(Errc::bad_argument, "metadata: a position or direction is not finite");
    return {v.x, v.y, v.z};
}

Json number_json(double number) {
    if (!std::isfinite(number))
        throw Error(Errc::bad_argument, "metadata: an angle or size is not finite");
    return number;
}

Json camera_json(const Camera& camera) {
    return {{"name", camera.name},
            {"eye", vector_json(camera.eye)},
            {"forward", vector_json(camera.forward)},
            {"up", vector_json(camera.up)},
            {"vertical_fov", number_json(camera.vertical_fov)}};
}

/// What only some kinds have is left out of the others.
Json light_json(const Light& light) {
    Json json = {{"name", light.name},
                 {"kind", name(light.kind)},
                 {"position", vector_json(light.position)},
                 {"direction", vector_json(light.direction)},
                 {"intensity", vector_json(light.intensity)},
                 {"inner_angle", number_json(light.inner_angle)},
                 {"outer_angle", number_json(light.outer_angle)}};
    if (light.size != 0.0) json["size"] = number_json(light.size);
    if (light.kind == Light::Kind::rectangle) {
        json["half_u"] = vector_json(light.half_u);
        json["half_v"] = vector_json(light.half_v);
    }
    if (light.kind == Light::Kind::mesh) {
        Json& triangles = json["triangles"] = Json::array();
        for (const auto& corners : light.triangles)
            for (const dvec3& corner : corners)
                for (const double number : {corner.x, corner.y, corner.z})
                    triangles.push_back(number_json(number));
    }
    return json;
}

[[noreturn]] void refuse(const std::string& reason) {
    throw Error(Errc::bad_input, "metadata: " + reason);
}

/// A JSON value together with the way to it, so that an error can name the field.
class Field {
public:
    Field(const Json& json, std::string name) : json_(json), name_(std::move(name)) {}

    [[nodiscard]] Field operator[](const char* key) const {
        if (!json_.is_object()) refuse(name_ + " is not an object");
        const auto found = json_.find(key);
        if (found == json_.end()) refuse(name_ + "/" + key + " is missing");
        return {*found, name_ + "/" + key};
    }
    [[nodiscard]] bool has(const char* key) const {
        return json_.is_object() && json_.contains(key);
    }
    [[nodiscard]] std::vector<Field> items() const {
        if (!json_.is_array()) refuse(name_ + " is not an array");
        std::vector<Field> fields;
        for (std::size_t i = 0; i < json_.size(); ++i)
            fields.emplace_back(json_[i], name_ + "/" + std::to_string(i));
        return fields;
    }
    [[nodiscard]] std::string text() const {
        if (!json_.is_string()) refuse(name_ + " is not a text");
        return json_.get<std::string>();
    }
    [[nodiscard]] double number() const {
        if (!json_.is_number()) refuse(name_ + " is not a number");
        const auto value = json_.get<double>();
        if (!std::isfinite(value)) refuse(name_ + " is not finite");
        return value;
    }
    [[nodiscard]] std::uint64_t count(std::uint64_t max) const {
        if (!json_.is_number_unsigned()) refuse(name_ + " is not a count");
        const auto value = json_.get<std::uint64_t>();
        if (value > max)
            refuse(name_ + " is " + std::to_string(value) + "; at most " + std::to_string(max) +
                   " is possible");
        return value;
    }
    template <typename Vector>
    [[nodiscard]] Vector vector() const {
        const std::vector<Field> parts = items();
        if (parts.size() != 3) refuse(name_ + " does not have three numbers");
        using Number = typename Vector::value_type;
        return Vector(static_cast<Number>(parts[0].number()),
                      static_cast<Number>(parts[1].number()),
                      static_cast<Number>(parts[2].number()));
    }
    [[nodiscard]] const std::string& name() const { return name_; }

private:
    const Json& json_;
    std::string name_;
};

Camera decode_camera(const Field& json) {
    return {.name = json["name"].text(),
            .eye = json["eye"].vector<dvec3>(),
            .forward = json["forward"].vector<dvec3>(),
            .up = json["up"].vector<dvec3>(),
            .vertical_fov = json["vertical_fov"].number()};
}

std::vector<std::array<dvec3, 3>> decode_triangles(const Field& json) {
    const std::vector<Field> numbers = json.items();
    if (numbers.size() % 9 != 0) refuse(json.name() + " is not nine numbers for each triangle");
    std::vector<std::array<dvec3, 3>> triangles(numbers.size() / 9);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        triangles[i / 9][i / 3 % 3][static_cast<int>(i % 3)] = numbers[i].number();
    return triangles;
}

Light decode_light(const Field& json) {
    Light light;
    light.name = json["name"].text();
    const std::string kind = json["kind"].text();
    std::size_t index = 0;
    while (index < kLightKindNames.size() && kLightKindNames[index] != kind) ++index;
    if (index == kLightKindNames.size())
        refuse(json.name() + "/kind is not sun, point, spot, disc, rectangle or mesh");
    light.kind = static_cast<Light::Kind>(index);
    light.position = json["position"].vector<dvec3>();
    light.direction = json["direction"].vector<dvec3>();
    light.intensity = json["intensity"].vector<vec3>();
    light.inner_angle = json["inner_angle"].number();
    light.outer_angle = json["outer_angle"].number();
    if (json.has("size")) light.size = json["size"].number();
    if (light.size < 0.0) refuse(json.name() + "/size is below 0");
    if (light.kind == Light::Kind::rectangle) {
        light.half_u = json["half_u"].vector<dvec3>();
        light.half_v = json["half_v"].vector<dvec3>();
    }
    if (light.kind == Light::Kind::mesh) light.triangles = decode_triangles(json["triangles"]);
    return light;
}

Grid decode_grid(const Field& json) {
    Grid grid;
    grid.origin = json["origin"].vector<dvec3>();
    grid.voxel_size = json["voxel_size"].number();
    grid.depth = static_cast<int>(json["depth"].count(kMaxDepth));
    if (grid.depth < kMinDepth) refuse("/grid/depth is below 2");
    if (grid.voxel_size <= 0.0) refuse("/grid/voxel_size is not above 0");
    const dvec3 high = grid.bounds().high;
    if (!std::isfinite(high.x) || !std::isfinite(high.y) || !std::isfinite(high.z))
        refuse("/grid reaches past the largest number");
    return grid;
}

/// A level can hold no more nodes than it has cells, nor be stored in fewer or more words than its
/// nodes can have. So the sums below cannot overflow: 8^17 is 2^51.
LevelStatistics decode_level(const Field& json, int level, int depth) {
    const std::uint64_t cells = std::uint64_t{1} << 3 * level;
    LevelStatistics statistics;
    statistics.level = level;
    statistics.svo_nodes = json["svo_nodes"].count(cells);
    statistics.dag_nodes = json["dag_nodes"].count(level == depth - 1 ? 0 : statistics.svo_nodes);
    const std::uint64_t nodes = statistics.dag_nodes;
    const std::uint64_t words = json["words"].count(std::uint64_t{1} << 32);
    const bool leaf = level == depth - 2;
    if (words < 2 * nodes || words > (leaf ? kLeafWords : kMaxNodeWords) * nodes)
        refuse(json.name() + "/words cannot be those of " + std::to_string(nodes) + " nodes");
    statistics.bytes = words * sizeof(std::uint32_t);
    return statistics;
}

Statistics decode_statistics(const Field& json, int depth) {
    Statistics statistics;
    statistics.voxels = json["voxels"].count(std::uint64_t{1} << 3 * depth);
    const std::vector<Field> levels = json["levels"].items();
    if (levels.size() != static_cast<std::size_t>(depth))
        refuse("/levels has " + std::to_string(levels.size()) + " entries, and the depth is " +
               std::to_string(depth));
    for (int level = 0; level < depth; ++level) {
        const auto entry = decode_level(levels[static_cast<std::size_t>(level)], level, depth);
        statistics.svo_nodes += entry.svo_nodes;
        statistics.dag_nodes += entry.dag_nodes;
        statistics.dag_bytes += entry.bytes;
        statistics.levels.push_back(entry);
    }
    return statistics;
}

AttributeSummary decode_attributes(const Field& json, int depth) {
    AttributeSummary attributes;
    attributes.level = static_cast<int>(json["level"].count(static_cast<std::uint64_t>(depth)));
    if (attributes.level < kMinDepth) refuse("/attributes/level is below 2");
    attributes.cells = json["cells"].count(std::uint64_t{1} << 3 * attributes.level);
    attributes.tolerance = static_cast<int>(json["tolerance"].count(255));
    return attributes;
}

LightSummary decode_stored_light(const Field& json) {
    LightSummary light;
    light.bounces = static_cast<int>(json["bounces"].count(8));
    light.sky = json["sky"].text();
    for (const Field& one : json["lights"].items()) light.lights.push_back(decode_light(one));
    return light;
}

Json parse(std::string_view text) {
    std::size_t values = 0;
    const auto bounded = [&](int nesting, Json::parse_event_t, Json&) {
        if (nesting > kMaxNesting) refuse("the JSON is nested too deep");
        if (++values > kMaxValues) refuse("the JSON has too many values");
        return true;
    };
    try {
        return Json::parse(text.begin(), text.end(), bounded);
    } catch (const Json::parse_error& error) {
        refuse("not JSON at its byte " + std::to_string(error.byte));
    } catch (const Json::exception&) {
        refuse("not JSON: a number is out of range");
    }
}

}  // namespace

std::string encode_metadata(const Metadata& metadata) {
    Json levels = Json::array();
    for (const LevelStatistics& level : metadata.statistics.levels)
        levels.push_back({{"svo_nodes", level.svo_nodes},
                          {"dag_nodes", level.dag_nodes},
                          {"words", level.bytes / sizeof(std::uint32_t)}});
    Json cameras = Json::array();
    for (const Camera& camera : metadata.cameras) cameras.push_back(camera_json(camera));
    Json lights = Json::array();
    for (const Light& light : metadata.lights) lights.push_back(light_json(light));

    Json json = {{"source", metadata.source},
                 {"rule", name(metadata.rule)},
                 {"grid",
                  {{"origin", vector_json(metadata.grid.origin)},
                   {"voxel_size", number_json(metadata.grid.voxel_size)},
                   {"depth", metadata.grid.depth}}},
                 {"triangles",
                  {{"total", metadata.triangles},
                   {"degenerate", metadata.degenerate_triangles},
                   {"non_finite", metadata.non_finite_triangles}}},
                 {"voxels", metadata.statistics.voxels},
                 {"levels", std::move(levels)},
                 {"cameras", std::move(cameras)},
                 {"lights", std::move(lights)}};
    if (metadata.attributes)
        json["attributes"] = {{"level", metadata.attributes->level},
                              {"cells", metadata.attributes->cells},
                              {"tolerance", metadata.attributes->tolerance}};
    if (metadata.light) {
        Json of_cells = Json::array();
        for (const Light& light : metadata.light->lights) of_cells.push_back(light_json(light));
        json["light"] = {{"bounces", metadata.light->bounces},
                         {"sky", metadata.light->sky},
                         {"lights", std::move(of_cells)}};
    }
    // Names come from scene files and may be any bytes; what is not UTF-8 becomes U+FFFD.
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Metadata decode_metadata(std::string_view text) {
    const Json json = parse(text);
    const Field root(json, "");
    Metadata metadata;
    metadata.source = root["source"].text();
    const auto rule = voxel_rule_from_name(root["rule"].text());
    if (!rule) refuse("/rule is not a rule that this program knows");
    metadata.rule = *rule;
    metadata.grid = decode_grid(root["grid"]);

    const Field triangles = root["triangles"];
    constexpr std::uint64_t kAnyCount = std::uint64_t{1} << 53;  // exact in every JSON reader
    metadata.triangles = triangles["total"].count(kAnyCount);
    metadata.degenerate_triangles = triangles["degenerate"].count(metadata.triangles);
    metadata.non_finite_triangles = triangles["non_finite"].count(metadata.triangles);
    metadata.statistics = decode_statistics(root, metadata.grid.depth);
    if (root.has("attributes"))
        metadata.attributes = decode_attributes(root["attributes"], metadata.grid.depth);
    if (root.has("light")) metadata.light = decode_stored_light(root["light"]);
    for (const Field& camera : root["cameras"].items())
        metadata.cameras.push_back(decode_camera(camera));
    for (const Field& light : root["lights"].items())
        metadata.lights.push_back(decode_light(light));
    return metadata;
}

std::vector<std::uint64_t> level_begins(const Statistics& statistics) {
    std::vector<std::uint64_t> begins;
    std::uint64_t word = 0;
    for (const LevelStatistics& level : statistics.levels) {
        begins.push_back(word);
        word += level.bytes / sizeof(std::uint32_t);
    }
    return begins;  // the entry of level depth - 1, which stores nothing, is the number of words
}

}  // namespace octavo
