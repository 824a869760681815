// SPDX-License-Identifier: MIT
//
// Where the words beside those of a DAG lie in Vulkan, and the pixels of a sky: as the structs of
// light/cell_views.h and light/sky.h. Include after dag_view.glsl.

struct WordArray {
    DagWords at;     // or, with pages, the address of their table
    int page_shift;  // words of a page, as a power of two; 0: no pages
    int padding;
};

uint word_load(WordArray words, uint word) {
    if (words.page_shift == 0) return words.at.at[word];
    DagPages pages = DagPages(words.at);
    return pages.page[word >> words.page_shift].at[word & ((1u << words.page_shift) - 1u)];
}

struct CellView {
    WordArray sums;
    int level;
    int padding;
};
uint cell_sum(CellView cells, uint word) {
    return word_load(cells.sums, word);
}

struct ValueView {
    WordArray words;
};
uint value_load(ValueView values, uint word) {
    return word_load(values.words, word);
}

struct LightView {
    WordArray words;
};
uint light_load(LightView light, uint word) {
    return word_load(light.words, word);
}

OCTAVO_ARRAY(SkyPixelArray, vec3)

struct SkyPixels {
    SkyPixelArray pixels;
};
vec3 sky_pixel(SkyPixels pixels, int number) {
    return pixels.pixels.at[number];
}
