// The DAG of this backend: its words in the rows and layers of a texture. ROW_BITS: of a row's
// length, and of a layer's number of rows.
uniform usampler2DArray dag_words;

struct DagView {
    int depth;
};

uint dag_load(DagView dag, uint word) {
    const uint mask = (1u << ROW_BITS) - 1u;
    ivec3 at = ivec3(word & mask, (word >> ROW_BITS) & mask, word >> (2 * ROW_BITS));
    return texelFetch(dag_words, at, 0).x;
}
