// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/attributes/cell_index.h"
#include "octavo/attributes/cell_light.h"
#include "octavo/light/point_text.h"
#include "octavo/trace/dag_view.h"

/// The CPU's side of the shared look-up of cells' light. Include this one for C++.
namespace octavo::shared {

struct CellView {
    const uint* sums = nullptr;
    int level = 0;
};
inline uint cell_sum(CellView cells, uint word) {
    return cells.sums[word];
}

struct LightView {
    const uint* words = nullptr;
};
inline uint light_load(LightView light, uint word) {
    return light.words[word];
}

/// Both must outlive the view.
[[nodiscard]] inline CellView view(const CellIndex& cells) {
    return {cells.sums().data(), cells.level()};
}
[[nodiscard]] inline LightView view(const CellLight& light) {
    return {light.words().data()};
}

}  // namespace octavo::shared

#include "octavo/attributes/cell_rank.h"

#include "octavo/light/cell_light.h"
