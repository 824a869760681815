// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "octavo/light/cell_views.h"
#include "octavo/light/sky.h"
#include "octavo/render/effects.h"

#include "octavo/backend/passes.h"

struct CUstream_st;

namespace octavo {
enum class Pass;
}

/// The launches that nvcc compiles. Errors are cudaError_t, 0 for none.
namespace octavo::cuda {

[[nodiscard]] int launch(Pass pass, const shared::RayJob& job, std::uint32_t threads,
                         CUstream_st* stream);
[[nodiscard]] int launch(Pass pass, const shared::PixelJob& job, std::uint32_t threads,
                         CUstream_st* stream);

}  // namespace octavo::cuda
