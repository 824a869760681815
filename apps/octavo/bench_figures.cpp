// SPDX-License-Identifier: MIT
#include "bench_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench_plot.h"
#include "machine.h"
#include "median.h"

namespace octavo::cli {
namespace {

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

std::string differences_line(const Differences& d) {
    const double share = 100.0 / static_cast<double>(d.rays);
    const auto of = [&](std::size_t count) { return share * static_cast<double>(count); };
    return fmt::format(
        "\nprimary hits: {:.2f} % agree, {:.2f} % graze, {:.2f} % at silhouettes, {:.2f} % later "
        "or missed by voxels, {:.2f} % other\n",
        of(d.agree), of(d.plane), of(d.beside), of(d.later), of(d.other));
}

}  // namespace

std::string figures_table(const Figures& figures, const Setting& setting) {
    const bool nanovdb = setting.nanovdb_bytes > 0;
    std::string text = table(figures.rows, !setting.device.empty(), setting.mesh, nanovdb);
    if (setting.partitions > 0)
        text += fmt::format("\nDAG {} bytes, {} partitions {} bytes\n", grouped(setting.dag_bytes),
                            grouped(setting.partitions), grouped(setting.partition_bytes));
    if (nanovdb)
        text += fmt::format("\nDAG {} bytes, NanoVDB {} bytes\n", grouped(setting.dag_bytes),
                            grouped(setting.nanovdb_bytes));
    if (figures.differences.rays > 0) text += differences_line(figures.differences);
    if (setting.wide) text += cone_table(figures.cones);
    return text;
}

Json figures_json(const Figures& figures, const Setting& setting) {
    Json out = {{"bench", "trace"}};
    out.update(circumstances_json(setting.threads));
    out["file"] = setting.file;
    out["resolution"] = setting.resolution;
    out["dag_bytes"] = setting.dag_bytes;
    if (setting.partitions > 0)
        out["partitions"] = {{"count", setting.partitions}, {"bytes", setting.partition_bytes}};
    if (setting.nanovdb_bytes > 0) out["nanovdb_bytes"] = setting.nanovdb_bytes;
    if (!setting.device.empty()) out["device"] = setting.device;
    out["path"] = setting.path;
    out["wide"] = setting.wide;
    out["frames"] = setting.frames;
    out["size"] = setting.size;
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
    if (const Differences& d = figures.differences; d.rays > 0)
        out["primary_differences"] = {{"rays", d.rays},   {"agree", d.agree},
                                      {"graze", d.plane}, {"silhouette", d.beside},
                                      {"later", d.later}, {"other", d.other}};
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

void plot_figures(const std::filesystem::path& file, const std::string& caption,
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

}  // namespace octavo::cli
