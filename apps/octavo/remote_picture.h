// SPDX-License-Identifier: MIT
#pragma once

#include <httplib.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "octavo/backend/device.h"
#include "octavo/io/model.h"
#include "octavo/render/render.h"
#include "plain_picture.h"

namespace octavo::cli {

/// Draws what the page's camera sees, on the best device of this machine, and sends it as pictures,
/// each sharper than the one before.
///
/// One picture is drawn at a time. A newer wish of the same page stops the older one, so a camera
/// that moves never waits for pictures that nobody wants any more.
class RemotePicture {
public:
    /// @throws Error  as read_octv()
    explicit RemotePicture(const std::filesystem::path& file);

    /// For the page's configuration: where to ask, and the box of the voxels.
    [[nodiscard]] nlohmann::json config() const;

    /// Answers with JPEG frames and at last a PNG, each behind its length in four bytes, lowest
    /// first; 400 where the body is no wish that can be drawn.
    void render(const std::string& body, httplib::Response& response);

    /// Answers with the voxel along a ray as JSON, `null` where there is none.
    void pick(const std::string& body, httplib::Response& response) const;

    /// Stops what is being drawn, and whatever may come.
    void stop() { stopped_ = true; }

private:
    struct Stage;
    struct Wish {
        std::string page;
        std::uint64_t number = 0;           // of the page's wishes
        std::optional<PlainOptions> plain;  // a picture without light, in place of the rest
        RenderOptions options;
        bool stored = false;  // by the light of the file's cells
        double exposure = 0.0;
    };
    [[nodiscard]] Wish parse(const std::string& body) const;
    [[nodiscard]] bool is_wanted(const Wish& wish);

    /// The encoded picture; empty where nobody wants it any more.
    [[nodiscard]] std::string draw(const Wish& wish, const Stage& stage);
    [[nodiscard]] std::string draw_plain(const Wish& wish, const Stage& stage);

    std::filesystem::path file_;
    Model model_;
    Box bounds_;
    std::unique_ptr<Device> device_;  // the best; one thread at a time, see drawing_
    std::unique_ptr<DeviceDag> on_device_;
    std::mutex wishes_mutex_;
    std::map<std::string, std::uint64_t> newest_;  // by page
    std::mutex drawing_;
    std::atomic<bool> stopped_ = false;
};

}  // namespace octavo::cli
