// SPDX-License-Identifier: MIT
#include "sky_arguments.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "arguments.h"
#include "degrees.h"
#include "key_values.h"
#include "octavo/mesh/confined_path.h"

namespace octavo::cli {
namespace {

[[noreturn]] void refuse(const std::string& reason) {
    throw Error(Errc::bad_argument, reason);
}

bool names_picture(const std::string& kind) {
    return kind.ends_with(".exr") || kind.ends_with(".hdr");
}

/// A sky's text in front of the first colon, and the rest.
std::pair<std::string, std::string> split(const std::string& text) {
    const std::size_t colon = std::min(text.find(':'), text.size());
    return {text.substr(0, colon), text.substr(colon)};
}

/// How a picture of a sky is opened by its name.
using LoadPicture = std::function<SkyImage(const std::string& name)>;

/// For names that come from a file in this folder.
LoadPicture confined_to(const std::filesystem::path& folder) {
    return [folder](const std::string& name) {
        const auto inside = confined_path(folder, name);
        if (!inside)
            refuse("the picture of its sky, '" + name +
                   "', is outside its folder: name it with "
                   "--sky");
        return load_sky_image(*inside);
    };
}

Sky named_sky(const std::string& kind, const std::string& first, KeyValues& parts, const dvec3& up,
              const LoadPicture& load_picture) {
    if (kind == "none") return {};
    if (kind == "clear") return Sky::clear(up);
    if (kind == "color") return Sky::constant(parse_color(first));
    if (kind == "gradient") {
        const auto color = [&](const char* key) {
            const auto text = parts.take(key);
            if (!text) refuse(std::string("a gradient needs ") + key + "=R,G,B");
            return parse_color(*text);
        };
        const vec3 zenith = color("zenith"), horizon = color("horizon"), ground = color("ground");
        return Sky::gradient(zenith, horizon, ground, up);
    }
    if (!names_picture(kind))
        refuse("'" + kind + "' is not clear, none, color:, gradient: or a .exr or .hdr file");
    const auto turn = parts.take("turn");
    return Sky::image(load_picture(kind), up, turn ? parse_number(*turn) * kRadiansPerDegree : 0.0);
}

Sky parse_sky(const std::string& text, const dvec3& up, const LoadPicture& load_picture) {
    auto [kind, rest] = split(text);
    if (!rest.empty()) rest.erase(0, 1);  // the colon
    std::string first;
    if (kind == "color") {
        const std::size_t end = rest.find(':');
        first = rest.substr(0, end);
        rest = end == std::string::npos ? "" : rest.substr(end + 1);
    }
    KeyValues parts(rest);
    const auto power = parts.take("power");
    const Sky sky = named_sky(kind, first, parts, up, load_picture);
    parts.check_all_taken("this sky");
    return power ? sky.scaled(static_cast<float>(parse_positive(*power))) : sky;
}

}  // namespace

std::filesystem::path sky_picture(const std::string& text) {
    const std::string kind = split(text).first;
    return names_picture(kind) ? kind : "";
}

Sky parse_sky(const std::string& text, const dvec3& up) {
    return parse_sky(text, up, [](const std::string& name) { return load_sky_image(name); });
}

Sky parse_confined_sky(const std::string& text, const dvec3& up,
                       const std::filesystem::path& folder) {
    return parse_sky(text, up, confined_to(folder));
}

std::string stored_sky(const std::string& text, const std::filesystem::path& file) {
    const auto [name, rest] = split(text);
    if (!names_picture(name)) return text;
    namespace fs = std::filesystem;
    const fs::path folder = fs::weakly_canonical(folder_of(file));
    return fs::weakly_canonical(name).lexically_proximate(folder).string() + rest;
}

bool is_stored_sky(const std::string& text, const std::string& stored,
                   const std::filesystem::path& file) {
    return text == stored || stored_sky(text, file) == stored;
}

Sky parse_stored_sky(const std::string& stored, const dvec3& up,
                     const std::filesystem::path& file) {
    try {
        return parse_confined_sky(stored, up, folder_of(file));
    } catch (const Error& error) {
        if (error.code() != Errc::bad_argument) throw;
        throw Error(Errc::bad_input, file, error.what());
    }
}

}  // namespace octavo::cli
