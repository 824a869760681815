// SPDX-License-Identifier: MIT
#include "summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace octavo::cli {
namespace {

Json point_json(const dvec3& point) {
    return {point.x, point.y, point.z};
}

std::string point_text(const dvec3& point) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", point.x, point.y, point.z);
}

/// Megabytes of 10^6 bytes, as [K13] counts them, with at least three digits.
std::string megabytes(std::uint64_t bytes) {
    const double mb = static_cast<double>(bytes) * 1e-6;
    if (mb >= 1000.0) return grouped(static_cast<std::uint64_t>(std::llround(mb))) + " MB";
    return fmt::format("{:.{}f} MB", mb, mb >= 100.0 ? 0 : mb >= 10.0 ? 1 : mb >= 1.0 ? 2 : 4);
}

std::string row(std::string_view label, const std::string& value) {
    return fmt::format("  {:<12}{}\n", label, value);
}

std::string count_row(std::string_view label, std::uint64_t count, const std::string& remark = {}) {
    return fmt::format("  {:<12}{:>19}{}\n", label, grouped(count), remark);
}

/// One structure and what it takes for these voxels.
std::string size_row(std::string_view label, std::uint64_t bytes, const Statistics& statistics) {
    const double bits = statistics.voxels == 0 ? 0.0
                                               : 8.0 * static_cast<double>(bytes) /
                                                     static_cast<double>(statistics.voxels);
    const double times = statistics.dag_bytes == 0 ? 0.0
                                                   : static_cast<double>(bytes) /
                                                         static_cast<double>(statistics.dag_bytes);
    return fmt::format("  {:<26}{:>14}{:>14.3f}{:>12.2f}\n", label, megabytes(bytes), bits, times);
}

constexpr std::array<std::string_view, Attributes::kChannels> kChannelNames = {
    "color", "color, back", "emission", "emission, back", "normal", "normal, back"};

/// Other ways to keep colour and emission of the same cells, as the table of [J].
struct LooksElsewhere {
    std::uint64_t nodes_48, nodes_32;  // an octree of nodes with colour and emission
    std::uint64_t dense;               // a volume texture of 4 bytes of colour and 3 of emission
    std::uint64_t dxt;                 // DXT5 for colour and DXT1 for emission: 1 and 1/2 byte

    explicit LooksElsewhere(const Metadata& metadata) {
        const AttributeSummary& attributes = *metadata.attributes;
        std::uint64_t nodes = attributes.cells;
        for (const LevelStatistics& level : metadata.statistics.levels)
            if (level.level < attributes.level) nodes += level.svo_nodes;
        const std::uint64_t volume = std::uint64_t{1} << 3 * attributes.level;
        nodes_48 = nodes * 48;
        nodes_32 = nodes * 32;
        dense = volume * 7;
        dxt = volume + volume / 2;
    }
};

std::string cell_row(std::string_view label, std::uint64_t bytes, std::uint64_t cells) {
    return fmt::format("  {:<26}{:>14}{:>14.3f}\n", label, megabytes(bytes),
                       cells == 0 ? 0.0 : static_cast<double>(bytes) / static_cast<double>(cells));
}

std::string attribute_table(const OctvSummary& summary) {
    const AttributeSummary& attributes = *summary.metadata.attributes;
    std::string text = "\n";
    text += count_row("cells", attributes.cells,
                      fmt::format("   with attributes, of {0} x {0} x {0}; {1}",
                                  std::uint64_t{1} << attributes.level,
                                  attributes.tolerance == 0 ? "lossless"
                                                            : fmt::format("colors within {} of 255",
                                                                          attributes.tolerance)));
    text += fmt::format("\n  {:<26}{:>14}{:>14}\n", "", "size", "bytes/cell");
    std::uint64_t all = 0;
    for (std::size_t c = 0; c < kChannelNames.size(); ++c) {
        if (summary.attribute_bytes[c] == 0) continue;
        all += summary.attribute_bytes[c];
        text += cell_row(kChannelNames[c], summary.attribute_bytes[c], attributes.cells);
    }
    const LooksElsewhere elsewhere(summary.metadata);
    text += cell_row("all attributes", all, attributes.cells);
    text += cell_row("octree, 32 bytes/node", elsewhere.nodes_32, attributes.cells);
    text += cell_row("octree, 48 bytes/node", elsewhere.nodes_48, attributes.cells);
    text += cell_row("volume, DXT5 and DXT1", elsewhere.dxt, attributes.cells);
    text += cell_row("volume, 7 bytes", elsewhere.dense, attributes.cells);
    return text;
}

Json attribute_json(const OctvSummary& summary) {
    const AttributeSummary& attributes = *summary.metadata.attributes;
    Json bytes = Json::object();
    for (std::size_t c = 0; c < kChannelNames.size(); ++c)
        if (summary.attribute_bytes[c] != 0)
            bytes[std::string(kChannelNames[c])] = summary.attribute_bytes[c];
    const LooksElsewhere elsewhere(summary.metadata);
    return {{"resolution", std::uint64_t{1} << attributes.level},
            {"cells", attributes.cells},
            {"tolerance", attributes.tolerance},
            {"bytes", std::move(bytes)},
            {"octree_32_byte_nodes_bytes", elsewhere.nodes_32},
            {"octree_48_byte_nodes_bytes", elsewhere.nodes_48},
            {"dense_volume_bytes", elsewhere.dense},
            {"dxt_volume_bytes", elsewhere.dxt}};
}

/// A lamp's kind, and its name where it has another.
std::string lamp_text(const Light& light) {
    const std::string kind(name(light.kind));
    return light.name.empty() || light.name == kind ? kind : kind + " '" + light.name + "'";
}

/// How many lamps are spelled out; beyond them, their number.
constexpr std::size_t kNamedLamps = 4;

std::string light_table(const OctvSummary& summary) {
    const LightSummary& light = *summary.metadata.light;
    std::string lamps;
    for (std::size_t i = 0; i < std::min(kNamedLamps, light.lights.size()); ++i)
        lamps += (i == 0 ? "" : ", ") + lamp_text(light.lights[i]);
    if (light.lights.size() > kNamedLamps)
        lamps += fmt::format(" and {} more", light.lights.size() - kNamedLamps);
    std::string text = "\n";
    text += cell_row("stored light", summary.light_bytes,
                     summary.metadata.attributes ? summary.metadata.attributes->cells : 0);
    text += row("bounces", std::to_string(light.bounces));
    text += row("lamps", lamps.empty() ? "none" : lamps);
    text += row("sky", light.sky);
    return text;
}

Json light_json(const OctvSummary& summary) {
    const LightSummary& light = *summary.metadata.light;
    Json lamps = Json::array();
    for (const Light& lamp : light.lights)
        lamps.push_back({{"kind", name(lamp.kind)}, {"name", lamp.name}});
    return {{"bytes", summary.light_bytes},
            {"bounces", light.bounces},
            {"lamps", std::move(lamps)},
            {"sky", light.sky}};
}

}  // namespace

std::string grouped(std::uint64_t number) {
    const std::string digits = std::to_string(number);
    std::string text;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
        text += digits[i];
    }
    return text;
}

std::string short_count(double number) {
    constexpr std::array<std::string_view, 5> kUnits = {"", " k", " M", " G", " T"};
    std::size_t unit = 0;
    for (; number >= 1000.0 && unit + 1 < kUnits.size(); ++unit) number /= 1000.0;
    const int decimals = unit == 0 || number >= 100.0 ? 0 : number >= 10.0 ? 1 : 2;
    return fmt::format("{:.{}f}{}", number, decimals, kUnits[unit]);
}

Json levels_json(const Statistics& statistics) {
    Json levels = Json::array();
    for (const LevelStatistics& level : statistics.levels)
        levels.push_back({{"level", level.level},
                          {"svo_nodes", level.svo_nodes},
                          {"dag_nodes", level.dag_nodes},
                          {"bytes", level.bytes}});
    return levels;
}

Json summary_json(const OctvSummary& summary) {
    const Metadata& metadata = summary.metadata;
    const Statistics& statistics = metadata.statistics;
    const Box bounds = metadata.grid.bounds();
    Json cameras = Json::array();
    for (const Camera& camera : metadata.cameras) cameras.push_back(camera.name);
    Json lights = Json::array();
    for (const Light& light : metadata.lights) lights.push_back(light.name);

    Json json = {
        {"source", metadata.source},
        {"resolution", metadata.grid.resolution()},
        {"depth", metadata.grid.depth},
        {"rule", name(metadata.rule)},
        {"voxels", statistics.voxels},
        {"svo_nodes", statistics.svo_nodes},
        {"dag_nodes", statistics.dag_nodes},
        {"dag_bytes", statistics.dag_bytes},
        {"bits_per_voxel", statistics.bits_per_voxel()},
        {"pointerless_svo_bytes", statistics.pointerless_svo_bytes()},
        {"svo_32_byte_nodes_bytes", statistics.josh_svo_bytes(32)},
        {"svo_48_byte_nodes_bytes", statistics.josh_svo_bytes(48)},
        {"file_bytes", summary.file_bytes},
        {"compressed", summary.compressed},
        {"world_bounds", {{"low", point_json(bounds.low)}, {"high", point_json(bounds.high)}}},
        {"voxel_size", metadata.grid.voxel_size},
        {"triangles", metadata.triangles},
        {"degenerate_triangles", metadata.degenerate_triangles},
        {"non_finite_triangles", metadata.non_finite_triangles},
        {"cameras", std::move(cameras)},
        {"lights", std::move(lights)},
        {"levels", levels_json(statistics)}};
    if (metadata.attributes) json["attributes"] = attribute_json(summary);
    if (metadata.light) json["light"] = light_json(summary);
    return json;
}

std::string summary_table(const OctvSummary& summary) {
    const Metadata& metadata = summary.metadata;
    const Statistics& statistics = metadata.statistics;
    const Box bounds = metadata.grid.bounds();

    std::string text;
    text += row("source", one_line(metadata.source));
    text += row("grid",
                fmt::format("{0} x {0} x {0}, depth {1}, {2} voxels", metadata.grid.resolution(),
                            metadata.grid.depth, name(metadata.rule)));
    text += row("world", point_text(bounds.low) + " to " + point_text(bounds.high));
    text += row("voxel size", fmt::format("{:.6g}", metadata.grid.voxel_size));
    text += "\n";
    text += count_row(
        "triangles", metadata.triangles,
        metadata.degenerate_triangles + metadata.non_finite_triangles == 0
            ? ""
            : fmt::format("   {} degenerate, {} not finite", grouped(metadata.degenerate_triangles),
                          grouped(metadata.non_finite_triangles)));
    text += count_row("voxels", statistics.voxels);
    text += count_row("SVO nodes", statistics.svo_nodes);
    text += count_row("DAG nodes", statistics.dag_nodes);
    text += "\n";
    text += fmt::format("  {:<26}{:>14}{:>14}{:>12}\n", "", "size", "bits/voxel", "x DAG");
    text += size_row("DAG", statistics.dag_bytes, statistics);
    text += size_row("SVO, 1 byte/node", statistics.pointerless_svo_bytes(), statistics);
    text += size_row("SVO, 32 bytes/node", statistics.josh_svo_bytes(32), statistics);
    text += size_row("SVO, 48 bytes/node", statistics.josh_svo_bytes(48), statistics);
    text += size_row(summary.compressed ? "this file, compressed" : "this file", summary.file_bytes,
                     statistics);
    if (metadata.attributes) text += attribute_table(summary);
    if (metadata.light) text += light_table(summary);
    return text;
}

std::string level_table(const Statistics& statistics) {
    std::string text = fmt::format("  {:>5}{:>20}{:>16}{:>16}{:>12}\n", "level", "SVO nodes",
                                   "DAG nodes", "DAG bytes", "SVO/DAG");
    for (const LevelStatistics& level : statistics.levels) {
        const std::string ratio =
            level.dag_nodes == 0 ? "-"
                                 : fmt::format("{:.1f}", static_cast<double>(level.svo_nodes) /
                                                             static_cast<double>(level.dag_nodes));
        text +=
            fmt::format("  {:>5}{:>20}{:>16}{:>16}{:>12}\n", level.level, grouped(level.svo_nodes),
                        grouped(level.dag_nodes), grouped(level.bytes), ratio);
    }
    text += fmt::format("  {:>5}{:>20}{:>16}{:>16}\n", "all", grouped(statistics.svo_nodes),
                        grouped(statistics.dag_nodes), grouped(statistics.dag_bytes));
    return text;
}

}  // namespace octavo::cli
