// SPDX-License-Identifier: MIT
#include "octavo/construct/mpi/mpi_session.h"

#include <mpi.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "octavo/core/error.h"

namespace octavo {
namespace {

/// MPI's own waiting spins.
void wait(MPI_Request& request, const std::function<void()>& while_waiting) {
    using namespace std::chrono_literals;
    auto pause = 20us;
    for (;;) {
        int done = 0;
        MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done != 0) return;
        std::this_thread::sleep_for(pause);
        if (pause < 2ms) pause *= 2;
        if (while_waiting) while_waiting();
    }
}

}  // namespace

bool started_by_mpirun() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
        const char* size = std::getenv(name);
        if (size != nullptr && std::atoi(size) > 0) return true;
    }
    return false;
}

MpiSession::MpiSession() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_MULTIPLE, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    if (provided < MPI_THREAD_MULTIPLE && ranks_ > 1)
        throw Error(Errc::unsupported, "this MPI cannot be called from several threads");
}

MpiSession::~MpiSession() {
    MPI_Finalize();
}

void MpiSession::abort(int exit_code) {
    MPI_Abort(MPI_COMM_WORLD, exit_code);
    std::_Exit(exit_code);
}

void MpiSession::send(int to, int tag, const void* bytes, std::size_t size, Waiting waiting) {
    MPI_Request request;
    MPI_Isend(bytes, static_cast<int>(size), MPI_BYTE, to, tag, MPI_COMM_WORLD, &request);
    wait(request, waiting == Waiting::open ? while_waiting : nullptr);
    sent_bytes_ += size;
}

void MpiSession::receive(int from, int tag, void* bytes, std::size_t size, Waiting waiting) {
    MPI_Request request;
    MPI_Irecv(bytes, static_cast<int>(size), MPI_BYTE, from, tag, MPI_COMM_WORLD, &request);
    wait(request, waiting == Waiting::open ? while_waiting : nullptr);
}

bool MpiSession::probe(int tag, int& from) {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &there, &status);
    from = there != 0 ? status.MPI_SOURCE : -1;
    return there != 0;
}

std::vector<std::vector<std::uint64_t>> MpiSession::gather_everywhere(
    const std::vector<std::uint64_t>& mine) {
    const auto count = static_cast<std::size_t>(ranks_);
    std::vector<int> sizes(count), begins(count);
    int size = static_cast<int>(mine.size());
    MPI_Request request;
    MPI_Iallgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, MPI_COMM_WORLD, &request);
    wait(request, while_waiting);
    int total = 0;
    for (std::size_t r = 0; r < count; ++r) {
        begins[r] = total;
        total += sizes[r];
    }
    std::vector<std::uint64_t> all(static_cast<std::size_t>(total));
    MPI_Iallgatherv(mine.data(), size, MPI_UINT64_T, all.data(), sizes.data(), begins.data(),
                    MPI_UINT64_T, MPI_COMM_WORLD, &request);
    wait(request, while_waiting);
    std::vector<std::vector<std::uint64_t>> lists;
    for (std::size_t r = 0; r < count; ++r)
        lists.emplace_back(all.begin() + begins[r], all.begin() + begins[r] + sizes[r]);
    return lists;
}

}  // namespace octavo
