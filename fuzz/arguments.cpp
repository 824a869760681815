// SPDX-License-Identifier: MIT
#include "../apps/octavo/arguments.h"

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

}  // namespace

void run_arguments(Bytes bytes) {
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    try_parse(text, cli::parse_resolution, [](int depth) { return depth >= 2 && depth <= 17; });
    try_parse(text, cli::parse_bytes, [](std::uint64_t size) { return size < 1ull << 63; });
    try_parse(text, cli::parse_vec3, finite);
    try_parse(text, cli::parse_ray, [](const cli::RayArgument& ray) {
        return finite(ray.origin) && finite(ray.direction) && ray.direction != dvec3(0.0);
    });
    try_parse(text, cli::parse_size, [](const uvec2& size) {
        return size.x >= 1 && size.y >= 1 && size.x <= 65536 && size.y <= 65536;
    });
}

}  // namespace octavo::fuzz
