// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace octavo {

/// Compresses some bytes, at least one, into one zstd frame that states its content's size. One
/// thread and one fixed level, so that the same bytes give the same frame; memory is bounded, as
/// the frame leaves in pieces.
///
/// @param sink      receives the frame piece by piece
/// @param consumed  told every few MiB how many raw bytes are done; may throw to stop
/// @throws Error io     where zstd fails, which only a lack of memory can cause
void zstd_compress(std::span<const std::byte> raw,
                   const std::function<void(std::span<const std::byte>)>& sink,
                   const std::function<void(std::uint64_t)>& consumed);

/// The size that the frame's header claims, if this is one zstd frame and no more.
[[nodiscard]] std::optional<std::uint64_t> zstd_content_size(std::span<const std::byte> frame);

/// Fills `raw` exactly.
/// @return  what is wrong, where the frame's content is damaged or of another size; else nothing
[[nodiscard]] std::optional<std::string> zstd_decompress(std::span<const std::byte> frame,
                                                         std::span<std::byte> raw);

}  // namespace octavo
