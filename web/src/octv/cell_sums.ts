// SPDX-License-Identifier: MIT
//
// The numbers of a level's occupied cells: octavo::CellIndex. Beside each word of the levels above the
// last node of a path: at a pointer, the cells beneath the pointers before it in the same node; at a
// node's mask, the cells beneath the node.
import { countBits8 } from './level_check';

/** 2^32 - 1 of them do not fit the shader's words. */
export const kMostCells = 0xffffffff - 1;

export interface CellSums {
    sums: Uint32Array<ArrayBuffer>;
    cells: number;
}

/** The level of the last node on the way to a cell of this level: its cells are bits of that node. */
export function bottomLevel(level: number, depth: number): number {
    return Math.min(level - 1, depth - 2);
}

function countBits32(word: number): number {
    return countBits8(word & 255) + countBits8((word >>> 8) & 255) + countBits8((word >>> 16) & 255) + countBits8(word >>> 24);
}

/** Which 2x2x2 children of a leaf hold a voxel: how many. */
function leafChildren(low: number, high: number): number {
    let count = 0;
    for (const word of [low, high]) for (let i = 0; i < 32; i += 8) count += ((word >>> i) & 255) !== 0 ? 1 : 0;
    return count;
}

/**
 * @param levels  checked words from the root to the bottom level, each as it lies in the file
 * @returns       undefined where there are more than kMostCells
 */
export function cellSums(levels: Uint32Array[], depth: number, level: number): CellSums | undefined {
    const bottom = bottomLevel(level, depth);
    const begins: number[] = [];
    levels.reduce((begin, words) => (begins.push(begin), begin + words.length), 0);
    const ofBottom = (words: Uint32Array, at: number): number => {
        if (bottom < depth - 2) return countBits8(words[at]!);
        const [low, high] = [words[at]!, words[at + 1]!];
        return level === depth ? countBits32(low) + countBits32(high) : leafChildren(low, high);
    };
    if (bottom === 0) return { sums: new Uint32Array(0), cells: ofBottom(levels[0]!, 0) };

    const sums = new Uint32Array(begins[bottom]!);
    for (let l = bottom - 1; l >= 0; l -= 1) {
        const words = levels[l]!;
        const begin = begins[l]!;
        const below = levels[l + 1]!;
        const belowBegin = begins[l + 1]!;
        for (let node = 0; node < words.length; ) {
            const size = 1 + countBits8(words[node]!);
            let cells = 0;
            for (let i = 1; i < size; i += 1) {
                sums[begin + node + i] = cells;
                const child = words[node + i]!;
                cells += l + 1 === bottom ? ofBottom(below, child - belowBegin) : sums[child]!;
                if (cells > kMostCells) return undefined;
            }
            sums[begin + node] = cells;
            node += size;
        }
    }
    return { sums, cells: sums[0]! };
}
