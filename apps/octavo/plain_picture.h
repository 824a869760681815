// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "octavo/io/model.h"
#include "octavo/mesh/scene.h"

namespace octavo::cli {

/// What a picture without light shows of each pixel's cell: the viewer's modes of the same names.
enum class PlainMode { normals, levels, steps, color };

struct PlainOptions {
    PlainMode mode = PlainMode::normals;
    int width = 0;
    int height = 0;
    Camera camera;
    dvec3 up{0.0, 1.0, 0.0};
    int samples = 1;      // jittered inside the pixel as those of octavo::render()
    bool smooth = false;  // normals
    int level = 17;       // of the finest cells that are shown
    double detail = 0.0;  // pixels that a cell may be small
};

/// Draws on the processor: devices do not count the cells that a ray visits.
///
/// @param go_on  asked now and then, by any thread; where it says no, the picture is not finished
/// @return       width * height pixels of sRGB, 3 bytes each; empty where go_on said no
[[nodiscard]] std::vector<std::uint8_t> plain_picture(const Model& model,
                                                      const PlainOptions& options,
                                                      const std::function<bool()>& go_on);

}  // namespace octavo::cli
