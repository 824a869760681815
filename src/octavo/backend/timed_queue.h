// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "octavo/backend/device.h"
#include "octavo/backend/pass_queue.h"

namespace octavo {

/// A queue that waits for each pass, and adds the seconds that it took to `times`, which outlives
/// it.
[[nodiscard]] std::unique_ptr<PassQueue> make_timed_queue(std::unique_ptr<PassQueue> queue,
                                                          PassTimes& times);

}  // namespace octavo
