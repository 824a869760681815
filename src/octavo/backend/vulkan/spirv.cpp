// SPDX-License-Identifier: MIT
#include "octavo/backend/vulkan/vulkan_queue.h"

namespace octavo::vulkan {
namespace {

// Written by glslc at build time.
constexpr std::uint32_t kClosest[] =
#include "closest.inc"
    ;
constexpr std::uint32_t kAny[] =
#include "any.inc"
    ;
constexpr std::uint32_t kBeam[] =
#include "beam.inc"
    ;
constexpr std::uint32_t kPrimary[] =
#include "primary.inc"
    ;
constexpr std::uint32_t kSurface[] =
#include "surface.inc"
    ;
constexpr std::uint32_t kGbuffer[] =
#include "gbuffer.inc"
    ;
constexpr std::uint32_t kSky[] =
#include "sky.inc"
    ;
constexpr std::uint32_t kLampBeam[] =
#include "lamp_beam.inc"
    ;
constexpr std::uint32_t kLamp[] =
#include "lamp.inc"
    ;
constexpr std::uint32_t kLight[] =
#include "light.inc"
    ;
constexpr std::uint32_t kShade[] =
#include "shade.inc"
    ;
constexpr std::uint32_t kAmbientOut[] =
#include "ambient_out.inc"
    ;
constexpr std::uint32_t kShadowOut[] =
#include "shadow_out.inc"
    ;
constexpr std::uint32_t kLooks[] =
#include "looks.inc"
    ;
constexpr std::uint32_t kCached[] =
#include "cached.inc"
    ;
constexpr std::uint32_t kGbufferLooks[] =
#include "gbuffer_looks.inc"
    ;

}  // namespace

std::span<const std::uint32_t> spirv(Pass pass) {
    switch (pass) {
        case Pass::closest:
            return kClosest;
        case Pass::any:
            return kAny;
        case Pass::beam:
            return kBeam;
        case Pass::primary:
            return kPrimary;
        case Pass::surface:
            return kSurface;
        case Pass::gbuffer:
            return kGbuffer;
        case Pass::sky:
            return kSky;
        case Pass::shade:
            return kShade;
        case Pass::ambient_out:
            return kAmbientOut;
        case Pass::lamp_beam:
            return kLampBeam;
        case Pass::lamp:
            return kLamp;
        case Pass::light:
            return kLight;
        case Pass::shadow_out:
            return kShadowOut;
        case Pass::looks:
            return kLooks;
        case Pass::cached:
            return kCached;
        case Pass::gbuffer_looks:
            return kGbufferLooks;
    }
    return {};
}

}  // namespace octavo::vulkan
