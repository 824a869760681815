// SPDX-License-Identifier: MIT
// A program that uses the library may set any locale; numbers in files stay what they are.
#include <gtest/gtest.h>

#include <clocale>
#include <locale>
#include <sstream>

#include "cli/run_command.h"
#include "io/small_model.h"
#include "octavo/io/octv.h"
#include "octavo/mesh/load.h"
#include "octavo/mesh/samples.h"
#include "octavo/mesh/save.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using test::TemporaryFolder;

struct GermanNumbers : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

/// A comma for streams, and for the C library where the machine has, or can make, such a locale.
class GermanLocale {
public:
    GermanLocale()
        : old_(std::locale::global(std::locale(std::locale::classic(), new GermanNumbers))) {
        static const TemporaryFolder folder;
        static const int made =
            std::system(("localedef -i de_DE -f UTF-8 '" + (folder / "de_DE.UTF-8").string() +
                         "' 2>/dev/null >&2")
                            .c_str());
        if (made == 0) setenv("LOCPATH", folder.path().c_str(), 1);
        has_c_ = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
    }
    ~GermanLocale() {
        std::locale::global(old_);
        std::setlocale(LC_ALL, "C");
        unsetenv("LOCPATH");
    }
    [[nodiscard]] bool has_c() const { return has_c_; }

private:
    std::locale old_;
    bool has_c_ = false;
};

/// Files and scenes written and read in this locale.
struct Products {
    std::string octv, obj, ply, glb;
    std::uint64_t from_obj = 0, from_ply = 0, from_glb = 0;

    Products() {
        const TemporaryFolder folder;
        write_octv(folder / "a.octv", test::small_model());
        octv = test::file_content(folder / "a.octv");
        EXPECT_EQ(encode_metadata(read_octv(folder / "a.octv").metadata),
                  encode_metadata(test::small_model().metadata));
        const Scene scene = make_sample("courtyard", 0.05);
        const auto round_trip = [&](const char* name, std::string& bytes) {
            save_scene(scene, folder / name);
            bytes = test::file_content(folder / name);
            return load_scene(folder / name).geometry_hash();
        };
        from_obj = round_trip("a.obj", obj);
        from_ply = round_trip("a.ply", ply);
        from_glb = round_trip("a.glb", glb);
    }
    bool operator==(const Products&) const = default;
};

TEST(Locale, DoesNotChangeWhatIsWrittenOrRead) {
    const Products plain;
    bool has_c = false;
    {
        const GermanLocale german;
        has_c = german.has_c();
        std::ostringstream text;
        text << 1234.5;
        ASSERT_EQ(text.str(), "1.234,5") << "the locale is not in force";
        EXPECT_TRUE(Products() == plain);
    }
    if (!has_c) GTEST_SKIP() << "streams are checked; the C library has no de_DE.UTF-8 here";
}

TEST(Clock, NoneIsReadThatAnAdministratorCanSet) {
    // Durations come from steady_clock, and no file holds a time.
    for (const auto& entry : std::filesystem::recursive_directory_iterator(
             std::filesystem::path(OCTAVO_SOURCE_DIR) / "src" / "octavo")) {
        if (!entry.is_regular_file()) continue;
        const std::string text = test::file_content(entry.path());
        for (const char* clock : {"system_clock", "gettimeofday", "localtime", "std::time("})
            EXPECT_EQ(text.find(clock), std::string::npos) << entry.path() << ": " << clock;
    }
}

}  // namespace
}  // namespace octavo
