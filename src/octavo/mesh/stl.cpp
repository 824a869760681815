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
#include "octavo/mesh/word_reader.h"

namespace octavo {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

constexpr std::size_t kHeaderSize = 84;    // 80 bytes of anything, then the count
constexpr std::size_t kTriangleSize = 50;  // normal, three corners, two bytes

std::uint64_t announced_count(std::string_view start) {
    std::uint32_t count = 0;
    std::memcpy(&count, start.data() + 80, 4);
    return count;
}

/// Binary files may begin with "solid" too, so the size decides first, then the words of a text. In
/// long gzip data the size is not known, but few binary files have no zero near their beginning.
bool is_binary(const FileWindow& input) {
    const std::string_view start = input.ahead();
    if (start.size() >= kHeaderSize &&
        input.most_ahead() == kHeaderSize + kTriangleSize * announced_count(start))
        return true;
    TextCursor text(start);
    const std::string_view first = text.word();
    if (first.size() < 5 || (first[0] != 's' && first[0] != 'S')) return true;
    return start.substr(0, 4096).find('\0') != std::string_view::npos;
}

Scene read_binary(FileWindow& input) {
    const char* header = input.take(kHeaderSize);
    if (header == nullptr)
        throw input.error_at(input.offset_of(input.begin()) + input.ahead().size(),
                             "is too short for an STL file");
    const std::uint64_t count = announced_count({header, kHeaderSize});
    if (count > input.most_ahead() / kTriangleSize)
        throw input.error_at(header + 80, "the header announces " + std::to_string(count) +
                                              " triangles, more than the file has room for");
    if (3 * count > Scene::kNoMaterial)
        throw Error(Errc::limit, input.file(), "has more than 2^32 corners");

    Scene scene;
    const std::uint64_t likely_count = std::min(count, input.expected_ahead() / kTriangleSize);
    scene.positions.reserve(3 * likely_count);
    scene.triangles.reserve(likely_count);
    for (std::uint64_t i = 0; i < count; ++i) {
        const char* triangle = input.take(kTriangleSize);
        if (triangle == nullptr)
            throw input.error_at(input.ahead().data(), "the file ends too early");
        float corner[9];
        std::memcpy(corner, triangle + 12, sizeof corner);
        for (const int c : {0, 3, 6})
            scene.positions.emplace_back(corner[c], corner[c + 1], corner[c + 2]);
        const auto first = static_cast<std::uint32_t>(3 * i);
        scene.triangles.emplace_back(first, first + 1, first + 2);
    }
    if (input.take(1) != nullptr)
        scene.warnings.push_back("bytes after the last triangle were passed over");
    return scene;
}

bool equals_ignoring_case(std::string_view word, std::string_view lowercase) {
    return std::equal(word.begin(), word.end(), lowercase.begin(), lowercase.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

Scene read_text(FileWindow& input) {
    Scene scene;
    WordReader words(input);
    TextCursor& text = words.text;
    std::size_t corners = 0;  // of this facet so far
    bool ended = false;
    while (words.find()) {
        const std::string_view word = text.word();
        const auto is = [word](std::string_view name) { return equals_ignoring_case(word, name); };
        if (is("solid") || is("endsolid") || is("end")) {
            ended = !is("solid");
            words.skip_line();  // a name, of any words
        } else if (is("facet")) {
            corners = 0;
        } else if (is("vertex")) {
            dvec3 p;
            for (int axis = 0; axis < 3; ++axis)
                if (!words.find() || !text.number(p[axis]))
                    throw input.error_at(text.at, "a coordinate was expected here");
            scene.positions.push_back(p);
            ++corners;
        } else if (is("endfacet")) {
            if (corners != 3)
                throw input.error_at(word.data(), "a facet has " + std::to_string(corners) +
                                                      " corners instead of three");
            if (scene.positions.size() > Scene::kNoMaterial)
                throw Error(Errc::limit, input.file(), "has more than 2^32 corners");
            const auto first = static_cast<std::uint32_t>(scene.positions.size() - 3);
            scene.triangles.emplace_back(first, first + 1, first + 2);
            corners = 0;
        } else if (is("normal")) {
            // Its numbers are often wrong and sometimes not numbers; voxels do not need them.
            for (int axis = 0; axis < 3; ++axis)
                if (words.find()) text.word();
        } else if (!is("outer") && !is("loop") && !is("endloop")) {
            throw input.error_at(word.data(), "is not a word of an STL file");
        }
    }
    if (corners != 0) throw input.error_at(text.at, "the file ends inside a facet");
    if (!ended) scene.warnings.push_back("has no 'endsolid': it may be cut short");
    return scene;
}

}  // namespace

Scene formats::read_stl(FileWindow& input) {
    return is_binary(input) ? read_binary(input) : read_text(input);
}

}  // namespace octavo
