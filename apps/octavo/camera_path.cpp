// SPDX-License-Identifier: MIT
#include "camera_path.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "degrees.h"
#include "octavo/core/file_bytes.h"
#include "octavo/render/render.h"

namespace octavo::cli {
namespace {

constexpr std::uint64_t kMostFrames = 100000;
constexpr std::uint64_t kMostBytes = 16u << 20;

template <typename Value>
Value catmull_rom(const Value& a, const Value& b, const Value& c, const Value& d, double t) {
    return b +
           0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
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

CameraPath::Key read_camera_key(const JsonField& camera) {
    const double degrees = camera.has("fov") ? camera["fov"].number() : kDefaultFovDegrees;
    return {camera["eye"].vector<dvec3>(), camera["at"].vector<dvec3>(),
            degrees * kRadiansPerDegree};
}

CameraPath read_camera_path(const std::filesystem::path& file) {
    const FileBytes bytes = read_file(file, kMostBytes);
    CameraPath path;
    try {
        const JsonValue json = parse_json(bytes.view());
        const JsonField root(json, "");
        if (root.has("frames")) path.frames = static_cast<int>(root["frames"].count(kMostFrames));
        if (path.frames == 0) root["frames"].refuse("is 0");
        if (root.has("closed")) path.closed = root["closed"].truth();
        if (root.has("up")) path.up = root["up"].vector<dvec3>();
        for (const JsonField& camera : root["cameras"].items())
            path.keys.push_back(read_camera_key(camera));
        if (path.keys.empty()) root["cameras"].refuse("is empty");
        for (int frame = 0; frame < path.frames; ++frame) (void)path.camera(frame, path.frames);
    } catch (const Error& error) {
        throw Error(Errc::bad_input, file, std::string("not a camera path: ") + error.what());
    }
    return path;
}

}  // namespace octavo::cli
