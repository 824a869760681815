// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/dag/dag.h"
#include "octavo/trace/shared_text.h"

/// The CPU's side of the shared text: where the words of the DAG lie. Include this one for C++.
namespace octavo::shared {

struct DagView {
    const uint* words = nullptr;
    int depth = 0;
};

OCTAVO_FN uint dag_load(DagView dag, uint word) {
    return dag.words[word];
}

/// The DAG must outlive the view.
[[nodiscard]] inline DagView view(const octavo::Dag& dag) {
    return {dag.words().data(), dag.empty() ? 0 : dag.depth()};
}

}  // namespace octavo::shared

#include "octavo/trace/traverse.h"

#include "octavo/trace/beam.h"
