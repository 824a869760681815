// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "backend/test_devices.h"

#if OCTAVO_HAS_VULKAN
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "octavo/backend/vulkan/free_list.h"
#include "octavo/backend/vulkan/loader.h"
#include "support/small_dags.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

TEST(FreeList, GivesPartsThatDoNotOverlapAndTakesThemAllBack) {
    vulkan::FreeList list(1 << 20);
    std::mt19937 random(1);
    std::map<std::uint64_t, std::uint64_t> taken;
    for (int i = 0; i < 20000; ++i) {
        if (random() % 2 == 0 || taken.empty()) {
            const std::uint64_t bytes = 1 + random() % 20000;
            const auto offset = list.take(bytes, 256);
            if (!offset) continue;
            ASSERT_EQ(*offset % 256, 0u);
            ASSERT_LE(*offset + bytes, list.size());
            const auto next = taken.lower_bound(*offset);
            if (next != taken.end()) {
                ASSERT_LE(*offset + bytes, next->first);
            }
            if (next != taken.begin()) {
                ASSERT_LE(std::prev(next)->first + std::prev(next)->second, *offset);
            }
            taken[*offset] = bytes;
        } else {
            const auto some = std::next(taken.begin(), static_cast<long>(random() % taken.size()));
            list.give_back(some->first);
            taken.erase(some);
        }
    }
    for (const auto& [offset, bytes] : taken) list.give_back(offset);
    EXPECT_TRUE(list.all_free());
    EXPECT_EQ(list.free_parts(), 1u);
    EXPECT_EQ(list.take(1 << 20, 256), 0u);
    EXPECT_FALSE(list.take(1, 256));
}

TEST(Spirv, OfEveryPassIsValid) {
    if (std::string(OCTAVO_SPIRV_VAL).empty()) GTEST_SKIP() << "no spirv-val (spirv-tools)";
    const test::TemporaryFolder folder;
    for (int pass = 0; pass < kPasses; ++pass) {
        const auto words = vulkan::spirv(static_cast<Pass>(pass));
        ASSERT_FALSE(words.empty()) << pass;
        const auto file = folder / ("pass" + std::to_string(pass) + ".spv");
        std::ofstream(file, std::ios::binary)
            .write(reinterpret_cast<const char*>(words.data()),
                   static_cast<std::streamsize>(words.size_bytes()));
        const std::string command = std::string(OCTAVO_SPIRV_VAL) +
                                    " --target-env vulkan1.2 --scalar-block-layout " +
                                    file.string();
        EXPECT_EQ(std::system(command.c_str()), 0) << pass;
    }
}

TEST(VulkanErrors, SayWhatFailed) {
    const auto error_of = [](VkResult result) {
        try {
            vulkan::check(result, "drawing");
        } catch (const Error& error) {
            return error;
        }
        return Error(Errc::cancelled, "none");
    };
    EXPECT_EQ(error_of(VK_ERROR_OUT_OF_DEVICE_MEMORY).code(), Errc::limit);
    EXPECT_EQ(error_of(VK_ERROR_DEVICE_LOST).code(), Errc::io);
    EXPECT_NE(std::string(error_of(VK_ERROR_DEVICE_LOST).what()).find("watchdog"),
              std::string::npos);
    EXPECT_EQ(error_of(VK_SUCCESS).code(), Errc::cancelled);
}

class VulkanMemory : public testing::Test {
protected:
    void SetUp() override {
        try {
            queue_ = vulkan::open_queue({.validation = true});
        } catch (const Error& error) {
            GTEST_SKIP() << error.what();
        }
    }
    void TearDown() override {
        if (!queue_) return;
        for (const std::string& message : queue_->messages()) ADD_FAILURE() << message;
    }
    std::unique_ptr<vulkan::VulkanQueue> queue_;
};

TEST_F(VulkanMemory, IsGivenBack) {
    for (int i = 0; i < 3; ++i) {
        const DeviceArray<shared::UintArray> small(*queue_, 1000);
        const DeviceArray<shared::UintArray> large(*queue_, 20 << 20);
        EXPECT_EQ(queue_->blocks(), 2u);
    }
    EXPECT_EQ(queue_->blocks(), 0u);
}

TEST_F(VulkanMemory, ReturnsWhatWasWritten) {
    std::vector<std::uint32_t> values(5 << 20);  // more than the staging block holds
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<std::uint32_t>(i * 2654435761u);
    const DeviceArray<shared::UintArray> array(*queue_, values);
    EXPECT_TRUE(array.read() == values);
}

TEST_F(VulkanMemory, RefusesWhatTheDeviceCannotHold) {
    try {
        (void)queue_->allocate(std::uint64_t{1} << 50);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::limit);
        EXPECT_NE(std::string(error.what()).find("MiB"), std::string::npos);
    }
    EXPECT_EQ(queue_->blocks(), 0u);
    EXPECT_GT(queue_->allocate(1000), 0u);  // and goes on
}

}  // namespace
}  // namespace octavo
#else
TEST(Vulkan, IsInThisBuild) {
    GTEST_SKIP() << "this build has no Vulkan";
}
#endif
