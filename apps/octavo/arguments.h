// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "octavo/core/error.h"
#include "octavo/core/vec.h"
#include "octavo/voxelize/rule.h"

/// How the command line writes numbers. All throw Error bad_argument, saying what was expected.
namespace octavo::cli {

/// "4096", "4K" or "4k" -> 12. @return the depth, 2 to 17
[[nodiscard]] int parse_resolution(const std::string& text);

/// "conservative" or "thin"
[[nodiscard]] VoxelRule parse_rule(const std::string& text);

/// "1500000", "512M", "8G", "1.5G": suffixes K, M, G, T of 1024, with an optional "B" or "iB".
[[nodiscard]] std::uint64_t parse_bytes(const std::string& text);

/// "1,-2,3.5"
[[nodiscard]] dvec3 parse_vec3(const std::string& text);

/// "1,0.5,0": of any brightness, as floats hold it
[[nodiscard]] vec3 parse_color(const std::string& text);

struct RayArgument {
    dvec3 origin;
    dvec3 direction;  // not zero
};
/// "ox,oy,oz,dx,dy,dz"
[[nodiscard]] RayArgument parse_ray(const std::string& text);

/// "azimuth,elevation" in degrees. @return radians
[[nodiscard]] std::array<double, 2> parse_angles(const std::string& text);

/// "-12.5"
[[nodiscard]] double parse_number(const std::string& text);

/// A number of 0 or more, as floats hold it: "0.5"
[[nodiscard]] double parse_positive(const std::string& text);

/// "2x0.5": width and height, each above 0
[[nodiscard]] std::array<double, 2> parse_sides(const std::string& text);

/// "1280x720", each 1 to 65536
[[nodiscard]] uvec2 parse_size(const std::string& text);

/// A number without an exponent: "0.01", "1000000".
[[nodiscard]] std::string decimal(double number);

inline constexpr const char* kTrustedHelp =
    "Map the file and check nothing: only for files that you wrote";

/// A validator for numbers that `is_good` takes, which does not show in the help. What is not a
/// number at all, "nan" among it, is never good.
/// @param expected  "above 0": what to write instead
template <typename Number, typename IsGood>
[[nodiscard]] CLI::Validator numbers_that(IsGood is_good, const std::string& expected) {
    const auto check = [is_good, expected](const std::string& text) {
        Number number{};
        const bool good = CLI::detail::lexical_cast(text, number) && is_good(number);
        return good ? std::string() : "'" + text + "' is not a number " + expected;
    };
    return CLI::Validator(check, "");
}

template <typename Number>
[[nodiscard]] CLI::Validator within(Number low, Number high) {
    // Not !(number < low || number > high): NaN is neither.
    return numbers_that<Number>([=](Number n) { return n >= low && n <= high; },
                                "from " + decimal(low) + " to " + decimal(high));
}

/// Finite ones.
[[nodiscard]] CLI::Validator above_zero();
[[nodiscard]] CLI::Validator zero_or_more();

/// --threads, with 0 for all of them.
void add_threads(CLI::App& command, int& threads,
                 const std::string& description = "Threads to use; 0: all");
/// -f,--force
void add_force(CLI::App& command, bool& force,
               const std::string& description = "Replace the file where it exists");
/// -q,--quiet
void add_quiet(CLI::App& command, bool& quiet);
/// --rule
void add_rule(CLI::App& command, VoxelRule& rule);

/// Adds an option whose text goes through `parse`; errors then name the option.
template <typename Value, typename Parse>
CLI::Option* add_parsed(CLI::App& command, const std::string& name, Value& value, Parse parse,
                        const std::string& description, const std::string& type) {
    const auto assign = [&value, parse, name](const std::string& text) {
        try {
            value = parse(text);
        } catch (const Error& error) {
            throw Error(Errc::bad_argument, name + ": " + error.what());
        }
    };
    return command.add_option_function<std::string>(name, assign, description)->type_name(type);
}

}  // namespace octavo::cli
