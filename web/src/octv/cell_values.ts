// SPDX-License-Identifier: MIT
//
// Sections with one value for each cell: are all of them safe to read? As CellValues::find_fault() of
// the library; docs/file-format.md has the layout.

const kBlockCells = 256;
const kHeaderWords = 2;
const kRaw = 255;
const kMostPalette = 256;

/** @returns what is wrong, and at which word; undefined where each of the cells has a value */
export function findValueFault(words: Uint32Array, cells: number, valueBits: number): string | undefined {
    const blocks = Math.ceil(cells / kBlockCells);
    const at = (word: number, what: string): string => `${what} (word ${word})`;
    if (words.length < kHeaderWords + blocks) return at(words.length, 'the table of blocks is cut off');
    if (words[0] !== valueBits) return at(0, 'the values have another number of bits');
    if (words[1] !== blocks) return at(1, 'the number of blocks is not that of the cells');
    const data = kHeaderWords + blocks;
    for (let block = 0; block < blocks; block += 1) {
        const begin = words[kHeaderWords + block]!;
        if (begin === 0) continue;
        if (begin < data || begin >= words.length) return at(kHeaderWords + block, 'a block begins outside the data');
        const room = 32 * (words.length - begin - 1);
        const count = Math.min(kBlockCells, cells - block * kBlockCells);
        const indexBits = words[begin]! & 255;
        const palette = words[begin]! >>> 8;
        if (indexBits === kRaw) {
            if (palette !== 0) return at(begin, 'a block without a palette states one');
            if (count * valueBits > room) return at(begin, 'a block reaches past the end');
            continue;
        }
        if (indexBits > 8 || palette === 0 || palette > kMostPalette) return at(begin, 'a block has an unknown form');
        if (palette * valueBits + count * indexBits > room) return at(begin, 'a block reaches past the end');
        if (palette >= 1 << indexBits) continue;
        for (let i = 0; i < count; i += 1) {
            if (bitsAt(words, begin + 1, palette * valueBits + i * indexBits, indexBits) >= palette) {
                return at(begin, 'an index is past the end of its palette');
            }
        }
    }
    return undefined;
}

/** `count` bits, 0 to 32, from a bit offset behind a word. */
function bitsAt(words: Uint32Array, word: number, offset: number, count: number): number {
    if (count === 0) return 0;
    const at = word + Math.floor(offset / 32);
    const shift = offset % 32;
    let low = words[at]! >>> shift;
    if (shift + count > 32) low |= words[at + 1]! << (32 - shift);
    return count === 32 ? low >>> 0 : (low & ((1 << count) - 1)) >>> 0;
}

/** The value of a cell, of words without a fault. */
export function cellValue(words: Uint32Array, cell: number): number {
    const block = words[kHeaderWords + Math.floor(cell / kBlockCells)]!;
    if (block === 0) return 0;
    const width = words[0]!;
    const indexBits = words[block]! & 255;
    const inBlock = cell % kBlockCells;
    if (indexBits === kRaw) return bitsAt(words, block + 1, inBlock * width, width);
    const index = bitsAt(words, block + 1, (words[block]! >>> 8) * width + inBlock * indexBits, indexBits);
    return bitsAt(words, block + 1, index * width, width);
}
