// SPDX-License-Identifier: MIT
// The worked example in docs/file-format.md is what the writer writes.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

#include "io/small_model.h"
#include "octavo/io/octv.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

/// As `hexdump -C` prints it: 16 bytes a line, a star for lines equal to the one before.
std::string hex_dump(const std::string& bytes) {
    std::string text;
    bool starred = false;
    const auto line = [&](std::size_t at) { return bytes.substr(at, 16); };
    for (std::size_t at = 0; at < bytes.size(); at += 16) {
        if (at > 0 && line(at) == line(at - 16)) {
            if (!starred) text += "*\n";
            starred = true;
            continue;
        }
        starred = false;
        std::array<char, 32> number{};
        std::snprintf(number.data(), number.size(), "%08zx ", at);
        text += number.data();
        std::string letters;
        for (std::size_t i = 0; i < 16; ++i) {
            if (i == 8) text += ' ';
            if (at + i >= bytes.size()) {
                text += "   ";
                continue;
            }
            const auto byte = static_cast<unsigned char>(bytes[at + i]);
            std::snprintf(number.data(), number.size(), " %02x", byte);
            text += number.data();
            letters += byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '.';
        }
        text += "  |" + letters + "|\n";
    }
    std::array<char, 32> end{};
    std::snprintf(end.data(), end.size(), "%08zx\n", bytes.size());
    return text + end.data();
}

TEST(FileFormat, DocumentedExampleIsWhatTheWriterWrites) {
    const test::TemporaryFolder folder;
    write_octv(folder / "small.octv", test::example_model());
    const std::string dump = hex_dump(test::file_content(folder / "small.octv"));
    const std::string page =
        test::file_content(std::filesystem::path(OCTAVO_SOURCE_DIR) / "docs" / "file-format.md");
    EXPECT_NE(page.find("```\n" + dump + "```"), std::string::npos)
        << "docs/file-format.md should hold:\n"
        << dump;
}

}  // namespace
}  // namespace octavo
