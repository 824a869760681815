// SPDX-License-Identifier: MIT
//
// Reads an .octv file from its beginning to its end, checks it level by level, and hands on what has
// passed. Any bytes give levels that are safe to trace, or a FileFault.
import { createXXHash3, type IHasher } from 'hash-wasm';
import { ZSTDDecoder } from 'zstddec';
import { bottomLevel, cellSums } from './cell_sums';
import { type CellLayout, type CellPlan, checkCellSection, kCellArrays, planCells } from './cells';
import { type CellBox, contentBounds, kBoundsLevel } from './content_bounds';
import { type Section, kPageBytes, readDirectory } from './directory';
import { FileFault, damaged } from './errors';
import { LevelChecker } from './level_check';
import { kMaxMetadataBytes, type Metadata, readMetadata } from './metadata';
import type { ByteSource } from './source';

const kMetadataSection = 'META';
const kDagSection = 'DAG ';
const kPieceBytes = 4 * 1024 * 1024;
/** A zstd frame is decompressed as a whole, inside a module of 32-bit addresses. */
const kMaxCompressedBytes = 1024 * 1024 * 1024;

export interface FileFacts {
    metadata: Metadata;
    fileBytes: number;
    compressed: boolean;
}

/** What the reader tells, in this order: opened, then per level words and level, and bounds; then cells. */
export interface Listener {
    opened(facts: FileFacts): void;
    /** Bytes of the file that have come. */
    progress(bytes: number): void;
    /** The next words of the DAG; the listener may keep the array. */
    words(words: Uint32Array<ArrayBuffer>): void;
    /** This level is there: rays may go down to its nodes. */
    level(level: number): void;
    /** Where voxels are; again when it is known better. */
    bounds(box: CellBox): void;
    /** Colours and light of cells follow: room for so many words. */
    cells(layout: CellLayout): void;
    /** The next of these words, from the first on. */
    cellWords(words: Uint32Array<ArrayBuffer>): void;
    /** All of them are there. */
    cellsReady(): void;
    /** The file has colours or light that are not read, and why. */
    cellsLeftOut(why: string): void;
}

export interface ReadOptions {
    /** Bytes that the scene may take: the levels that do not fit are left out, then the cells. */
    maxDagBytes: number;
}

/** The number of levels, from the root, whose words fit. */
export function levelsThatFit(metadata: Metadata, maxBytes: number): number {
    let bytes = 0;
    let fitting = 0;
    for (const level of metadata.levels.slice(0, metadata.grid.depth - 1)) {
        bytes += 4 * level.words;
        if (bytes > maxBytes) break;
        fitting += 1;
    }
    return fitting;
}

async function readAll(source: ByteSource, offset: number, length: number, what: string): Promise<Uint8Array<ArrayBuffer>> {
    const bytes = await source.read(offset, length);
    if (bytes.length !== length) throw damaged(`The file is cut off inside ${what}.`);
    return bytes;
}

/** The stored bytes of a section, piece by piece, with their checksum compared at the end. */
class SectionReader {
    private at = 0;
    private constructor(
        private readonly source: ByteSource,
        private readonly section: Section,
        private readonly hash: IHasher,
        private readonly progress: (bytes: number) => void,
    ) {
        hash.init();
    }
    static async open(source: ByteSource, section: Section, progress: (bytes: number) => void): Promise<SectionReader> {
        return new SectionReader(source, section, await createXXHash3(), progress);
    }

    async read(length: number): Promise<Uint8Array<ArrayBuffer>> {
        const bytes = new Uint8Array(length);
        for (let done = 0; done < length; ) {
            const count = Math.min(kPieceBytes, length - done);
            const offset = this.section.offset + this.at;
            const piece = await readAll(this.source, offset, count, `section ${this.section.id.trim()}`);
            bytes.set(piece, done);
            this.hash.update(piece);
            done += count;
            this.at += count;
            this.progress(this.section.offset + this.at);
        }
        if (this.at === this.section.storedBytes) this.compare();
        return bytes;
    }

    private compare(): void {
        if (BigInt(`0x${this.hash.digest('hex')}`) !== this.section.checksum) {
            throw damaged(`Section ${this.section.id.trim()} does not have the checksum that it was written with.`);
        }
    }
}

async function decompress(frame: Uint8Array, section: Section): Promise<Uint8Array> {
    const name = section.id.trim();
    const decoder = new ZSTDDecoder();
    await decoder.init();
    let raw: Uint8Array;
    try {
        raw = decoder.decode(frame, section.rawBytes);
    } catch {
        throw damaged(`Section ${name} does not decompress.`);
    }
    if (raw.length !== section.rawBytes) throw damaged(`Section ${name} does not decompress to its stated size.`);
    return raw;
}

/** Gives the raw bytes of a section in order. */
type RawReader = (length: number) => Promise<Uint8Array>;

async function openSection(source: ByteSource, section: Section, most: number, progress: (bytes: number) => void): Promise<RawReader> {
    const reader = await SectionReader.open(source, section, progress);
    if (!section.compressed) return (length) => reader.read(length);
    if (section.rawBytes > most) {
        throw new FileFault('limit', `The file is compressed, and its ${section.rawBytes} bytes do not fit in a page's memory; write it uncompressed.`);
    }
    const raw = await decompress(await reader.read(section.storedBytes), section);
    let at = 0;
    return async (length) => raw.slice(at, (at += length));
}

function findSection(sections: Section[], id: string): Section {
    const section = sections.find((other) => other.id === id);
    if (!section) throw damaged(`Section ${id.trim()} is missing.`);
    return section;
}

async function checkDirectory(checked: Uint8Array, checksum: bigint): Promise<void> {
    const hash = await createXXHash3();
    hash.init();
    hash.update(checked);
    if (BigInt(`0x${hash.digest('hex')}`) !== checksum) {
        throw damaged('The header does not have the checksum that it was written with.');
    }
}

/** @throws FileFault */
export async function readOctv(source: ByteSource, listener: Listener, options: ReadOptions): Promise<void> {
    const page = await source.read(0, kPageBytes);
    const directory = readDirectory(page, source.size, [kMetadataSection, kDagSection]);
    await checkDirectory(directory.checked, directory.checksum);

    const meta = findSection(directory.sections, kMetadataSection);
    const dag = findSection(directory.sections, kDagSection);
    if (meta.rawBytes > kMaxMetadataBytes || meta.storedBytes > kMaxMetadataBytes) throw damaged('The metadata is larger than 16 MiB.');
    if (meta.offset > dag.offset) throw damaged('The metadata comes after the DAG.');
    const readMeta = await openSection(source, meta, kMaxMetadataBytes, () => {});
    const metadata = readMetadata(await readMeta(meta.rawBytes));
    if (dag.rawBytes !== 4 * metadata.words) {
        throw damaged(`The DAG has ${dag.rawBytes} bytes where the metadata states ${4 * metadata.words}.`);
    }
    listener.opened({ metadata, fileBytes: directory.fileBytes, compressed: dag.compressed });
    const wanted = levelsThatFit(metadata, options.maxDagBytes);
    if (metadata.words > 0 && wanted > 0) {
        const progress = (bytes: number): void => listener.progress(bytes);
        const read = await openSection(source, dag, kMaxCompressedBytes, progress);
        const all = wanted === metadata.grid.depth - 1;
        const plan = all ? planCells(directory.sections, metadata, options.maxDagBytes - 4 * metadata.words) : undefined;
        const top = await readLevels(read, metadata, wanted, listener, plan && bottomLevel(plan.layout.level, metadata.grid.depth));
        const light = directory.sections.some(({ id }) => id === 'LITE');
        if (plan) await readCells(source, plan, top, metadata, listener);
        else if (metadata.attributes) listener.cellsLeftOut('Colours are left out: they do not fit in the GPU memory of the settings');
        if (plan && light && plan.layout.begins[kCellArrays.indexOf('LITE')] === undefined) {
            listener.cellsLeftOut('Stored light is left out: it does not fit in the GPU memory of the settings');
        }
    }
    listener.progress(directory.fileBytes);
}

/** @param keep  levels from the root to this one are returned */
async function readLevels(read: RawReader, metadata: Metadata, wanted: number, listener: Listener, keep = -1): Promise<Uint32Array[]> {
    const { depth } = metadata.grid;
    const leafLevel = depth - 2;
    const checker = new LevelChecker(metadata.levels, leafLevel);
    const top: Uint32Array[] = [];
    const kept: Uint32Array[] = [];
    for (let level = 0; level < wanted; level += 1) {
        const bytes = await read(4 * metadata.levels[level]!.words);
        const words = new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
        checker.add(words);
        for (let at = 0; at < words.length; at += kPieceBytes / 4) {
            listener.words(words.slice(at, at + kPieceBytes / 4));
        }
        listener.level(level);
        if (level < kBoundsLevel) {
            top.push(words);
            const box = contentBounds({ depth, levels: top });
            if (box) listener.bounds(box);
        }
        if (level <= keep) kept.push(words);
    }
    return kept;
}

/** Reads the sections behind the DAG; each is checked as a whole before any of it is handed on. */
async function readCells(source: ByteSource, plan: CellPlan, top: Uint32Array[], metadata: Metadata, listener: Listener): Promise<void> {
    const numbered = cellSums(top, metadata.grid.depth, plan.layout.level);
    if (!numbered) return listener.cellsLeftOut('Colours are left out: the scene has more cells than a browser can number');
    if (numbered.cells !== metadata.attributes!.cells) {
        throw damaged(`The file states attributes of ${metadata.attributes!.cells} cells, and its DAG has ${numbered.cells}.`);
    }
    listener.cells(plan.layout);
    const hand = (words: Uint32Array): void => {
        for (let at = 0; at < words.length; at += kPieceBytes / 4) listener.cellWords(words.slice(at, at + kPieceBytes / 4) as Uint32Array<ArrayBuffer>);
    };
    hand(numbered.sums);
    for (const section of plan.sections) {
        const read = await openSection(source, section, kMaxCompressedBytes, (bytes) => listener.progress(bytes));
        const bytes = await read(section.rawBytes);
        const words = new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
        checkCellSection(section, words, numbered);
        hand(words);
    }
    listener.cellsReady();
}
