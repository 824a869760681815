// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "octavo/core/box.h"
#include "octavo/mesh/scene.h"

/// How the command line writes lights:
///
///     sun:AZIMUTH,ELEVATION                degrees from +z towards +x, and above the horizon
///     point:X,Y,Z
///     spot:X,Y,Z:to=X,Y,Z:angle=DEGREES    half its cone; 30
///     disc:X,Y,Z:to=X,Y,Z:size=RADIUS      shines towards a point
///     rectangle:X,Y,Z:to=X,Y,Z:size=WxH    W across, H upwards, or away where it looks up or down
///     scene, scene=NAME                    all lights of the file, or those of a name
///     none                                 no light but the sky
///
/// and behind any but the last two:
///
///     :size=RADIUS     sun: degrees, 1.15; lamps: world units; 0: hard shadows
///     :color=R,G,B     linear, of any brightness; white
///     :power=FACTOR    1: as bright in the middle of the scene as the default sun
namespace octavo::cli {

struct LightArgument {
    enum class From { argument, file, nowhere };

    From from = From::argument;
    std::string name{};  // file: of its lights; empty: all
    Light light{};       // argument: of a brightness of 1
    double power = 1.0;  // argument
};

/// @param up      which way is up, for the sun and for rectangles
/// @throws Error  bad_argument, saying what was expected
[[nodiscard]] LightArgument parse_light(const std::string& text, const dvec3& up);

/// The sun of a LightArgument at this azimuth and elevation, radians.
[[nodiscard]] Light unit_sun(const std::array<double, 2>& angles, const dvec3& up);

/// The lights that the arguments describe, in a scene that has some of its own.
///
/// @param lit     what there is to light, world space
/// @throws Error  bad_argument where the file has no light of a name
[[nodiscard]] std::vector<Light> chosen_lights(const std::vector<LightArgument>& arguments,
                                               const std::vector<Light>& of_file, const Box& lit);

/// The file's lights, as bright as they should be: files measure light in lux, candela, watts or
/// nothing at all, and the sky here has none of these. All are scaled alike: the brightest sun down
/// to the default sun's brightness; where there is no sun, so that together they are as bright in
/// the middle of the scene as that. Suns without a size get that of the default sun.
[[nodiscard]] std::vector<Light> balanced(std::vector<Light> of_file, const Box& lit);

}  // namespace octavo::cli
