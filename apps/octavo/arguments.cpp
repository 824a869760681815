// SPDX-License-Identifier: MIT
#include "arguments.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

#include "degrees.h"
#include "octavo/core/grid.h"

namespace octavo::cli {
namespace {

constexpr double kMaxFloat = std::numeric_limits<float>::max();

[[noreturn]] void refuse(std::string_view text, const std::string& expected) {
    throw Error(Errc::bad_argument, "'" + std::string(text) + "' is not " + expected);
}

/// Reads a number at the start of `text` and removes it. @return whether there was one
template <typename Number>
bool take_number(std::string_view& text, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return true;
}

template <std::size_t N>
std::array<double, N> parse_numbers(std::string_view text, const std::string& expected) {
    std::array<double, N> numbers{};
    std::string_view rest = text;
    for (std::size_t i = 0; i < N; ++i) {
        if (i > 0) {
            if (rest.empty() || rest.front() != ',') refuse(text, expected);
            rest.remove_prefix(1);
        }
        if (!take_number(rest, numbers[i]) || !std::isfinite(numbers[i])) refuse(text, expected);
    }
    if (!rest.empty()) refuse(text, expected);
    return numbers;
}

}  // namespace

int parse_resolution(const std::string& text) {
    const std::string expected = "a power of two from 4 to 128K, like 4096 or 4K";
    std::string_view rest = text;
    std::uint64_t number = 0;
    if (!take_number(rest, number) || number > 1u << kMaxDepth) refuse(text, expected);
    if (rest == "K" || rest == "k")
        number *= 1024;
    else if (!rest.empty())
        refuse(text, expected);
    return depth_of_resolution(number);
}

VoxelRule parse_rule(const std::string& text) {
    const auto rule = voxel_rule_from_name(text);
    if (!rule) throw Error(Errc::bad_argument, "'" + text + "' is not conservative or thin");
    return *rule;
}

std::uint64_t parse_bytes(const std::string& text) {
    const std::string expected = "a size in bytes, like 512M or 8G";
    std::string_view rest = text;
    double number = 0.0;
    if (!take_number(rest, number) || !(number >= 0.0)) refuse(text, expected);
    constexpr std::string_view kSuffixes = "KMGT";
    if (!rest.empty()) {
        const std::size_t power = kSuffixes.find(static_cast<char>(std::toupper(rest.front())));
        if (power == std::string_view::npos) refuse(text, expected);
        number *= std::exp2(10.0 * static_cast<double>(power + 1));
        rest.remove_prefix(1);
        if (!rest.empty() && rest != "B" && rest != "iB") refuse(text, expected);
    }
    if (number >= 0x1p63) refuse(text, expected);
    return static_cast<std::uint64_t>(number);
}

dvec3 parse_vec3(const std::string& text) {
    const auto n = parse_numbers<3>(text, "three numbers, like 1,-2,3.5");
    return {n[0], n[1], n[2]};
}

vec3 parse_color(const std::string& text) {
    const dvec3 color = parse_vec3(text);
    for (int i = 0; i < 3; ++i)
        if (color[i] < 0.0 || color[i] > kMaxFloat)
            refuse(text, "a color: three numbers of 0 or more");
    return vec3(color);
}

RayArgument parse_ray(const std::string& text) {
    const auto n = parse_numbers<6>(text, "six numbers: origin and direction");
    const RayArgument ray{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    if (ray.direction == dvec3(0.0)) refuse(text, "a ray: its direction is zero");
    return ray;
}

std::array<double, 2> parse_angles(const std::string& text) {
    auto angles = parse_numbers<2>(text, "two angles in degrees, like 135,40");
    for (double& angle : angles) angle *= kRadiansPerDegree;
    return angles;
}

double parse_number(const std::string& text) {
    return parse_numbers<1>(text, "a number")[0];
}

double parse_positive(const std::string& text) {
    const double number = parse_numbers<1>(text, "a number of 0 or more")[0];
    if (number < 0.0 || number > kMaxFloat) refuse(text, "a number of 0 or more");
    return number;
}

std::array<double, 2> parse_sides(const std::string& text) {
    const std::string expected = "width and height, like 2x0.5";
    std::string_view rest = text;
    std::array<double, 2> sides{};
    if (!take_number(rest, sides[0]) || rest.empty() || rest.front() != 'x') refuse(text, expected);
    rest.remove_prefix(1);
    if (!take_number(rest, sides[1]) || !rest.empty()) refuse(text, expected);
    for (const double side : sides)
        if (!(side > 0.0) || side > kMaxFloat) refuse(text, expected);
    return sides;
}

uvec2 parse_size(const std::string& text) {
    constexpr std::uint32_t kMax = 65536;
    const std::string expected = "a size in pixels, like 1280x720";
    std::string_view rest = text;
    uvec2 size{0};
    if (!take_number(rest, size.x) || rest.empty() || rest.front() != 'x') refuse(text, expected);
    rest.remove_prefix(1);
    if (!take_number(rest, size.y) || !rest.empty()) refuse(text, expected);
    if (size.x < 1 || size.y < 1 || size.x > kMax || size.y > kMax) refuse(text, expected);
    return size;
}

std::string decimal(double number) {
    char text[400];  // the largest has 309 digits
    const auto end = std::to_chars(text, text + sizeof text, number, std::chars_format::fixed).ptr;
    return {text, end};
}

void add_threads(CLI::App& command, int& threads, const std::string& description) {
    command.add_option("--threads", threads, description)->type_name("N")->check(within(0, 4096));
}

void add_force(CLI::App& command, bool& force, const std::string& description) {
    command.add_flag("-f,--force", force, description);
}

void add_quiet(CLI::App& command, bool& quiet) {
    command.add_flag("-q,--quiet", quiet, "Print errors only");
}

void add_rule(CLI::App& command, VoxelRule& rule) {
    add_parsed(command, "--rule", rule, parse_rule,
               "Which voxels a triangle marks: conservative (the default) or thin", "RULE");
}

CLI::Validator above_zero() {
    return numbers_that<double>([](double n) { return n > 0.0 && std::isfinite(n); }, "above 0");
}

CLI::Validator zero_or_more() {
    return numbers_that<double>([](double n) { return n >= 0.0 && std::isfinite(n); },
                                "of 0 or more");
}

}  // namespace octavo::cli
