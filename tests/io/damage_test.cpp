// SPDX-License-Identifier: MIT
// Whatever happens to the bytes of a file, reading it gives the same meaning or an Error.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "io/small_model.h"
#include "octavo/core/error.h"
#include "octavo/io/octv.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using test::file_content;
using test::small_model;
using test::TemporaryFolder;
using test::write_file;

bool same_meaning(const Model& a, const Model& b) {
    return std::ranges::equal(a.dag.words(), b.dag.words()) &&
           encode_metadata(a.metadata) == encode_metadata(b.metadata);
}

enum class Outcome { same, refused, different };

Outcome read_again(const std::filesystem::path& file, const Model& model) {
    try {
        return same_meaning(read_octv(file), model) ? Outcome::same : Outcome::different;
    } catch (const Error& error) {
        EXPECT_TRUE(error.code() == Errc::bad_input || error.code() == Errc::unsupported)
            << error.what();
        EXPECT_EQ(error.file(), file);
        EXPECT_TRUE(error.offset().has_value()) << error.what();
        return Outcome::refused;
    }
}

class Damage : public testing::TestWithParam<bool> {
protected:
    Damage() { write_octv(file, model, {.compress = GetParam()}); }

    TemporaryFolder folder;
    Model model = small_model();
    std::filesystem::path file = folder / "a.octv";
};

TEST_P(Damage, EveryTruncationIsRefused) {
    for (auto size = std::filesystem::file_size(file); size-- > 0;) {
        ASSERT_EQ(truncate(file.c_str(), static_cast<off_t>(size)), 0);
        ASSERT_EQ(read_again(file, model), Outcome::refused) << "cut to " << size;
    }
}

TEST_P(Damage, TrailingBytesAreRefused) {
    write_file(file, file_content(file) + "x");
    EXPECT_EQ(read_again(file, model), Outcome::refused);
}

TEST_P(Damage, EveryFlippedBitIsRefusedOrHarmless) {
    std::string content = file_content(file);
    std::FILE* stream = std::fopen(file.c_str(), "r+b");
    ASSERT_NE(stream, nullptr);
    const int descriptor = fileno(stream);
    std::size_t refused = 0;
    for (std::size_t byte = 0; byte < content.size(); ++byte) {
        // Nothing lies in most of the file; one bit in eight of the padding does.
        const bool padding = content[byte] == 0;
        for (int bit = 0; bit < 8; bit += padding ? 8 : 1) {
            const char flipped = static_cast<char>(content[byte] ^ (1 << bit));
            const auto offset = static_cast<off_t>(byte);
            ASSERT_EQ(pwrite(descriptor, &flipped, 1, offset), 1);
            const Outcome outcome = read_again(file, model);
            ASSERT_NE(outcome, Outcome::different) << "bit " << bit << " of byte " << byte;
            refused += outcome == Outcome::refused;
        }
        ASSERT_EQ(pwrite(descriptor, &content[byte], 1, static_cast<off_t>(byte)), 1);
    }
    std::fclose(stream);
    EXPECT_GT(refused, 64u + 2 * 48);
}

INSTANTIATE_TEST_SUITE_P(Octv, Damage, testing::Bool(),
                         [](const auto& test) { return test.param ? "Compressed" : "Plain"; });

}  // namespace
}  // namespace octavo
