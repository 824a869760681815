// SPDX-License-Identifier: MIT
#pragma once

/// The per-pixel effects of the shared text, for C++.
#include "octavo/light/point_text.h"

#include "octavo/render/ambient_occlusion.h"
#include "octavo/render/camera_ray.h"

#include "octavo/render/plain_view.h"
