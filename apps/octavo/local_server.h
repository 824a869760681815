// SPDX-License-Identifier: MIT
#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "octavo/core/input_file.h"
#include "server_threads.h"

namespace octavo::cli {

/// Serves a page and one file to this machine's browser, and nothing else to anyone.
///
/// It listens on 127.0.0.1; takes requests for its own Host names only, so that a foreign page
/// whose name was made to lead here gets nothing; and knows no path but those below a random token.
/// A client that sends too much or too slowly is cut off, as is one for whose answer there is no
/// memory. Up to 128 connections are served at a
/// time, others wait.
class LocalServer : private httplib::Server {
public:
    /// Answers a POST. @param body  at most 64 KiB
    using PostHandler = std::function<void(const std::string& body, httplib::Response& response)>;

    struct Content {
        std::string page;            // HTML, at the token's path
        std::filesystem::path file;  // at scene.octv below it
        PostHandler render;          // at render below it, if given
        PostHandler pick;            // at pick below it, if given
    };

    /// @param port    0: any that is free
    /// @throws Error  io where the file cannot be read or the port is taken
    LocalServer(Content content, int port);
    ~LocalServer() override;
    LocalServer(const LocalServer&) = delete;
    LocalServer& operator=(const LocalServer&) = delete;

    /// With the token: who has it sees the scene.
    [[nodiscard]] std::string url() const;

    /// Has it been told to stop? Handlers of long answers ask.
    [[nodiscard]] bool stopping() const { return stopping_; }

private:
    bool process_and_close_socket(socket_t socket) override;
    HandlerResponse answer(const httplib::Request& request, httplib::Response& response);
    HandlerResponse refuse(httplib::Response& response, int status) const;
    void serve_file(httplib::Response& response) const;
    void clip_ranges(httplib::Request& request) const;
    [[nodiscard]] bool is_own_host(const httplib::Request& request) const;

    Content content_;
    std::string token_;
    InputFile file_;
    int listening_ = -1;
    int port_ = 0;
    std::atomic<bool> stopping_ = false;
    std::unique_ptr<ServerThreads> threads_;  // until it listens
    std::thread thread_;
};

}  // namespace octavo::cli
