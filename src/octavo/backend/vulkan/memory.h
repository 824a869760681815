// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

#include "octavo/backend/vulkan/free_list.h"
#include "octavo/backend/vulkan/loader.h"

namespace octavo::vulkan {

/// A buffer with memory of its own.
struct Block {
    VkBuffer buffer = nullptr;
    VkDeviceMemory memory = nullptr;
    std::uint64_t address = 0;
    std::uint64_t bytes = 0;
    std::byte* mapped = nullptr;  // of blocks that the host sees
};

/// Device memory by address. Blocks of 64 MiB are shared; what is larger than half of one has its
/// own. A block that is empty is given back to the driver.
class Memory {
public:
    static constexpr std::uint64_t kBlockBytes = 64ull << 20;
    static constexpr std::uint64_t kAlignment = 256;

    Memory(const DeviceFunctions& functions, VkDevice device,
           const VkPhysicalDeviceMemoryProperties& properties, std::uint64_t largest)
        : f_(functions), device_(device), properties_(properties), largest_(largest) {}
    ~Memory();
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    /// @throws Error limit where the device has no such memory left
    [[nodiscard]] std::uint64_t allocate(std::uint64_t bytes);
    void release(std::uint64_t address);

    /// The buffer that an address lies in.
    [[nodiscard]] const Block& block_of(std::uint64_t address) const;

    /// A buffer that the host sees all the time; the caller destroys it.
    [[nodiscard]] Block make_mapped(std::uint64_t bytes);
    void destroy(Block& block);

    [[nodiscard]] std::size_t blocks() const { return shared_.size(); }

private:
    struct SharedBlock {
        Block block;
        FreeList parts;
    };
    [[nodiscard]] Block make_block(std::uint64_t bytes, VkMemoryPropertyFlags wanted,
                                   VkMemoryPropertyFlags needed);

    const DeviceFunctions& f_;
    VkDevice device_;
    const VkPhysicalDeviceMemoryProperties properties_;
    const std::uint64_t largest_;                                   // bytes that one block may have
    std::map<std::uint64_t, std::unique_ptr<SharedBlock>> shared_;  // by address
};

}  // namespace octavo::vulkan
