// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <initializer_list>
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

/// @throws Error bad_argument  where a file or folder to write has no name, or is "-", by which
///                             other programs mean a pipe
void check_output_name(const std::filesystem::path& name);

/// Checks, before long work begins, that its result can be written: every command that writes a
/// file asks this first.
///
/// @param force   an existing file may be replaced
/// @param inputs  what the result is made from; names of no file are passed over
/// @throws Error  bad_argument where it has no name, is "-", or is one of the inputs, which would
///                be lost;
///                io where it is there and may not be replaced, is a folder or a device, or cannot
///                be written
void check_output(const std::filesystem::path& file, bool force,
                  std::initializer_list<std::filesystem::path> inputs = {});

}  // namespace octavo::cli
