// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace octavo {

/// Was this process started by mpirun, or something like it, with others beside it?
[[nodiscard]] bool started_by_mpirun();

/// MPI from its start to its end; one for each process. Waiting gives the processor away, because
/// ranks may be more than cores.
class MpiSession {
public:
    /// @throws Error unsupported where this MPI cannot be called from several threads
    MpiSession();
    ~MpiSession();
    MpiSession(const MpiSession&) = delete;
    MpiSession& operator=(const MpiSession&) = delete;

    [[nodiscard]] int rank() const { return rank_; }
    [[nodiscard]] int ranks() const { return ranks_; }

    /// Ends all ranks at once, with this exit code.
    [[noreturn]] void abort(int exit_code);

    /// Called from time to time while this rank waits; may throw.
    std::function<void()> while_waiting;

    enum class Waiting {
        open,    // calls while_waiting
        silent,  // does not: for another thread than the one that it belongs to
    };
    void send(int to, int tag, const void* bytes, std::size_t size, Waiting = Waiting::open);
    void receive(int from, int tag, void* bytes, std::size_t size, Waiting = Waiting::open);

    /// Is there a message with this tag? From whom?
    [[nodiscard]] bool probe(int tag, int& from);

    /// Every rank's numbers, rank by rank, to every rank; all ranks call it.
    [[nodiscard]] std::vector<std::vector<std::uint64_t>> gather_everywhere(
        const std::vector<std::uint64_t>& mine);

    /// Bytes that this rank has sent, without the numbers of gather_everywhere.
    [[nodiscard]] std::uint64_t sent_bytes() const { return sent_bytes_; }

private:
    int rank_ = 0;
    int ranks_ = 1;
    std::atomic<std::uint64_t> sent_bytes_ = 0;
};

}  // namespace octavo
