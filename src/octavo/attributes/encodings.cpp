// SPDX-License-Identifier: MIT
#include "octavo/attributes/encodings.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace octavo {
namespace {

double linear_from_srgb(double s) {
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

// RGB9E5 as the OpenGL 4.6 specification, section 8.25, has it.
constexpr int kMantissaBits = 9;
constexpr int kExponentBias = 15;
constexpr float kGreatest = 65408.0f;  // 511/512 * 2^16

/// Unfolds the octahedron |x| + |y| + |z| = 1: its upper half is a square in the middle of the
/// square from -1 to 1, its lower half the four corners.
glm::vec2 unfold(const vec3& direction) {
    const float sum = std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
    if (!(sum > 0.0f) || !std::isfinite(sum)) return {0.0f, 0.0f};
    const vec2 p(direction.x / sum, direction.y / sum);
    if (direction.z >= 0.0f) return p;
    return {std::copysign(1.0f - std::abs(p.y), p.x), std::copysign(1.0f - std::abs(p.x), p.y)};
}

vec3 fold(const vec2& p) {
    vec3 d(p.x, p.y, 1.0f - std::abs(p.x) - std::abs(p.y));
    if (d.z < 0.0f) {
        d.x = std::copysign(1.0f - std::abs(p.y), p.x);
        d.y = std::copysign(1.0f - std::abs(p.x), p.y);
    }
    return glm::normalize(d);
}

/// An even number of steps, so that the axes are hit exactly.
std::uint32_t step_of(float x, std::uint32_t steps) {
    const float scaled = std::round((x + 1.0f) * 0.5f * static_cast<float>(steps));
    return static_cast<std::uint32_t>(std::clamp(scaled, 0.0f, static_cast<float>(steps)));
}
float place_of(std::uint32_t step, std::uint32_t steps) {
    return 2.0f * static_cast<float>(step) / static_cast<float>(steps) - 1.0f;
}

constexpr std::uint32_t kFineSteps = 4094, kCoarseSteps = 10;

}  // namespace

float linear_from_srgb8(std::uint8_t channel) {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> t{};
        for (std::size_t i = 0; i < t.size(); ++i)
            t[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255.0));
        return t;
    }();
    return table[channel];
}

std::span<const std::uint8_t> srgb8_of_linear16() {
    static const std::vector<std::uint8_t> table = [] {
        std::vector<std::uint8_t> t(65536);
        std::size_t i = 0;
        for (int s = 0; s < 256; ++s) {
            const double half_way = linear_from_srgb((s + 0.5) / 255.0) * 65535.0;
            for (; i < t.size() && (s == 255 || static_cast<double>(i) < half_way); ++i)
                t[i] = static_cast<std::uint8_t>(s);
        }
        return t;
    }();
    return table;
}

std::uint8_t srgb8_from_linear16(std::uint32_t linear) {
    return srgb8_of_linear16()[std::min(linear, 65535u)];
}

std::uint32_t pack_rgb9e5(const vec3& color) {
    const auto clamped = [](float x) { return x > 0.0f ? std::min(x, kGreatest) : 0.0f; };
    const vec3 c(clamped(color.r), clamped(color.g), clamped(color.b));
    const float largest = std::max({c.r, c.g, c.b});
    if (largest == 0.0f) return 0;
    int exponent = std::max(-kExponentBias - 1, std::ilogb(largest)) + 1 + kExponentBias;
    // Rounding may take the largest to 2^9: then it needs the next exponent.
    const auto scale = [](int e) { return std::ldexp(1.0f, kMantissaBits + kExponentBias - e); };
    if (std::floor(largest * scale(exponent) + 0.5f) >= 512.0f) ++exponent;
    const auto mantissa = [&](float x) {
        return static_cast<std::uint32_t>(std::floor(x * scale(exponent) + 0.5f));
    };
    const std::uint32_t bits = mantissa(c.r) | mantissa(c.g) << 9 | mantissa(c.b) << 18;
    return bits == 0 ? 0 : bits | static_cast<std::uint32_t>(exponent) << 27;
}

vec3 unpack_rgb9e5(std::uint32_t value) {
    // 2^(exponent - bias - mantissa bits), as a float's bits: always a normal one.
    const float scale =
        std::bit_cast<float>(((value >> 27) + 127 - kExponentBias - kMantissaBits) << 23);
    return vec3(static_cast<float>(value & 511u), static_cast<float>(value >> 9 & 511u),
                static_cast<float>(value >> 18 & 511u)) *
           scale;
}

std::uint32_t pack_normal(const vec3& direction) {
    const vec2 p = unfold(direction);
    return step_of(p.x, kFineSteps) | step_of(p.y, kFineSteps) << 12;
}

vec3 unpack_normal(std::uint32_t value) {
    return fold({place_of(value & 4095u, kFineSteps), place_of(value >> 12 & 4095u, kFineSteps)});
}

std::uint32_t pack_coarse_direction(const vec3& direction) {
    const vec2 p = unfold(direction);
    return step_of(p.x, kCoarseSteps) + (kCoarseSteps + 1) * step_of(p.y, kCoarseSteps);
}

vec3 unpack_coarse_direction(std::uint32_t value) {
    return fold({place_of(value % (kCoarseSteps + 1), kCoarseSteps),
                 place_of(value / (kCoarseSteps + 1) % (kCoarseSteps + 1), kCoarseSteps)});
}

}  // namespace octavo
