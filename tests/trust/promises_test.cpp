// SPDX-License-Identifier: MIT
// docs/promises.md names the test behind each promise: they must exist.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "support/temporary_folder.h"

namespace octavo {
namespace {

namespace fs = std::filesystem;

/// "Suite.Name" of every test in the sources.
std::set<std::string> tests_in_sources() {
    static const std::regex kTest(R"(TEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\s*\))");
    std::set<std::string> tests;
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(OCTAVO_SOURCE_DIR) / "tests")) {
        if (entry.path().extension() != ".cpp") continue;
        const std::string text = test::file_content(entry.path());
        for (auto match = std::sregex_iterator(text.begin(), text.end(), kTest);
             match != std::sregex_iterator(); ++match)
            tests.insert((*match)[1].str() + "." + (*match)[2].str());
    }
    return tests;
}

void expect_named_tests_exist(const char* page, std::size_t at_least) {
    const std::set<std::string> known = tests_in_sources();
    static const std::regex kName(R"(`[a-z_]+\.(\w+\.\w+)`)");
    const std::string text = test::file_content(fs::path(OCTAVO_SOURCE_DIR) / page);
    std::size_t named = 0;
    for (auto match = std::sregex_iterator(text.begin(), text.end(), kName);
         match != std::sregex_iterator(); ++match) {
        const std::string name = (*match)[1].str();
        if (name.ends_with(".md") || name.ends_with(".h")) continue;
        ++named;
        EXPECT_TRUE(known.contains(name)) << page << " names " << name << ", which no source has";
    }
    EXPECT_GE(named, at_least) << page;
}

TEST(Promises, AreBackedByTestsThatExist) {
    expect_named_tests_exist("docs/promises.md", 40);
}

TEST(Promises, OfTheSecurityPageAreBackedByTestsThatExist) {
    expect_named_tests_exist("SECURITY.md", 4);
}

}  // namespace
}  // namespace octavo
