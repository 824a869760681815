// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace octavo {

/// Physical memory of the machine, in bytes.
[[nodiscard]] std::uint64_t machine_memory_bytes();

/// Physical memory that programs can still take, in bytes: what the system says is available, or
/// less where this process' control group leaves less. All of it where the system does not say.
[[nodiscard]] std::uint64_t available_memory_bytes();

/// Physical memory that this process holds now, in bytes; 0 where the system does not say.
[[nodiscard]] std::uint64_t resident_bytes();

/// The most that it has held so far.
[[nodiscard]] std::uint64_t peak_resident_bytes();

/// Lets peak_resident_bytes() count anew from what is held now. False where the system cannot.
bool restart_peak_resident();

/// Gives memory that has been freed back to the system, as far as the allocator holds it.
void trim_memory();

/// Gives the memory of the whole pages of this room back to the system while the room stays
/// allocated: it reads as anything afterwards, and takes memory again when it is written.
void discard_pages(void* room, std::size_t bytes);

/// From now on large blocks come from the system one by one and go back to it at once. By default
/// glibc begins to keep blocks of up to 32 MiB, and what is kept counts as held. For programs: it
/// concerns the whole process.
void return_freed_memory();

}  // namespace octavo
