// SPDX-License-Identifier: MIT
#include "octavo/core/memory.h"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace octavo {

std::uint64_t machine_memory_bytes() {
    return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t available_memory_bytes() {
    std::uint64_t available = machine_memory_bytes();
    std::ifstream system("/proc/meminfo");
    for (std::string line; std::getline(system, line);)
        if (line.starts_with("MemAvailable:")) available = std::stoull(line.substr(13)) * 1024;
    // A container has its own group there.
    std::uint64_t most = 0, taken = 0;
    if (std::ifstream("/sys/fs/cgroup/memory.max") >> most &&
        std::ifstream("/sys/fs/cgroup/memory.current") >> taken)
        available = std::min(available, most > taken ? most - taken : 0);
    return available;
}

std::uint64_t resident_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t total_pages = 0;
    std::uint64_t resident_pages = 0;
    if (!(statm >> total_pages >> resident_pages)) return 0;
    return resident_pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t peak_resident_bytes() {
    rusage usage{};
    if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

bool restart_peak_resident() {
    std::ofstream clear("/proc/self/clear_refs");
    return static_cast<bool>(clear << "5" << std::flush);  // 5: the peak, see proc(5)
}

void trim_memory() {
    malloc_trim(0);
}

void discard_pages(void* room, std::size_t bytes) {
    const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    const auto begin = reinterpret_cast<std::uintptr_t>(room);
    const std::uintptr_t first = (begin + page - 1) / page * page;
    const std::uintptr_t last = (begin + bytes) / page * page;
    // Advice: where it is not taken, the memory comes back later, with the room.
    if (first < last) (void)madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED);
}

void return_freed_memory() {
    constexpr int kLeastBlock = 256 << 10;
    mallopt(M_MMAP_THRESHOLD, kLeastBlock);
}

}  // namespace octavo
