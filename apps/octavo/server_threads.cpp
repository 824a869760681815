// SPDX-License-Identifier: MIT
#include "server_threads.h"

#include <chrono>
#include <exception>
#include <new>
#include <utility>

#include "octavo/core/error.h"

namespace octavo::cli {

ServerThreads::ServerThreads(std::size_t most) : most_(most) {
    threads_.reserve(most);
    if (!start_one()) throw Error(Errc::limit, "no memory for the server's first thread");
}

bool ServerThreads::start_one() {
    try {
        threads_.emplace_back([this] { work(); });
        return true;
    } catch (const std::exception&) {
        return false;
    }
}

void ServerThreads::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        ++idle_;
        wake_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
        --idle_;
        if (jobs_.empty()) return;
        const std::function<void()> job = std::move(jobs_.front());
        jobs_.pop_front();
        lock.unlock();
        job();
        lock.lock();
    }
}

void ServerThreads::enqueue(std::function<void()> job) {
    std::unique_lock lock(mutex_);
    for (bool queued = false; !queued;) {
        try {
            jobs_.push_back(job);
            queued = true;
        } catch (const std::bad_alloc&) {
            constexpr std::chrono::milliseconds kUntilOneEnds{10};
            lock.unlock();
            std::this_thread::sleep_for(kUntilOneEnds);
            lock.lock();
        }
    }
    if (idle_ < jobs_.size() && threads_.size() < most_) start_one();
    lock.unlock();
    wake_.notify_one();
}

void ServerThreads::shutdown() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_)
        if (thread.joinable()) thread.join();
}

}  // namespace octavo::cli
