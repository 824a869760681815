// SPDX-License-Identifier: MIT
#include "octavo/io/metadata.h"

#include <array>
#include <cmath>
#include <utility>

#include "octavo/core/error.h"
#include "octavo/dag/node.h"
#include "octavo/io/json_field.h"

namespace octavo {
namespace {

/// JSON without spaces, written as it comes: equal metadata, equal bytes.
class JsonWriter {
public:
    /// Of an object, or at the front of an array's item where there is no key.
    JsonWriter& key(std::string_view name) {
        separate();
        append_json(text_, name);
        text_ += ':';
        first_ = true;
        return *this;
    }
    JsonWriter& open(char bracket) {
        separate();
        text_ += bracket;
        first_ = true;
        return *this;
    }
    JsonWriter& close(char bracket) {
        text_ += bracket;
        first_ = false;
        return *this;
    }
    JsonWriter& value(std::string_view text) {
        separate();
        append_json(text_, text);
        return *this;
    }
    JsonWriter& value(std::uint64_t count) {
        separate();
        text_ += std::to_string(count);
        return *this;
    }
    JsonWriter& value(int count) { return value(static_cast<std::uint64_t>(count)); }
    JsonWriter& value(double number) {
        // JSON has no such numbers, and the file could not be read back.
        if (!std::isfinite(number))
            throw Error(Errc::bad_argument, "metadata: a number is not finite");
        separate();
        append_json(text_, number);
        return *this;
    }
    template <typename Vector>
    JsonWriter& vector(const Vector& v) {
        open('[');
        for (const auto number : {v.x, v.y, v.z}) value(static_cast<double>(number));
        return close(']');
    }
    [[nodiscard]] std::string take() { return std::move(text_); }

private:
    void separate() {
        if (!std::exchange(first_, false)) text_ += ',';
    }

    std::string text_;
    bool first_ = true;  // of an object or array, or behind a key
};

void write_camera(JsonWriter& json, const Camera& camera) {
    json.open('{').key("name").value(camera.name);
    json.key("eye").vector(camera.eye);
    json.key("forward").vector(camera.forward);
    json.key("up").vector(camera.up);
    json.key("vertical_fov").value(camera.vertical_fov).close('}');
}

/// What only some kinds have is left out of the others.
void write_light(JsonWriter& json, const Light& light) {
    json.open('{').key("name").value(light.name);
    json.key("kind").value(octavo::name(light.kind));
    json.key("position").vector(light.position);
    json.key("direction").vector(light.direction);
    json.key("intensity").vector(light.intensity);
    json.key("inner_angle").value(light.inner_angle);
    json.key("outer_angle").value(light.outer_angle);
    if (light.size != 0.0) json.key("size").value(light.size);
    if (light.kind == Light::Kind::rectangle) {
        json.key("half_u").vector(light.half_u);
        json.key("half_v").vector(light.half_v);
    }
    if (light.kind == Light::Kind::mesh) {
        json.key("triangles").open('[');
        for (const auto& corners : light.triangles)
            for (const dvec3& corner : corners)
                for (const double number : {corner.x, corner.y, corner.z}) json.value(number);
        json.close(']');
    }
    json.close('}');
}

void write_lights(JsonWriter& json, const std::vector<Light>& lights) {
    json.key("lights").open('[');
    for (const Light& light : lights) write_light(json, light);
    json.close(']');
}

using Field = JsonField;

[[noreturn]] void refuse(const std::string& reason) {
    throw Error(Errc::bad_input, reason);
}

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

Metadata decode(const Field& root) {
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

}  // namespace

std::string encode_metadata(const Metadata& metadata) {
    JsonWriter json;
    json.open('{').key("source").value(metadata.source);
    json.key("rule").value(name(metadata.rule));
    json.key("grid").open('{').key("origin").vector(metadata.grid.origin);
    json.key("voxel_size").value(metadata.grid.voxel_size);
    json.key("depth").value(metadata.grid.depth).close('}');
    json.key("triangles").open('{').key("total").value(metadata.triangles);
    json.key("degenerate").value(metadata.degenerate_triangles);
    json.key("non_finite").value(metadata.non_finite_triangles).close('}');
    json.key("voxels").value(metadata.statistics.voxels);
    json.key("levels").open('[');
    for (const LevelStatistics& level : metadata.statistics.levels) {
        json.open('{').key("svo_nodes").value(level.svo_nodes);
        json.key("dag_nodes").value(level.dag_nodes);
        json.key("words").value(level.bytes / sizeof(std::uint32_t)).close('}');
    }
    json.close(']').key("cameras").open('[');
    for (const Camera& camera : metadata.cameras) write_camera(json, camera);
    json.close(']');
    write_lights(json, metadata.lights);
    if (metadata.attributes) {
        json.key("attributes").open('{').key("level").value(metadata.attributes->level);
        json.key("cells").value(metadata.attributes->cells);
        json.key("tolerance").value(metadata.attributes->tolerance).close('}');
    }
    if (metadata.light) {
        json.key("light").open('{').key("bounces").value(metadata.light->bounces);
        json.key("sky").value(metadata.light->sky);
        write_lights(json, metadata.light->lights);
        json.close('}');
    }
    return json.close('}').take();
}

Metadata decode_metadata(std::string_view text) {
    try {
        const JsonValue json = parse_json(text);
        return decode(Field(json, ""));
    } catch (const Error& error) {
        throw Error(error.code(), std::string("metadata: ") + error.what());
    }
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
