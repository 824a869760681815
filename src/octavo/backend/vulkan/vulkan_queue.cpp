// SPDX-License-Identifier: MIT
#include "octavo/backend/vulkan/vulkan_queue.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <set>
#include <string>

#include "octavo/backend/vulkan/instance.h"
#include "octavo/backend/vulkan/memory.h"
#include "octavo/core/error.h"

namespace octavo::vulkan {
namespace {

/// Bytes of the block through which data goes to and from the device.
constexpr std::uint64_t kStagingBytes = 16ull << 20;

/// Room for the jobs of the passes that wait to be run.
constexpr std::uint64_t kJobBytes = 1ull << 20;

/// A page of a DAG: an index of it must stay positive as a signed number.
constexpr std::uint64_t kLargestPage = 1ull << 30;

constexpr std::uint64_t kMostGroups = 65535;  // in a dispatch, on every device

/// Seconds after which a pass is taken for one that never ends.
constexpr std::uint64_t kPatienceSeconds = 3600;

/// What a dispatch is told: `Launch` of pass.comp.
struct Launch {
    std::uint64_t job;
    std::uint32_t first;
    std::uint32_t threads;
};
static_assert(sizeof(Launch) == 16);

/// Owns the handles, so that a constructor that throws leaves nothing behind.
class Handles {
public:
    explicit Handles(const QueueOptions& options) : Handles(options.validation) {
        number = options.device >= 0 ? options.device : instance.best();
        if (number >= static_cast<int>(instance.devices().size()))
            throw Error(Errc::unsupported, "there is no Vulkan device " + std::to_string(number));
        info = instance.info(number);
        if (!info.unusable.empty())
            throw Error(Errc::unsupported, info.name + " cannot be used: " + info.unusable);
        physical = instance.devices()[static_cast<std::size_t>(number)];
        make_device();
    }
    ~Handles() {
        if (device == nullptr) return;
        f.vkDeviceWaitIdle(device);
        for (const auto& both : pipelines)
            for (const VkPipeline pipeline : both) f.vkDestroyPipeline(device, pipeline, nullptr);
        f.vkDestroyPipelineLayout(device, layout, nullptr);
        f.vkDestroyFence(device, fence, nullptr);
        f.vkDestroyCommandPool(device, pool, nullptr);
        if (memory) {
            for (Block* block : {&staging, &jobs})
                if (block->buffer != nullptr) memory->destroy(*block);
            memory.reset();
        }
        f.vkDestroyDevice(device, nullptr);
    }
    Handles(const Handles&) = delete;
    Handles& operator=(const Handles&) = delete;

    Instance instance;
    int number = 0;
    DeviceInfo info;
    VkPhysicalDevice physical = nullptr;
    VkDevice device = nullptr;
    DeviceFunctions f;
    VkQueue queue = nullptr;
    VkCommandPool pool = nullptr;
    VkCommandBuffer commands = nullptr;
    VkFence fence = nullptr;
    VkPipelineLayout layout = nullptr;
    std::array<std::array<VkPipeline, 2>, kPasses> pipelines{};  // without and with pages
    std::unique_ptr<Memory> memory;
    Block staging;
    Block jobs;

private:
    // When this one is done the destructor will run, whatever the other one throws.
    explicit Handles(bool validation) : instance(validation) {}

    void make_device() {
        const InstanceFunctions& i = instance.functions();
        const auto family = static_cast<std::uint32_t>(compute_family(i, physical));
        const float priority = 1.0f;
        VkDeviceQueueCreateInfo queue_info{};
        queue_info.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
        queue_info.queueFamilyIndex = family;
        queue_info.queueCount = 1;
        queue_info.pQueuePriorities = &priority;
        VkPhysicalDeviceVulkan12Features features{};
        features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
        features.bufferDeviceAddress = VK_TRUE;
        features.scalarBlockLayout = VK_TRUE;
        VkDeviceCreateInfo device_info{};
        device_info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
        device_info.pNext = &features;
        device_info.queueCreateInfoCount = 1;
        device_info.pQueueCreateInfos = &queue_info;
        check(i.vkCreateDevice(physical, &device_info, nullptr, &device), "opening " + info.name);
        f.load(i, device);
        f.vkGetDeviceQueue(device, family, 0, &queue);

        VkCommandPoolCreateInfo pool_info{};
        pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
        pool_info.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
        pool_info.queueFamilyIndex = family;
        check(f.vkCreateCommandPool(device, &pool_info, nullptr, &pool), "making a command pool");
        VkCommandBufferAllocateInfo commands_info{};
        commands_info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
        commands_info.commandPool = pool;
        commands_info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        commands_info.commandBufferCount = 1;
        check(f.vkAllocateCommandBuffers(device, &commands_info, &commands),
              "making a command buffer");
        VkFenceCreateInfo fence_info{};
        fence_info.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
        check(f.vkCreateFence(device, &fence_info, nullptr, &fence), "making a fence");
        VkPushConstantRange range{};
        range.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
        range.size = sizeof(Launch);
        VkPipelineLayoutCreateInfo layout_info{};
        layout_info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
        layout_info.pushConstantRangeCount = 1;
        layout_info.pPushConstantRanges = &range;
        check(f.vkCreatePipelineLayout(device, &layout_info, nullptr, &layout),
              "making a pipeline layout");

        VkPhysicalDeviceMemoryProperties properties{};
        i.vkGetPhysicalDeviceMemoryProperties(physical, &properties);
        memory = std::make_unique<Memory>(f, device, properties, largest_allocation(i, physical));
        staging = memory->make_mapped(kStagingBytes);
        jobs = memory->make_mapped(kJobBytes);
    }
};

class Queue final : public VulkanQueue {
public:
    explicit Queue(const QueueOptions& options) : h_(options) {
        std::uint64_t page =
            std::min(kLargestPage, largest_allocation(h_.instance.functions(), h_.physical));
        if (options.page_bytes != 0) page = std::min(page, options.page_bytes);
        page_bytes_ = std::bit_floor(page);
    }
    ~Queue() override {
        for (const std::uint64_t address : waiting_release_) h_.memory->release(address);
        // What DeviceArrays still hold goes with the memory.
    }

    [[nodiscard]] const DeviceInfo& info() const override { return h_.info; }
    [[nodiscard]] const std::vector<std::string>& messages() const override {
        return h_.instance.messages();
    }
    [[nodiscard]] std::size_t blocks() const override { return h_.memory->blocks(); }

    [[nodiscard]] std::uint64_t allocate(std::uint64_t bytes) override {
        return h_.memory->allocate(bytes);
    }

    void release(std::uint64_t address) noexcept override {
        // Passes that wait may still use it.
        if (recording_)
            waiting_release_.push_back(address);
        else
            h_.memory->release(address);
    }

    void write(std::uint64_t address, std::span<const std::byte> bytes) override {
        finish();
        for (std::uint64_t done = 0; done < bytes.size(); done += kStagingBytes) {
            const std::uint64_t some = std::min<std::uint64_t>(kStagingBytes, bytes.size() - done);
            std::memcpy(h_.staging.mapped, bytes.data() + done, some);
            const Block& block = h_.memory->block_of(address);
            copy(h_.staging.buffer, 0, block.buffer, address + done - block.address, some);
            finish();
        }
    }

    void read(std::uint64_t address, std::span<std::byte> bytes) override {
        for (std::uint64_t done = 0; done < bytes.size(); done += kStagingBytes) {
            const std::uint64_t some = std::min<std::uint64_t>(kStagingBytes, bytes.size() - done);
            const Block& block = h_.memory->block_of(address);
            copy(block.buffer, address + done - block.address, h_.staging.buffer, 0, some);
            finish();
            std::memcpy(bytes.data() + done, h_.staging.mapped, some);
        }
    }

    [[nodiscard]] shared::WordArray upload(std::span<const std::uint32_t> words) override {
        if (words.empty()) return {};
        const std::span<const std::byte> bytes = std::as_bytes(words);
        std::vector<std::uint64_t> pages;
        std::uint64_t table = 0;
        try {
            for (std::uint64_t at = 0; at < bytes.size(); at += page_bytes_) {
                const std::uint64_t some = std::min(page_bytes_, bytes.size() - at);
                pages.push_back(allocate(some));
                write(pages.back(), bytes.subspan(at, some));
            }
            if (pages.size() == 1)
                return {reinterpret_cast<const shared::uint*>(pages.front()), 0, 0};
            table = allocate(pages.size() * sizeof(std::uint64_t));
            write(table, std::as_bytes(std::span(pages)));
            paged_[table] = pages;
            return {reinterpret_cast<const shared::uint*>(table), page_shift(), 0};
        } catch (...) {
            for (const std::uint64_t page : pages) release(page);
            if (table != 0) release(table);
            throw;
        }
    }

    void release(const shared::WordArray& words) noexcept override {
        const auto address = reinterpret_cast<std::uint64_t>(words.at);
        if (address == 0) return;
        if (const auto paged = paged_.find(address); paged != paged_.end()) {
            for (const std::uint64_t page : paged->second) release(page);
            paged_.erase(paged);
        }
        release(address);
    }

    void run(Pass pass, const shared::RayJob& job, std::uint64_t threads) override {
        record(pass, job, threads);
    }
    void run(Pass pass, const shared::PixelJob& job, std::uint64_t threads) override {
        record(pass, job, threads);
    }

    void cut() override { finish(); }

    void finish() override {
        if (!recording_) return;
        recording_ = false;
        jobs_used_ = 0;
        check(h_.f.vkEndCommandBuffer(h_.commands), "recording commands");
        VkSubmitInfo submit{};
        submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
        submit.commandBufferCount = 1;
        submit.pCommandBuffers = &h_.commands;
        check(h_.f.vkQueueSubmit(h_.queue, 1, &submit, h_.fence), "running passes");
        const VkResult result = h_.f.vkWaitForFences(h_.device, 1, &h_.fence, VK_TRUE,
                                                     kPatienceSeconds * 1'000'000'000u);
        if (result == VK_TIMEOUT)
            throw Error(Errc::io, "Vulkan: the device has not answered for an hour");
        check(result, "running passes");
        check(h_.f.vkResetFences(h_.device, 1, &h_.fence), "running passes");
        for (const std::uint64_t address : waiting_release_) h_.memory->release(address);
        waiting_release_.clear();
    }

private:
    void begin() {
        if (recording_) return;
        VkCommandBufferBeginInfo info{};
        info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
        info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
        check(h_.f.vkBeginCommandBuffer(h_.commands, &info), "recording commands");
        recording_ = true;
    }

    /// Whatever comes next sees what came before; the host's reads and writes too.
    void barrier() {
        VkMemoryBarrier memory{};
        memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
        memory.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
        memory.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                               VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT |
                               VK_ACCESS_HOST_READ_BIT;
        const VkPipelineStageFlags device =
            VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
        h_.f.vkCmdPipelineBarrier(h_.commands, device, device | VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                                  &memory, 0, nullptr, 0, nullptr);
    }

    void copy(VkBuffer from, std::uint64_t from_offset, VkBuffer to, std::uint64_t to_offset,
              std::uint64_t bytes) {
        begin();
        const VkBufferCopy region{from_offset, to_offset, bytes};
        h_.f.vkCmdCopyBuffer(h_.commands, from, to, 1, &region);
        barrier();
    }

    template <typename Job>
    void record(Pass pass, const Job& job, std::uint64_t threads) {
        if (threads == 0) return;
        if (threads > std::numeric_limits<std::uint32_t>::max())
            throw Error(Errc::limit, "a pass has more than 2^32 threads");
        if (jobs_used_ + sizeof(Job) > kJobBytes) finish();
        const std::uint64_t job_offset = jobs_used_;
        std::memcpy(h_.jobs.mapped + job_offset, &job, sizeof(Job));
        jobs_used_ = (job_offset + sizeof(Job) + 255) / 256 * 256;

        const bool paged = paged_.contains(reinterpret_cast<std::uint64_t>(job.dag.words));
        const VkPipeline bound = pipeline(pass, paged);
        begin();
        h_.f.vkCmdBindPipeline(h_.commands, VK_PIPELINE_BIND_POINT_COMPUTE, bound);
        const std::uint64_t most = kMostGroups * kGroupThreads;
        for (std::uint64_t first = 0; first < threads; first += most) {
            const Launch launch{h_.jobs.address + job_offset, static_cast<std::uint32_t>(first),
                                static_cast<std::uint32_t>(threads)};
            h_.f.vkCmdPushConstants(h_.commands, h_.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                    sizeof(launch), &launch);
            const std::uint64_t some = std::min(most, threads - first);
            h_.f.vkCmdDispatch(
                h_.commands, static_cast<std::uint32_t>((some + kGroupThreads - 1) / kGroupThreads),
                1, 1);
        }
        barrier();
    }

    /// Words of a page, as a power of two.
    [[nodiscard]] std::int32_t page_shift() const {
        return std::countr_zero(page_bytes_ / sizeof(std::uint32_t));
    }

    VkPipeline pipeline(Pass pass, bool paged) {
        VkPipeline& made = h_.pipelines[static_cast<std::size_t>(pass)][paged ? 1 : 0];
        if (made != nullptr) return made;
        const std::span<const std::uint32_t> code = spirv(pass);
        VkShaderModuleCreateInfo module_info{};
        module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
        module_info.codeSize = code.size_bytes();
        module_info.pCode = code.data();
        VkShaderModule module = nullptr;
        check(h_.f.vkCreateShaderModule(h_.device, &module_info, nullptr, &module),
              "loading a shader");
        const std::int32_t shift = paged ? page_shift() : 0;
        const VkSpecializationMapEntry entry{0, 0, sizeof(shift)};
        const VkSpecializationInfo constants{1, &entry, sizeof(shift), &shift};
        VkComputePipelineCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
        info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
        info.stage.module = module;
        info.stage.pName = "main";
        info.stage.pSpecializationInfo = &constants;
        info.layout = h_.layout;
        const VkResult result =
            h_.f.vkCreateComputePipelines(h_.device, nullptr, 1, &info, nullptr, &made);
        h_.f.vkDestroyShaderModule(h_.device, module, nullptr);
        check(result, "compiling a shader");
        return made;
    }

    Handles h_;
    std::uint64_t page_bytes_ = 0;
    bool recording_ = false;
    std::uint64_t jobs_used_ = 0;
    std::vector<std::uint64_t> waiting_release_;
    std::map<std::uint64_t, std::vector<std::uint64_t>> paged_;  // table -> its pages
};

}  // namespace

std::unique_ptr<VulkanQueue> open_queue(const QueueOptions& options) {
    return std::make_unique<Queue>(options);
}

}  // namespace octavo::vulkan
