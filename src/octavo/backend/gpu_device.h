// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "octavo/backend/device.h"
#include "octavo/backend/pass_queue.h"

namespace octavo {

/// A device that runs the passes of a queue.
[[nodiscard]] std::unique_ptr<Device> make_gpu_device(std::unique_ptr<PassQueue> queue);

}  // namespace octavo
