// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "octavo/backend/device.h"

namespace octavo {

/// This machine's processor, as a device.
[[nodiscard]] DeviceInfo cpu_info();
[[nodiscard]] std::unique_ptr<Device> make_cpu_device();

}  // namespace octavo
