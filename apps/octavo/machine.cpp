// SPDX-License-Identifier: MIT
#include "machine.h"

#include <fmt/chrono.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <string>

#include "octavo/core/parallel.h"
#include "octavo/core/version.h"
#include "octavo/voxelize/tile_rasterizer.h"

namespace octavo::cli {
namespace {

/// As Linux names it; else the architecture.
std::string processor() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    utsname system{};
    return uname(&system) == 0 ? system.machine : "unknown";
}

std::uint64_t physical_memory() {
    return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

Json circumstances_json(int threads) {
    return {{"version", kVersion},
            {"commit", kCommit},
            {"time", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
            {"processor", processor()},
            {"processors", available_threads()},
            {"memory_bytes", physical_memory()},
            {"simd", simd_targets().front()},
            {"threads", threads}};
}

}  // namespace octavo::cli
