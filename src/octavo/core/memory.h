// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace octavo {

/// Physical memory of the machine, in bytes.
[[nodiscard]] std::uint64_t machine_memory_bytes();

/// Physical memory that this process holds now, in bytes; 0 where the system does not say.
[[nodiscard]] std::uint64_t resident_bytes();

/// The most that it has held so far.
[[nodiscard]] std::uint64_t peak_resident_bytes();

/// Lets peak_resident_bytes() count anew from what is held now. False where the system cannot.
bool restart_peak_resident();

/// Gives memory that has been freed back to the system, as far as the allocator holds it.
void trim_memory();

}  // namespace octavo
