// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <memory>
#include <string>

#include "commands.h"
#include "help.h"
#include "octavo/backend/device.h"
#include "output.h"
#include "summary.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo devices\n"
    "  octavo render scene.octv -o scene.png --device vulkan:0\n";

std::string memory_text(std::uint64_t bytes) {
    return fmt::format("{:.1f} GiB", static_cast<double>(bytes) / (1ull << 30));
}

std::string text(const DeviceList& list) {
    std::string out;
    for (const DeviceInfo& device : list.devices) {
        out += fmt::format("{:10} {}\n", device.id(), device.name);
        out += fmt::format("{:10} {}, {}, {}\n", "", device.type, memory_text(device.memory_bytes),
                           device.driver);
        for (const auto& [name, value] : device.limits)
            out += fmt::format("{:10} {} {}\n", "", name, grouped(value));
        if (!device.unusable.empty())
            out += fmt::format("{:10} cannot be used: {}\n", "", device.unusable);
    }
    for (const auto& [kind, why] : list.missing) out += fmt::format("{:10} none: {}\n", kind, why);
    return out;
}

Json json(const DeviceList& list) {
    Json out;
    out["devices"] = Json::array();
    for (const DeviceInfo& device : list.devices) {
        Json d;
        d["id"] = device.id();
        d["kind"] = device_kind_name(device.kind);
        d["name"] = device.name;
        d["type"] = device.type;
        d["driver"] = device.driver;
        d["memory_bytes"] = device.memory_bytes;
        d["limits"] = Json::object();
        for (const auto& [name, value] : device.limits) d["limits"][name] = value;
        d["usable"] = device.unusable.empty();
        if (!device.unusable.empty()) d["why"] = device.unusable;
        out["devices"].push_back(d);
    }
    out["missing"] = Json::object();
    for (const auto& [kind, why] : list.missing) out["missing"][kind] = why;
    return out;
}

}  // namespace

void add_devices_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("devices", "List what rays can run on: the CPU and GPUs");
    const auto as_json = std::make_shared<bool>(false);
    set_help(command, kExamples);
    command.add_flag("--json", *as_json, "As JSON");
    command.callback([as_json] {
        const DeviceList list = list_devices();
        print(*as_json ? json(list).dump(2) + "\n" : text(list));
    });
}

}  // namespace octavo::cli
