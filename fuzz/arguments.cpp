// SPDX-License-Identifier: MIT
#include "../apps/octavo/arguments.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "harness.h"
#include "promise.h"

namespace octavo::fuzz {
namespace {

/// Parses, and checks what comes out; an Error must be one about the argument.
template <typename Parse, typename Check>
void try_parse(const std::string& text, const Parse& parse, const Check& check) {
    try {
        require(check(parse(text)), "an argument that is taken is in range");
    } catch (const Error& error) {
        require(error.code() == Errc::bad_argument, "a bad argument is a bad argument");
    }
}

bool is_positive_float(double number) {
    return number >= 0.0 && number <= std::numeric_limits<float>::max();
}

/// What a validator lets through is what the library then reads from the same text.
template <typename Check>
void try_option(std::string text, const CLI::Validator& validator, const Check& check) {
    double number = 0.0;
    if (!validator(text).empty()) return;
    require(CLI::detail::lexical_cast(text, number), "a number that is taken is a number");
    require(check(number), "a number that is taken is in range");
}

}  // namespace

void run_arguments(Bytes bytes) {
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    try_parse(text, cli::parse_resolution, [](int depth) { return depth >= 2 && depth <= 17; });
    try_parse(text, cli::parse_bytes, [](std::uint64_t size) { return size < 1ull << 63; });
    try_parse(text, cli::parse_vec3, finite);
    try_parse(text, cli::parse_ray, [](const cli::RayArgument& ray) {
        return finite(ray.origin) && finite(ray.direction) && ray.direction != dvec3(0.0);
    });
    try_parse(text, cli::parse_angles, [](const std::array<double, 2>& angles) {
        return std::isfinite(angles[0]) && std::isfinite(angles[1]);
    });
    try_parse(text, cli::parse_color, [](const vec3& color) {
        return finite(dvec3(color)) && color.r >= 0.0f && color.g >= 0.0f && color.b >= 0.0f;
    });
    try_parse(text, cli::parse_positive, is_positive_float);
    try_parse(text, cli::parse_sides, [](const std::array<double, 2>& sides) {
        return is_positive_float(sides[0]) && is_positive_float(sides[1]) && sides[0] > 0.0;
    });
    try_option(text, cli::within(-32.0, 32.0), [](double n) { return n >= -32.0 && n <= 32.0; });
    try_option(text, cli::above_zero(), [](double n) { return n > 0.0 && std::isfinite(n); });
    try_option(text, cli::zero_or_more(), [](double n) { return n >= 0.0 && std::isfinite(n); });
    try_parse(text, cli::parse_size, [](const uvec2& size) {
        return size.x >= 1 && size.y >= 1 && size.x <= 65536 && size.y <= 65536;
    });
}

}  // namespace octavo::fuzz
