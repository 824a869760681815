// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/attributes/attributes.h"
#include "octavo/attributes/cell_light.h"
#include "octavo/light/point_text.h"
#include "octavo/trace/dag_view.h"

/// The CPU's side of the shared look-up of cells' looks and light, which CUDA takes as it is.
/// Include this one for C++.
namespace octavo::shared {

/// Words beside those of a DAG.
struct WordArray {
    const uint* at = nullptr;
    int page_shift = 0;  // Vulkan: not 0 where `at` is a table of pages, see dag_view.glsl
    int padding = 0;
};

struct CellView {
    WordArray sums;
    int level = 0;
    int padding = 0;
};
OCTAVO_FN uint cell_sum(CellView cells, uint word) {
    return cells.sums.at[word];
}

struct ValueView {
    WordArray words;
};
OCTAVO_FN uint value_load(ValueView values, uint word) {
    return values.words.at[word];
}

struct LightView {
    WordArray words;
};
OCTAVO_FN uint light_load(LightView light, uint word) {
    return light.words.at[word];
}

}  // namespace octavo::shared

#include "octavo/attributes/cell_rank.h"
#include "octavo/attributes/cell_value.h"
#include "octavo/attributes/srgb.h"

#include "octavo/attributes/cell_looks.h"
#include "octavo/light/cached_light.h"

namespace octavo::shared {

// What is viewed must outlive the view, and have less than 2^32 cells: CellIndex::fits_32_bits().
[[nodiscard]] inline CellView view(const CellIndex& cells) {
    return {{cells.sums().data()}, cells.level()};
}
[[nodiscard]] inline LightView view(const CellLight& light) {
    return {{light.words().data()}};
}
[[nodiscard]] inline int channels_of(const Attributes& attributes) {
    using Channel = Attributes::Channel;
    return (attributes.has(Channel::color) ? kHasColor : 0) |
           (attributes.has(Channel::back) ? kHasBack : 0) |
           (attributes.has(Channel::emission) ? kHasEmission : 0) |
           (attributes.has(Channel::back_emission) ? kHasBackEmission : 0);
}
[[nodiscard]] inline CellLooks view(const Attributes& attributes) {
    using Channel = Attributes::Channel;
    const auto words = [&](Channel which) {
        return ValueView{{attributes.channel(which).words().data()}};
    };
    return {view(attributes.cells()),
            words(Channel::color),
            words(Channel::back),
            words(Channel::emission),
            words(Channel::back_emission),
            channels_of(attributes),
            0};
}

}  // namespace octavo::shared
