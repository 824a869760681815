// SPDX-License-Identifier: MIT
#include "octavo/backend/vulkan/memory.h"

#include <algorithm>
#include <string>

#include "octavo/core/error.h"

namespace octavo::vulkan {

Memory::~Memory() {
    for (auto& [address, shared] : shared_) destroy(shared->block);
}

std::uint64_t Memory::allocate(std::uint64_t bytes) {
    if (bytes <= kBlockBytes / 2)
        for (auto& [address, shared] : shared_)
            if (const auto offset = shared->parts.take(bytes, kAlignment)) return address + *offset;
    const std::uint64_t size =
        bytes > kBlockBytes / 2 ? (bytes + kAlignment - 1) / kAlignment * kAlignment : kBlockBytes;
    Block block = make_block(size, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
    auto shared = std::make_unique<SharedBlock>(SharedBlock{block, FreeList(size)});
    const std::uint64_t address = block.address + *shared->parts.take(bytes, kAlignment);
    shared_[block.address] = std::move(shared);
    return address;
}

const Block& Memory::block_of(std::uint64_t address) const {
    return std::prev(shared_.upper_bound(address))->second->block;
}

void Memory::release(std::uint64_t address) {
    const auto found = std::prev(shared_.upper_bound(address));
    found->second->parts.give_back(address - found->first);
    if (!found->second->parts.all_free()) return;
    destroy(found->second->block);
    shared_.erase(found);
}

Block Memory::make_mapped(std::uint64_t bytes) {
    constexpr VkMemoryPropertyFlags kSeen =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    Block block = make_block(bytes, kSeen | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, kSeen);
    void* mapped = nullptr;
    const VkResult result = f_.vkMapMemory(device_, block.memory, 0, VK_WHOLE_SIZE, 0, &mapped);
    if (result != VK_SUCCESS) {
        destroy(block);
        check(result, "mapping memory");
    }
    block.mapped = static_cast<std::byte*>(mapped);
    return block;
}

void Memory::destroy(Block& block) {
    f_.vkDestroyBuffer(device_, block.buffer, nullptr);
    f_.vkFreeMemory(device_, block.memory, nullptr);
    block = {};
}

Block Memory::make_block(std::uint64_t bytes, VkMemoryPropertyFlags wanted,
                         VkMemoryPropertyFlags needed) {
    Block block;
    block.bytes = bytes;
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = bytes;
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    const std::string what = "taking " + std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB";
    if (bytes > largest_)
        throw Error(Errc::limit, "Vulkan: " + what + " at once is more than the device's " +
                                     std::to_string(largest_ >> 20) + " MiB");
    check(f_.vkCreateBuffer(device_, &info, nullptr, &block.buffer), what);

    VkMemoryRequirements requirements{};
    f_.vkGetBufferMemoryRequirements(device_, block.buffer, &requirements);
    VkMemoryAllocateFlagsInfo flags{};
    flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
    flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
    VkMemoryAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocate.pNext = &flags;
    allocate.allocationSize = requirements.size;

    // The types with all that is wanted first, then those with what is needed.
    VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
    for (const VkMemoryPropertyFlags properties : {wanted, needed}) {
        for (std::uint32_t i = 0; i < properties_.memoryTypeCount; ++i) {
            if (!(requirements.memoryTypeBits >> i & 1u) ||
                (properties_.memoryTypes[i].propertyFlags & properties) != properties)
                continue;
            if (bytes > properties_.memoryHeaps[properties_.memoryTypes[i].heapIndex].size)
                continue;
            allocate.memoryTypeIndex = i;
            result = f_.vkAllocateMemory(device_, &allocate, nullptr, &block.memory);
            if (result == VK_SUCCESS) break;
        }
        if (result == VK_SUCCESS) break;
    }
    if (result == VK_SUCCESS)
        result = f_.vkBindBufferMemory(device_, block.buffer, block.memory, 0);
    if (result != VK_SUCCESS) {
        destroy(block);
        check(result, what);
    }
    VkBufferDeviceAddressInfo address{};
    address.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO;
    address.buffer = block.buffer;
    block.address = f_.vkGetBufferDeviceAddress(device_, &address);
    return block;
}

}  // namespace octavo::vulkan
