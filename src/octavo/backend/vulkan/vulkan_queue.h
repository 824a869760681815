// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "octavo/backend/pass_queue.h"

namespace octavo::vulkan {

struct QueueOptions {
    int device = -1;  // of list(); -1: the best

    /// At most this much of a DAG in one piece of memory, larger ones in pages: the device's limit,
    /// or, for tests, less. A power of two; 0: the device's.
    std::uint64_t page_bytes = 0;

    bool validation = false;  // VK_LAYER_KHRONOS_validation; its messages: see messages()
};

/// All Vulkan devices, the unusable ones too. @throws Error unsupported where there is no Vulkan
[[nodiscard]] std::vector<DeviceInfo> list();

/// Is the validation layer installed?
[[nodiscard]] bool has_validation_layer();

/// A pass's SPIR-V, as it is compiled into the library.
[[nodiscard]] std::span<const std::uint32_t> spirv(Pass pass);

/// A compute queue of one Vulkan 1.2 device.
///
/// Needs of the device no more than bufferDeviceAddress and scalarBlockLayout. Memory is taken from
/// it in blocks of 64 MiB or more, and handed out from there; what goes to and from the host passes
/// through a block that both see.
class VulkanQueue : public PassQueue {
public:
    /// What the validation layers have said.
    [[nodiscard]] virtual const std::vector<std::string>& messages() const = 0;

    /// Blocks of device memory that are held at present.
    [[nodiscard]] virtual std::size_t blocks() const = 0;
};

/// @throws Error unsupported where there is no such device or it lacks a feature
[[nodiscard]] std::unique_ptr<VulkanQueue> open_queue(const QueueOptions& options = {});

}  // namespace octavo::vulkan
