// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "octavo/backend/pass_queue.h"

struct CUstream_st;

namespace octavo::cuda {

/// All CUDA devices. @throws Error unsupported where there is no driver or no device
[[nodiscard]] std::vector<DeviceInfo> list();

/// A stream of a CUDA device.
///
/// @param device   of list(); -1: the first
/// @param stream   the caller's, of that device, which must outlive the queue; null: one of its own
/// @throws Error   unsupported where there is no such device
[[nodiscard]] std::unique_ptr<PassQueue> open_queue(int device = -1, CUstream_st* stream = nullptr);

/// @throws Error  where a CUDA call failed, `error` being its cudaError_t: limit where memory is
/// used up, unsupported where there is no device or driver, else io
void check(int error, const std::string& doing);

}  // namespace octavo::cuda
