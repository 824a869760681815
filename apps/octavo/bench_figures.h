// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench_race.h"
#include "summary.h"

namespace octavo::cli {

struct Figures {
    std::vector<Row> rows;
    std::vector<Cone> cones;
    Differences differences{};  // of primary rays; of none: not asked for
};

/// What was asked for, and what of it is there.
struct Setting {
    std::uint64_t dag_bytes = 0;
    std::uint32_t resolution = 0;
    std::size_t partitions = 0;  // that the rays asked for
    std::uint64_t partition_bytes = 0;
    std::uint64_t nanovdb_bytes = 0;  // 0: not asked for
    bool mesh = false;
    std::string device;  // its id and name; empty: none
    std::string file;    // without its folder, as the path
    std::string path;
    int size = 0;  // pixels along a picture's side
    bool wide = true;
    int frames = 0;
    int threads = 0;
};

/// For people: medians of the frames.
[[nodiscard]] std::string figures_table(const Figures& figures, const Setting& setting);

/// With every frame's speed, the machine and the commit.
[[nodiscard]] Json figures_json(const Figures& figures, const Setting& setting);

void plot_figures(const std::filesystem::path& file, const std::string& caption,
                  const std::vector<Row>& rows, const Setting& setting);

}  // namespace octavo::cli
