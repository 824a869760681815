// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string_view>

namespace octavo::cli {

/// Gives closed standard streams a place of their own, so that no file the program opens can take
/// their number. Writing to a standard output that was closed fails afterwards.
void secure_standard_streams();

/// Makes a write that the system's limits do not allow an error like that of a full disk.
void report_full_disks();

/// Writes data to standard output, all of it.
/// @throws Error io  where it is closed or its disk is full
void print(std::string_view text);

/// Checks, before long work begins, that its result can be written.
///
/// @param force   an existing file may be replaced
/// @throws Error  io where the file is there and may not be replaced, or its folder cannot be
/// written
void check_output(const std::filesystem::path& file, bool force);

}  // namespace octavo::cli
