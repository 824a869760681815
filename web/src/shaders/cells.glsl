// The words beside those of the DAG in this backend: what cells look like and their light, one array
// behind the other in the layers of a texture. Include after dag.glsl.
uniform usampler2DArray cell_words;
uniform int cell_level;       // whose cells have looks; 0: none do
uniform int cell_has;         // the arrays that are there: of cell_looks.h
uniform uint cell_begins[6];  // sums, colour, back, emission, back's emission, light

uint cell_load(uint word) {
    const uint mask = (1u << ROW_BITS) - 1u;
    ivec3 at = ivec3(word & mask, (word >> ROW_BITS) & mask, word >> (2 * ROW_BITS));
    return texelFetch(cell_words, at, 0).x;
}

struct CellView {
    uint begin;
    int level;
};
uint cell_sum(CellView cells, uint word) {
    return cell_load(cells.begin + word);
}

struct ValueView {
    uint begin;
};
uint value_load(ValueView values, uint word) {
    return cell_load(values.begin + word);
}

struct LightView {
    uint begin;
};
uint light_load(LightView light, uint word) {
    return cell_load(light.begin + word);
}
