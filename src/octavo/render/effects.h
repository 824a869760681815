// SPDX-License-Identifier: MIT
#pragma once

/// The per-pixel effects of the shared text, for C++.
#include "octavo/trace/dag_view.h"

#include "octavo/render/sampling.h"

#include "octavo/render/ambient_occlusion.h"
#include "octavo/render/camera_ray.h"
#include "octavo/render/shade.h"
#include "octavo/render/shadow.h"
#include "octavo/render/surface.h"

#include "octavo/render/smooth_normal.h"
