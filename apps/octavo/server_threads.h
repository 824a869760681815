// SPDX-License-Identifier: MIT
#pragma once

#include <httplib.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace octavo::cli {

/// The threads of a server: started when there is work for one more, up to a number. Where the
/// system has no memory for another, those that there are do the work; it may then wait, and no
/// job is lost.
class ServerThreads : public httplib::TaskQueue {
public:
    /// @throws Error  limit where not even one can be started
    explicit ServerThreads(std::size_t most);
    ~ServerThreads() override { shutdown(); }
    ServerThreads(const ServerThreads&) = delete;
    ServerThreads& operator=(const ServerThreads&) = delete;

    /// @param job  throws nothing
    void enqueue(std::function<void()> job) override;
    /// Waits for all jobs.
    void shutdown() override;

private:
    /// @return whether there is one more
    bool start_one();
    void work();

    std::size_t most_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::function<void()>> jobs_;
    std::size_t idle_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace octavo::cli
