// SPDX-License-Identifier: MIT
//
// The least that a Vulkan renderer needs to trace rays against a DAG: the DAG's words in a storage
// buffer, and a shader of its own that includes Octavo's. Prints the shadows on a ground plane.
#include <octavo/octavo.h>
#include <vulkan/vulkan.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace {

constexpr std::uint32_t kShader[] =
#include "shadow.inc"
    ;
constexpr std::uint32_t kSide = 48;  // points along the ground plane

void check(VkResult result) {
    if (result != VK_SUCCESS) throw std::runtime_error("Vulkan: error " + std::to_string(result));
}

/// What an engine has already: a device, a queue, and buffers that the host sees.
struct Engine {
    VkInstance instance{};
    VkPhysicalDevice physical{};
    VkDevice device{};
    VkQueue queue{};

    Engine() {
        VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO};
        application.apiVersion = VK_API_VERSION_1_2;
        VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
        info.pApplicationInfo = &application;
        check(vkCreateInstance(&info, nullptr, &instance));
        std::uint32_t count = 1;
        if (vkEnumeratePhysicalDevices(instance, &count, &physical) < 0 || count == 0)
            throw std::runtime_error("there is no Vulkan device");
        const float priority = 1.0f;
        VkDeviceQueueCreateInfo queue_info{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
        queue_info.queueCount = 1;
        queue_info.pQueuePriorities = &priority;
        VkDeviceCreateInfo device_info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
        device_info.queueCreateInfoCount = 1;
        device_info.pQueueCreateInfos = &queue_info;
        check(vkCreateDevice(physical, &device_info, nullptr, &device));
        vkGetDeviceQueue(device, 0, 0, &queue);
    }
};

struct Buffer {
    VkBuffer buffer{};
    void* mapped{};

    Buffer(const Engine& e, std::size_t bytes) {
        VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
        info.size = bytes;
        info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
        check(vkCreateBuffer(e.device, &info, nullptr, &buffer));
        VkMemoryRequirements needs;
        vkGetBufferMemoryRequirements(e.device, buffer, &needs);
        VkPhysicalDeviceMemoryProperties types;
        vkGetPhysicalDeviceMemoryProperties(e.physical, &types);
        constexpr VkMemoryPropertyFlags kSeen =
            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        VkMemoryAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
        allocate.allocationSize = needs.size;
        while (!(needs.memoryTypeBits >> allocate.memoryTypeIndex & 1u) ||
               (types.memoryTypes[allocate.memoryTypeIndex].propertyFlags & kSeen) != kSeen)
            ++allocate.memoryTypeIndex;
        VkDeviceMemory memory;
        check(vkAllocateMemory(e.device, &allocate, nullptr, &memory));
        check(vkBindBufferMemory(e.device, buffer, memory, 0));
        check(vkMapMemory(e.device, memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    }
};

/// The members of the shader's push constants.
struct Constants {
    octavo::vec4 to_sun;
    std::int32_t depth;
    std::uint32_t points;
};

void run(const Engine& e, const std::array<Buffer, 3>& buffers, const Constants& constants) {
    std::array<VkDescriptorSetLayoutBinding, 3> bindings{};
    for (std::uint32_t i = 0; i < 3; ++i)
        bindings[i] = {i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT,
                       nullptr};
    VkDescriptorSetLayoutCreateInfo set_info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_info.bindingCount = 3;
    set_info.pBindings = bindings.data();
    VkDescriptorSetLayout set_layout;
    check(vkCreateDescriptorSetLayout(e.device, &set_info, nullptr, &set_layout));
    const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(Constants)};
    VkPipelineLayoutCreateInfo layout_info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout_info.setLayoutCount = 1;
    layout_info.pSetLayouts = &set_layout;
    layout_info.pushConstantRangeCount = 1;
    layout_info.pPushConstantRanges = &range;
    VkPipelineLayout layout;
    check(vkCreatePipelineLayout(e.device, &layout_info, nullptr, &layout));
    VkShaderModuleCreateInfo module_info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    module_info.codeSize = sizeof(kShader);
    module_info.pCode = kShader;
    VkComputePipelineCreateInfo pipeline_info{.sType =
                                                  VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    pipeline_info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    pipeline_info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    check(vkCreateShaderModule(e.device, &module_info, nullptr, &pipeline_info.stage.module));
    pipeline_info.stage.pName = "main";
    pipeline_info.layout = layout;
    VkPipeline pipeline;
    check(vkCreateComputePipelines(e.device, nullptr, 1, &pipeline_info, nullptr, &pipeline));

    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 3};
    VkDescriptorPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool_info.maxSets = 1;
    pool_info.poolSizeCount = 1;
    pool_info.pPoolSizes = &size;
    VkDescriptorPool pool;
    check(vkCreateDescriptorPool(e.device, &pool_info, nullptr, &pool));
    VkDescriptorSetAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    allocate.descriptorPool = pool;
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &set_layout;
    VkDescriptorSet set;
    check(vkAllocateDescriptorSets(e.device, &allocate, &set));
    for (std::uint32_t i = 0; i < 3; ++i) {
        const VkDescriptorBufferInfo whole{buffers[i].buffer, 0, VK_WHOLE_SIZE};
        VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set;
        write.dstBinding = i;
        write.descriptorCount = 1;
        write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        write.pBufferInfo = &whole;
        vkUpdateDescriptorSets(e.device, 1, &write, 0, nullptr);
    }

    VkCommandPoolCreateInfo commands_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandPool command_pool;
    check(vkCreateCommandPool(e.device, &commands_info, nullptr, &command_pool));
    VkCommandBufferAllocateInfo buffer_info{.sType =
                                                VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    buffer_info.commandPool = command_pool;
    buffer_info.commandBufferCount = 1;
    VkCommandBuffer commands;
    check(vkAllocateCommandBuffers(e.device, &buffer_info, &commands));
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    check(vkBeginCommandBuffer(commands, &begin));
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &set, 0,
                            nullptr);
    vkCmdPushConstants(commands, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(Constants),
                       &constants);
    vkCmdDispatch(commands, (constants.points + 63) / 64, 1, 1);
    check(vkEndCommandBuffer(commands));
    VkSubmitInfo submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    check(vkQueueSubmit(e.queue, 1, &submit, nullptr));
    check(vkDeviceWaitIdle(e.device));
}

}  // namespace

int main() try {
    const octavo::BuildResult model = octavo::build(octavo::make_sample("courtyard"), {.depth = 9});
    const auto words = model.dag.words();

    const Engine engine;  // its objects live as long as the program
    const std::array<Buffer, 3> buffers{Buffer(engine, words.size_bytes()),
                                        Buffer(engine, kSide * kSide * sizeof(octavo::vec4)),
                                        Buffer(engine, kSide * kSide * sizeof(std::uint32_t))};
    std::memcpy(buffers[0].mapped, words.data(), words.size_bytes());
    auto* points = static_cast<octavo::vec4*>(buffers[1].mapped);
    const float resolution = static_cast<float>(model.grid.resolution());
    const auto middle = [&](std::uint32_t square) {
        return resolution * (static_cast<float>(square) + 0.5f) / kSide;
    };
    for (std::uint32_t z = 0; z < kSide; ++z)
        for (std::uint32_t x = 0; x < kSide; ++x)
            points[z * kSide + x] = {middle(x), resolution * 0.05f, middle(z), 0.0f};
    run(engine, buffers, {{0.5f, 0.8f, 0.3f, 0.0f}, model.dag.depth(), kSide * kSide});

    const auto* lit = static_cast<const std::uint32_t*>(buffers[2].mapped);
    for (std::uint32_t y = 0; y < kSide; y += 2) {
        for (std::uint32_t x = 0; x < kSide; ++x) std::putchar(lit[y * kSide + x] != 0 ? '.' : '#');
        std::putchar('\n');
    }
} catch (const std::exception& error) {
    std::fprintf(stderr, "embed_vulkan: %s\n", error.what());
    return 1;
}
