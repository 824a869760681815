// SPDX-License-Identifier: MIT
//
// What the cells of a file look like, and their light: the sections behind the DAG, as one array of
// words for the GPU.
import { damaged } from './errors';
import { findValueFault } from './cell_values';
import type { Section } from './directory';
import type { Metadata } from './metadata';
import { type CellSums, bottomLevel } from './cell_sums';

/** Arrays in the order in which they lie, sums first; the shader's numbers of them. */
export const kCellArrays = ['sums', 'ACOL', 'ABCK', 'AEMI', 'AEMB', 'LITE'] as const;
export type CellArray = (typeof kCellArrays)[number];
const kValueBits: Partial<Record<string, number>> = { ACOL: 24, ABCK: 32, AEMI: 32, AEMB: 32 };
const kLightBytes = 24; // for each cell

/** Where each array begins in the words of all of them; undefined where the file has none. */
export interface CellLayout {
    level: number;
    words: number;
    begins: (number | undefined)[]; // as kCellArrays
}

export interface CellPlan {
    layout: CellLayout;
    sections: Section[]; // to be read, in their order in the file
}

/**
 * Which sections to read, so that they take no more than so many bytes: colours and emission, then
 * light. Undefined where there are none, or none fits.
 */
export function planCells(sections: Section[], metadata: Metadata, mostBytes: number): CellPlan | undefined {
    const level = metadata.attributes?.level;
    if (level === undefined || metadata.words === 0) return undefined;
    const sumWords = metadata.levels.slice(0, bottomLevel(level, metadata.grid.depth)).reduce((sum, l) => sum + l.words, 0);
    const begins: (number | undefined)[] = [0];
    const chosen: Section[] = [];
    let words = sumWords;
    for (const id of kCellArrays.slice(1)) {
        const section = sections.find((other) => other.id === id);
        const fits = section && section.rawBytes % 4 === 0 && 4 * words + section.rawBytes <= mostBytes;
        if (section && section.rawBytes % 4 !== 0) throw damaged(`Section ${id} is not a whole number of words.`);
        if (section && !fits && id !== 'LITE') return undefined;
        begins.push(fits ? words : undefined);
        if (!fits) continue;
        words += section.rawBytes / 4;
        chosen.push(section);
    }
    if (chosen.length === 0) return undefined;
    chosen.sort((a, b) => a.offset - b.offset);
    return { layout: { level, words, begins }, sections: chosen };
}

/** @throws FileFault damaged, where a value of a cell could not be read */
export function checkCellSection(section: Section, words: Uint32Array, { cells }: CellSums): void {
    const { id } = section;
    const bits = kValueBits[id];
    if (bits === undefined) {
        if (section.rawBytes !== kLightBytes * cells) throw damaged(`Section ${id} does not have ${kLightBytes} bytes for each cell.`);
        return;
    }
    const fault = findValueFault(words, cells, bits);
    if (fault) throw damaged(`Section ${id} is damaged: ${fault}.`);
}
