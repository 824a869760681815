// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>

#include "octavo/core/parallel.h"
#include "octavo/core/progress_counter.h"
#include "octavo/render/render.h"

namespace octavo {

/// Pixels of a picture that are drawn at once: [low, high).
struct PictureTile {
    static constexpr int kSide = 8;  // [K13] uses beams of 8x8

    ivec2 low, high;
};

/// Draws a picture tile by tile on all threads: calls draw(tile, kept, image), where `kept` is
/// what one thread keeps from tile to tile.
/// @param reports  how often at most progress is told
template <class Kept, class Draw>
[[nodiscard]] Image draw_tiles(const RenderOptions& options, std::uint64_t reports,
                               const Draw& draw) {
    constexpr int kSide = PictureTile::kSide;
    const ivec2 size(options.width, options.height);
    const ivec2 tiles = (size + kSide - 1) / kSide;
    Image image(size.x, size.y);
    tbb::enumerable_thread_specific<Kept> kept;
    ProgressCounter progress(options.progress, "render", image.color.size(), reports);
    with_threads(options.threads, [&] {
        tbb::parallel_for(tbb::blocked_range<int>(0, tiles.x * tiles.y, 4), [&](const auto& some) {
            for (int t = some.begin(); t != some.end(); ++t) {
                const ivec2 low = kSide * ivec2(t % tiles.x, t / tiles.x);
                const PictureTile tile{low, glm::min(low + kSide, size)};
                draw(tile, kept.local(), image);
                const ivec2 pixels = tile.high - tile.low;
                progress.add(static_cast<unsigned>(pixels.x * pixels.y));
            }
        });
    });
    return image;
}

}  // namespace octavo
