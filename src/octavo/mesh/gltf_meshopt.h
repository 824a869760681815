// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "octavo/core/file_bytes.h"
#include "octavo/mesh/gltf_json.h"

namespace octavo::gltf {

/// What a buffer view says about the packed bytes that stand for it: an object of
/// EXT_meshopt_compression, or of KHR_meshopt_compression, its later name. None: not packed.
[[nodiscard]] const json* meshopt_packing(const json& view);

/// Unpacks the bytes of such a view, exactly.
///
/// @param packing    as above @param packed  the bytes that it names
/// @param max_bytes  of the result
/// @throws Error     bad_input where the bytes are damaged or say that they hold more than they
///                   can; unsupported for a codec that is not known; limit beyond `max_bytes`
/// Cost              1 byte of input gives at most 64: so nothing is allocated on a count's word
[[nodiscard]] std::vector<std::byte> unpack_meshopt(const json& packing,
                                                    std::span<const std::byte> packed,
                                                    const FileBytes& file, std::uint64_t max_bytes);

}  // namespace octavo::gltf
