// SPDX-License-Identifier: MIT
//
// Where the words of a DAG lie in Vulkan: behind one address, or, of a DAG that is larger than one
// buffer may be, in pages of 2^kPageShift words whose addresses stand in a table. The shift is known
// when a pipeline is made, as the loads of a ray are what its time goes into.

layout(constant_id = 0) const int kPageShift = 0;  // 0: no pages

OCTAVO_ARRAY(DagWords, uint)

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DagPages {
    DagWords page[];
};

struct DagView {
    DagWords words;  // or, with pages, the address of their table
    int depth;
    int padding;  // as in C++
};

uint dag_load(DagView dag, uint word) {
    if (kPageShift == 0) return dag.words.at[word];
    DagPages pages = DagPages(dag.words);
    return pages.page[word >> kPageShift].at[word & ((1u << kPageShift) - 1u)];
}
