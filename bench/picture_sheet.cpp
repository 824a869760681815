// SPDX-License-Identifier: MIT
//
// Puts pictures side by side. usage: picture_sheet OUT.png COLUMNS EXPOSURE A.exr B.exr ...
//
// Row by row, with a line between; all are as large as the first.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "octavo/core/error.h"
#include "octavo/light/sky.h"
#include "octavo/render/image.h"

namespace {

using namespace octavo;

constexpr int kLine = 2;  // pixels between pictures

void run(int argc, char** argv) {
    const int columns = std::atoi(argv[2]);
    if (columns < 1) throw Error(Errc::bad_argument, "there is at least one column");
    const int count = argc - 4;
    const int rows = (count + columns - 1) / columns;
    Image sheet;
    for (int i = 0; i < count; ++i) {
        const SkyImage picture = load_sky_image(argv[4 + i]);
        if (i == 0) {
            sheet = Image(columns * (picture.width + kLine) - kLine,
                          rows * (picture.height + kLine) - kLine);
            sheet.color.assign(sheet.color.size(), vec3(1e3f));
        }
        const int x0 = i % columns * (picture.width + kLine);
        const int y0 = i / columns * (picture.height + kLine);
        if (x0 + picture.width > sheet.width || y0 + picture.height > sheet.height)
            throw Error(Errc::bad_argument, std::string(argv[4 + i]) + " has another size");
        std::size_t from = 0;
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x)
                sheet.color[sheet.index(x0 + x, y0 + y)] = picture.color[from++];
    }
    write_image(argv[1], sheet, std::atof(argv[3]));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 5) {
        std::fprintf(stderr, "usage: picture_sheet OUT.png COLUMNS EXPOSURE A.exr B.exr ...\n");
        return 2;
    }
    try {
        run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "picture_sheet: %s\n", error.what());
        return 3;
    }
    return 0;
}
