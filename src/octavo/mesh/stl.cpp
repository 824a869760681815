// SPDX-License-Identifier: MIT
//
// STL, binary and text. Corners are not merged: the format has none in common, voxels need none,
// and what two triangles share after rounding is the file's business.
#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

#include "octavo/mesh/formats.h"
#include "octavo/mesh/text_cursor.h"

namespace octavo {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

constexpr std::size_t kHeaderSize = 84;    // 80 bytes of anything, then the count
constexpr std::size_t kTriangleSize = 50;  // normal, three corners, two bytes

std::uint64_t announced_count(std::string_view view) {
    std::uint32_t count = 0;
    std::memcpy(&count, view.data() + 80, 4);
    return count;
}

/// Binary files may begin with "solid" too, so the size decides first, then the words of a text.
bool is_binary(std::string_view view) {
    if (view.size() >= kHeaderSize &&
        view.size() == kHeaderSize + kTriangleSize * announced_count(view))
        return true;
    TextCursor text(view);
    const std::string_view first = text.word();
    if (first.size() < 5 || (first[0] != 's' && first[0] != 'S')) return true;
    return view.substr(0, 4096).find('\0') != std::string_view::npos;
}

Scene read_binary(const FileBytes& bytes) {
    const std::string_view view = bytes.view();
    if (view.size() < kHeaderSize)
        throw bytes.error_at(view.data() + view.size(), "is too short for an STL file");
    const std::uint64_t count = announced_count(view);
    if (count > (view.size() - kHeaderSize) / kTriangleSize)
        throw bytes.error_at(view.data() + 80, "the header announces " + std::to_string(count) +
                                                   " triangles, more than the file has room for");
    if (3 * count > Scene::kNoMaterial)
        throw Error(Errc::limit, bytes.file(), "has more than 2^32 corners");

    Scene scene;
    scene.positions.reserve(3 * count);
    scene.triangles.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        float corner[9];
        std::memcpy(corner, view.data() + kHeaderSize + i * kTriangleSize + 12, sizeof corner);
        for (const int c : {0, 3, 6})
            scene.positions.emplace_back(corner[c], corner[c + 1], corner[c + 2]);
        const auto first = static_cast<std::uint32_t>(3 * i);
        scene.triangles.emplace_back(first, first + 1, first + 2);
    }
    if (view.size() > kHeaderSize + kTriangleSize * count)
        scene.warnings.push_back("bytes after the last triangle were passed over");
    return scene;
}

bool equals_ignoring_case(std::string_view word, std::string_view lowercase) {
    return std::equal(word.begin(), word.end(), lowercase.begin(), lowercase.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

Scene read_text(const FileBytes& bytes) {
    Scene scene;
    TextCursor text(bytes.view());
    std::size_t corners = 0;  // of this facet so far
    bool ended = false;
    for (;;) {
        const std::string_view word = text.word();
        if (word.empty()) break;
        const auto is = [word](std::string_view name) { return equals_ignoring_case(word, name); };
        if (is("solid") || is("endsolid") || is("end")) {
            ended = !is("solid");
            text.at = word.data() + word.size();
            text.line();  // a name, of any words
        } else if (is("facet")) {
            corners = 0;
        } else if (is("vertex")) {
            dvec3 p;
            for (int axis = 0; axis < 3; ++axis) {
                text.skip_space();
                if (!text.number(p[axis]))
                    throw bytes.error_at(text.at, "a coordinate was expected here");
            }
            scene.positions.push_back(p);
            ++corners;
        } else if (is("endfacet")) {
            if (corners != 3)
                throw bytes.error_at(word.data(), "a facet has " + std::to_string(corners) +
                                                      " corners instead of three");
            if (scene.positions.size() > Scene::kNoMaterial)
                throw Error(Errc::limit, bytes.file(), "has more than 2^32 corners");
            const auto first = static_cast<std::uint32_t>(scene.positions.size() - 3);
            scene.triangles.emplace_back(first, first + 1, first + 2);
            corners = 0;
        } else if (is("normal")) {
            // Its numbers are often wrong and sometimes not numbers; voxels do not need them.
            for (int axis = 0; axis < 3; ++axis) text.word();
        } else if (!is("outer") && !is("loop") && !is("endloop")) {
            throw bytes.error_at(word.data(), "is not a word of an STL file");
        }
    }
    if (corners != 0) throw bytes.error_at(text.at, "the file ends inside a facet");
    if (!ended) scene.warnings.push_back("has no 'endsolid': it may be cut short");
    return scene;
}

}  // namespace

Scene formats::read_stl(const FileBytes& bytes) {
    return is_binary(bytes.view()) ? read_binary(bytes) : read_text(bytes);
}

}  // namespace octavo
