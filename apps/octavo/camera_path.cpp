// SPDX-License-Identifier: MIT
#include "camera_path.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "octavo/core/error.h"
#include "octavo/render/render.h"

namespace octavo::cli {
namespace {

using Json = nlohmann::json;

constexpr double kDefaultFov = 45.0;
constexpr int kMostFrames = 100000;

template <typename Value>
Value catmull_rom(const Value& a, const Value& b, const Value& c, const Value& d, double t) {
    return b +
           0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
}

dvec3 vector_of(const Json& json) {
    const auto numbers = json.get<std::array<double, 3>>();
    return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

Camera CameraPath::camera(int frame, int count) const {
    const int n = static_cast<int>(keys.size());
    const int stretches = closed ? n : n - 1;
    const double way =
        static_cast<double>(stretches) * frame / std::max(1, closed ? count : count - 1);
    const int first = std::min(static_cast<int>(way), std::max(0, stretches - 1));
    const auto key = [&](int i) -> const Key& {
        return keys[static_cast<std::size_t>(closed ? (i + n) % n : std::clamp(i, 0, n - 1))];
    };
    const Key &a = key(first - 1), &b = key(first), &c = key(first + 1), &d = key(first + 2);
    const double t = way - first;
    return look_at(catmull_rom(a.eye, b.eye, c.eye, d.eye, t),
                   catmull_rom(a.at, b.at, c.at, d.at, t), up,
                   catmull_rom(a.vertical_fov, b.vertical_fov, c.vertical_fov, d.vertical_fov, t));
}

CameraPath read_camera_path(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw io_error(file, "open");
    CameraPath path;
    try {
        const Json json = Json::parse(stream);
        path.frames = json.value("frames", path.frames);
        path.closed = json.value("closed", false);
        if (json.contains("up")) path.up = vector_of(json.at("up"));
        for (const Json& camera : json.at("cameras"))
            path.keys.push_back({vector_of(camera.at("eye")), vector_of(camera.at("at")),
                                 camera.value("fov", kDefaultFov) * std::numbers::pi / 180.0});
        if (path.keys.empty()) throw Error(Errc::bad_input, "there is no camera");
        if (path.frames < 1 || path.frames > kMostFrames)
            throw Error(Errc::bad_input, "frames are 1 to 100000");
        for (int frame = 0; frame < path.frames; ++frame) (void)path.camera(frame, path.frames);
    } catch (const Json::exception& error) {
        throw Error(Errc::bad_input, file, std::string("not a camera path: ") + error.what());
    } catch (const Error& error) {
        throw Error(Errc::bad_input, file, std::string("not a camera path: ") + error.what());
    }
    return path;
}

}  // namespace octavo::cli
