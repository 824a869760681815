// SPDX-License-Identifier: MIT
//
// Is it safe to follow the pointers of a level? Levels come one after the other, from the root; the
// pointers of one are checked when the next has come. Visits nodes, never paths.
import { damaged } from './errors';
import type { Level } from './metadata';

/** One bit for each word of a level: does a node begin there? */
class Starts {
    private readonly bits: Uint32Array;
    constructor(words: number) {
        this.bits = new Uint32Array(Math.ceil(words / 32));
    }
    add(word: number): void {
        this.bits[word >>> 5]! |= 1 << (word & 31);
    }
    has(word: number): boolean {
        return ((this.bits[word >>> 5]! >>> (word & 31)) & 1) === 1;
    }
}

export function countBits8(mask: number): number {
    const pairs = mask - ((mask >> 1) & 0x55);
    const fours = (pairs & 0x33) + ((pairs >> 2) & 0x33);
    return (fours + (fours >> 4)) & 0x0f;
}

export class LevelChecker {
    private level = 0;
    private begin = 0; // of the level that comes next, in words of the file
    private above: Uint32Array | undefined; // the level before it, whose pointers wait
    private aboveBegin = 0;

    constructor(
        private readonly levels: Level[],
        private readonly leafLevel: number,
    ) {}

    /**
     * Checks the next level, and that all pointers of the one above lead to nodes of it.
     *
     * @throws FileFault damaged, with the word's number in the DAG
     */
    add(words: Uint32Array): void {
        const stated = this.levels[this.level]!;
        if (words.length !== stated.words) throw damaged(`Level ${this.level} is incomplete.`);
        const leaves = this.level === this.leafLevel;
        const starts = leaves ? undefined : new Starts(words.length);
        const nodes = leaves ? this.countLeaves(words) : this.countNodes(words, starts!);
        if (nodes !== stated.dagNodes) {
            throw damaged(`Level ${this.level} has ${nodes} nodes where ${stated.dagNodes} are stated.`);
        }
        this.checkPointers(words.length, starts);
        this.above = leaves ? undefined : words;
        this.aboveBegin = this.begin;
        this.begin += words.length;
        this.level += 1;
    }

    private fault(word: number, what: string): never {
        throw damaged(`${what} (word ${word} of the DAG).`);
    }

    private countLeaves(words: Uint32Array): number {
        for (let i = 0; i < words.length; i += 2) {
            if ((words[i]! | words[i + 1]!) === 0) this.fault(this.begin + i, 'There is a leaf without voxels');
        }
        return words.length / 2;
    }

    private countNodes(words: Uint32Array, starts: Starts): number {
        let nodes = 0;
        for (let i = 0; i < words.length; nodes += 1) {
            const mask = words[i]!;
            if (mask > 255) this.fault(this.begin + i, 'Spare bits of a node are not zero');
            if (mask === 0) this.fault(this.begin + i, 'There is a node without children');
            starts.add(i);
            const next = i + 1 + countBits8(mask);
            if (next > words.length) this.fault(this.begin + i, 'A node reaches past the end of its level');
            i = next;
        }
        return nodes;
    }

    private checkPointers(nextWords: number, starts: Starts | undefined): void {
        const words = this.above;
        if (!words) return;
        for (let i = 0; i < words.length; ) {
            const end = i + 1 + countBits8(words[i]!);
            for (i += 1; i < end; i += 1) {
                const at = words[i]! - this.begin;
                if (at < 0 || at >= nextWords) this.fault(this.aboveBegin + i, 'A pointer leads outside the next level');
                if (starts ? !starts.has(at) : (at & 1) !== 0) {
                    this.fault(this.aboveBegin + i, 'A pointer leads into the middle of a node');
                }
            }
        }
    }
}
