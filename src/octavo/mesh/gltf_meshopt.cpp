// SPDX-License-Identifier: MIT
//
// EXT_meshopt_compression (Khronos Group, 2021), by the library that defines the codec.
#include "octavo/mesh/gltf_meshopt.h"

#include <meshoptimizer.h>

#include <string>

namespace octavo::gltf {
namespace {

// The greatest ratio is that of vertices: 16 equal bytes take two bits. A triangle of 12 bytes and
// an index of 4 take a byte at least.
constexpr std::size_t kMostFromAByte = 64;
constexpr std::size_t kLargestVertex = 256;

struct Layout {
    std::string mode, filter;
    std::size_t count, stride;
};

/// The library only asserts these, and its release checks nothing.
bool fits(const Layout& layout) {
    if (layout.mode == "ATTRIBUTES")
        return layout.stride > 0 && layout.stride <= kLargestVertex && layout.stride % 4 == 0;
    const bool whole_triangles = layout.mode != "TRIANGLES" || layout.count % 3 == 0;
    return whole_triangles && (layout.stride == 2 || layout.stride == 4);
}

/// @return 0: done; below 0: not
int unpack(const Layout& layout, const unsigned char* from, std::size_t size, std::byte* to) {
    if (layout.mode == "ATTRIBUTES")
        return meshopt_decodeVertexBuffer(to, layout.count, layout.stride, from, size);
    if (layout.mode == "TRIANGLES")
        return meshopt_decodeIndexBuffer(to, layout.count, layout.stride, from, size);
    return meshopt_decodeIndexSequence(to, layout.count, layout.stride, from, size);
}

/// @return whether the filter is known and can be undone on elements of this size
bool undo_filter(const Layout& layout, std::byte* values) {
    if (layout.filter == "NONE") return true;
    if (layout.mode != "ATTRIBUTES") return false;
    if (layout.filter == "OCTAHEDRAL" && (layout.stride == 4 || layout.stride == 8))
        meshopt_decodeFilterOct(values, layout.count, layout.stride);
    else if (layout.filter == "QUATERNION" && layout.stride == 8)
        meshopt_decodeFilterQuat(values, layout.count, layout.stride);
    else if (layout.filter == "EXPONENTIAL")
        meshopt_decodeFilterExp(values, layout.count, layout.stride);
    else
        return false;
    return true;
}

}  // namespace

const json* meshopt_packing(const json& view) {
    const json* packing = extension(view, "EXT_meshopt_compression");
    return packing ? packing : extension(view, "KHR_meshopt_compression");
}

std::vector<std::byte> unpack_meshopt(const json& packing, std::span<const std::byte> packed,
                                      const FileBytes& file, std::uint64_t max_bytes) {
    const Layout layout{value_or<std::string>(packing, "mode", ""),
                        value_or<std::string>(packing, "filter", "NONE"),
                        whole(packing, "count").value_or(0),
                        whole(packing, "byteStride").value_or(0)};
    const auto unknown = [&](const std::string& what) {
        return Error(Errc::unsupported, file.file(), "has meshopt data of unknown " + what);
    };
    if (layout.mode != "ATTRIBUTES" && layout.mode != "TRIANGLES" && layout.mode != "INDICES")
        throw unknown("mode '" + layout.mode + "'");
    if (!fits(layout)) throw file.error("has meshopt data with a stride or a count that cannot be");
    if (layout.count > packed.size() * kMostFromAByte / layout.stride)
        throw file.error("has meshopt data that say they hold more than they can");
    const std::size_t size = layout.count * layout.stride;
    if (size > max_bytes)
        throw Error(Errc::limit, file.file(),
                    "unpacked, takes more than " + std::to_string(max_bytes) + " bytes");

    std::vector<std::byte> values(size);
    constexpr int kOtherVersion = -1;  // or no data of this codec at all
    const auto* from = reinterpret_cast<const unsigned char*>(packed.data());
    const int result = unpack(layout, from, packed.size(), values.data());
    if (result == kOtherVersion) throw unknown("version");
    if (result != 0) throw file.error("has damaged meshopt data");
    if (!undo_filter(layout, values.data())) throw unknown("filter '" + layout.filter + "'");
    return values;
}

}  // namespace octavo::gltf
