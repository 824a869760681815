// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { cellSums } from '../../src/octv/cell_sums';
import { cellValue, findValueFault } from '../../src/octv/cell_values';
import type { CellLayout } from '../../src/octv/cells';
import type { CellBox } from '../../src/octv/content_bounds';
import { FileFault } from '../../src/octv/errors';
import { type FileFacts, levelsThatFit, readOctv } from '../../src/octv/reader';
import { MemorySource, StreamSource, openUrl } from '../../src/octv/source';
import type { ByteSource } from '../../src/octv/source';
import { type Bytes, colouredFile, exampleFile, resealed, withMetadata, withWords } from './octv_file';

interface Read {
    facts?: FileFacts;
    words: number[];
    levels: number[];
    box?: CellBox;
    layout?: CellLayout;
    cellWords: number[];
    events: string[];
}

async function read(source: ByteSource | Bytes, maxDagBytes = Infinity): Promise<Read> {
    const result: Read = { words: [], levels: [], cellWords: [], events: [] };
    await readOctv(
        source instanceof Uint8Array ? new MemorySource(source) : source,
        {
            opened: (facts) => ((result.facts = facts), result.events.push('opened')),
            progress: () => {},
            words: (words) => (result.words.push(...words), result.events.push('words')),
            level: (level) => (result.levels.push(level), result.events.push(`level ${level}`)),
            bounds: (box) => (result.box = box),
            cells: (layout) => (result.layout = layout),
            cellWords: (words) => result.cellWords.push(...words),
            cellsReady: () => result.events.push('cells'),
            cellsLeftOut: (why) => result.events.push(why),
        },
        { maxDagBytes },
    );
    return result;
}

async function fault(bytes: Bytes): Promise<FileFault> {
    return read(bytes).then(
        () => Promise.reject(new Error('the file was taken')),
        (error) => {
            expect(error).toBeInstanceOf(FileFault);
            return error as FileFault;
        },
    );
}

describe('the worked example', () => {
    it('is read as it is documented', async () => {
        const { facts, words, levels, box } = await read(exampleFile());
        expect(facts!.metadata.grid).toEqual({ origin: [-1, 0.5, 2], voxelSize: 0.1, depth: 3 });
        expect(facts!.metadata.voxels).toBe(4);
        expect(words).toEqual([0x81, 3, 5, 0x13, 0, 0, 0x80000000]);
        expect(levels).toEqual([0, 1]);
        expect(box).toEqual({ low: [0, 0, 0], high: [8, 8, 8] });
    });
    it('comes level by level, each after its words', async () => {
        expect((await read(exampleFile())).events).toEqual(['opened', 'words', 'level 0', 'words', 'level 1']);
    });
    it('stops at the levels that fit', async () => {
        const { metadata } = (await read(exampleFile())).facts!;
        expect([0, 11, 12, 27, 28].map((bytes) => levelsThatFit(metadata, bytes))).toEqual([0, 0, 1, 1, 2]);
        const { words, levels } = await read(exampleFile(), 12);
        expect(words).toEqual([0x81, 3, 5]);
        expect(levels).toEqual([0]);
    });
});

describe('damage', () => {
    it('never passes, whichever byte is changed', async () => {
        const sizes = [0, 160, 0x1000, 0x1146, 0x2000, 0x201c];
        for (let k = 0; k < sizes.length; k += 2) {
            for (let at = sizes[k]!; at < sizes[k + 1]!; at += 1) {
                const bytes = exampleFile();
                bytes[at]! ^= 1 << at % 8;
                await fault(bytes);
            }
        }
    });
    it('of the length is named', async () => {
        for (const size of [0, 8, 63, 64, 100, 4096, 8000, 8219]) {
            expect((await fault(exampleFile().slice(0, size))).kind).toBe('damaged');
        }
        const longer = new Uint8Array(9000);
        longer.set(exampleFile());
        expect((await fault(longer)).message).toContain('too long');
    });
    it.each<[string, Record<number, number>, string]>([
        ['a pointer outside', { 1: 7 }, 'outside the next level'],
        ['a pointer upwards', { 1: 0 }, 'outside the next level'],
        ['a huge pointer', { 1: 0xffffffff }, 'outside the next level'],
        ['a pointer into a node', { 1: 4 }, 'middle of a node'],
        ['spare bits', { 0: 0x181 }, 'Spare bits'],
        ['a node without children', { 0: 0 }, 'without children'],
        ['a node too long', { 0: 0xff }, 'past the end'],
        ['a second node beside the root', { 0: 0x01 }, 'past the end'],
        ['an empty leaf', { 3: 0 }, 'leaf without voxels'],
    ])('of nodes is found: %s', async (_, words, message) => {
        expect((await fault(await withWords(words))).message).toMatch(new RegExp(message));
    });
    it.each<[string, string]>([
        ['"depth":3', '"depth":2'],
        ['"depth":3', '"depth":9'],
        ['"voxel_size":0.1', '"voxel_size":0'],
        ['"voxel_size":0.1', '"voxel_size":"'],
        ['"words":4', '"words":5'],
        ['"words":4', '"words":-'],
        ['"dag_nodes":2,"words":4', '"dag_nodes":3,"words":4'],
        ['"dag_nodes":1', '"dag_nodes":2'],
        ['"levels":[', '"levels":{'],
        ['"cameras":[]', '"cameras":{}'],
        ['"cameras":[]', '"cameras":[1'],
        ['"voxels":4', '"voxels":"'],
        ['"source"', '"sourc_"'],
    ])('of the metadata is found: %s → %s', async (from, to) => {
        expect((await fault(await withMetadata(from, to))).kind).toBe('damaged');
    });
    it('of the table is found', async () => {
        const changes: [string, (view: DataView) => void][] = [
            ['too many sections', (view) => view.setUint32(24, 85, true)],
            ['comes twice', (view) => view.setUint32(112, view.getUint32(64, true), true)],
            ['page of its own', (view) => view.setBigUint64(120, 0x1000n, true)],
            ['page of its own', (view) => view.setBigUint64(120, 0x2001n, true)],
            ['past the end', (view) => view.setBigUint64(120, 0x100000n, true)],
            ['two sizes', (view) => view.setBigUint64(136, 32n, true)],
            ['larger than any file', (view) => view.setBigUint64(136, 2n ** 63n, true)],
            ['unknown flags', (view) => view.setUint32(116, 5, true)],
        ];
        for (const [message, change] of changes) {
            const bytes = exampleFile();
            change(new DataView(bytes.buffer));
            const found = await fault(bytes);
            expect(found.kind, message).toBe('damaged');
        }
    });
    it('is told from a newer file', async () => {
        const newer = exampleFile();
        newer[8] = 2;
        expect((await fault(await resealed(newer))).kind).toBe('unsupported');
        const section = exampleFile();
        section.set(new TextEncoder().encode('ABCD'), 112);
        expect((await fault(await resealed(section))).kind).toBe('unsupported');
    });
});

describe('sources', () => {
    const bytes = exampleFile();
    const answering = (answer: (range: string | null) => Response): typeof fetch =>
        (async (_: unknown, init?: RequestInit) => answer(new Headers(init?.headers).get('Range'))) as typeof fetch;
    const ranged = answering((range) => {
        const [from, to] = /bytes=(\d+)-(\d+)/.exec(range!)!.slice(1).map(Number) as [number, number];
        const last = Math.min(to, bytes.length - 1);
        return new Response(bytes.slice(from, last + 1), {
            status: 206,
            headers: { 'Content-Range': `bytes ${from}-${last}/${bytes.length}` },
        });
    });

    it('reads by ranges', async () => {
        expect((await read(await openUrl('x', ranged))).levels).toEqual([0, 1]);
    });
    it('reads from a server that knows no ranges', async () => {
        expect((await read(await openUrl('x', answering(() => new Response(bytes))))).levels).toEqual([0, 1]);
    });
    it('reads a stream that comes in drops', async () => {
        let at = 0;
        const reader = new ReadableStream<Uint8Array>({
            pull(controller) {
                if (at >= bytes.length) return controller.close();
                controller.enqueue(bytes.slice(at, (at += 97)));
            },
        }).getReader();
        expect((await read(new StreamSource(reader, undefined, new AbortController()))).words.length).toBe(7);
    });
    it('says so where nothing answers', async () => {
        const missing = openUrl('x', answering(() => new Response('', { status: 404 })));
        await expect(missing).rejects.toMatchObject({ kind: 'unreachable' });
        const dead = openUrl('x', (() => Promise.reject(new TypeError('network'))) as typeof fetch);
        await expect(dead).rejects.toMatchObject({ kind: 'unreachable' });
    });
});

describe('colours and light', () => {
    // The example's four voxels at level 3, and level 2, where there are three cells.
    const colors = [24, 1, 3, 255, 0x00112233, 0x55_66_77_44, 0x99aabb88 & 0xffffff];
    const light = Array.from({ length: 24 }, (_, i) => (i % 5 === 0 ? 0xf8000000 : i));
    const file = (sections: Record<string, number[]>, level = 3, cells = 4): Promise<Bytes> => colouredFile(sections, level, cells);

    it('of an .octv file come behind its levels', async () => {
        const { events, layout, cellWords } = await read(await file({ ACOL: colors, LITE: light }));
        expect(events.slice(-2)).toEqual(['level 1', 'cells']);
        expect(layout).toEqual({ level: 3, words: 3 + 7 + 24, begins: [0, 3, undefined, undefined, undefined, 10] });
        expect(cellWords).toEqual([4, 0, 3, ...colors, ...light].map((word) => word >>> 0));
    });
    it('are left out where they do not fit, light first', async () => {
        const bytes = await file({ ACOL: colors, LITE: light });
        const enough = 4 * (7 + 3 + 7);
        const some = await read(bytes, enough);
        expect(some.layout!.begins[5]).toBeUndefined();
        expect(some.cellWords.length).toBe(10);
        expect(some.events.at(-1)).toMatch(/light is left out/);
        const none = await read(bytes, enough - 1);
        expect(none.layout).toBeUndefined();
        expect(none.events.at(-1)).toMatch(/Colours are left out/);
    });
    it.each<[string, Record<string, number[]>, number, number, string]>([
        ['another number of cells', { ACOL: colors }, 3, 5, 'cells'],
        ['a level below the voxels', { ACOL: colors }, 4, 4, 'attributes.level'],
        ['another width', { ACOL: [32, ...colors.slice(1)] }, 3, 4, 'bits'],
        ['another number of blocks', { ACOL: [24, 2, 4, 0, 0] }, 3, 4, 'blocks'],
        ['no table', { ACOL: [24] }, 3, 4, 'cut off'],
        ['a block before the data', { ACOL: [24, 1, 1, 255, 0, 0, 0] }, 3, 4, 'outside'],
        ['a block behind the end', { ACOL: [24, 1, 7, 255, 0, 0, 0] }, 3, 4, 'outside'],
        ['values cut off', { ACOL: [24, 1, 3, 255, 0, 0] }, 3, 4, 'past the end'],
        ['an unknown form', { ACOL: [24, 1, 3, 9 | (1 << 8), 0, 0, 0] }, 3, 4, 'form'],
        ['an empty palette', { ACOL: [24, 1, 3, 1, 0, 0, 0] }, 3, 4, 'form'],
        ['a palette beside values', { ACOL: [24, 1, 3, 255 | (1 << 8), 0, 0, 0] }, 3, 4, 'palette'],
        ['an index past its palette', { ACOL: [24, 1, 3, 2 | (3 << 8), 0, 0, 0xffffffff] }, 3, 4, 'palette'],
        ['damaged backs', { ACOL: colors, ABCK: [32, 1, 3, 255, 0, 0, 0] }, 3, 4, 'ABCK'],
        ['light of too few cells', { ACOL: colors, LITE: light.slice(6) }, 3, 4, 'LITE'],
        ['light of too many cells', { ACOL: colors, LITE: [...light, 0] }, 3, 4, 'LITE'],
    ])('are refused with %s', async (_, sections, level, cells, message) => {
        const found = await fault(await file(sections, level, cells));
        expect(found.kind).toBe('damaged');
        expect(found.message).toContain(message);
    });
    it('never pass with a changed byte', async () => {
        const bytes = await file({ ACOL: colors, LITE: light });
        for (let at = bytes.length - 4096 - 96; at < bytes.length; at += 1) {
            if (at >= bytes.length - 4096 - 68 && at < bytes.length - 96) continue; // between the sections
            const changed = bytes.slice();
            changed[at]! ^= 16;
            await fault(changed);
        }
    });
    it('have values that are read as the library reads them', () => {
        const palette = [24, 1, 3, 1 | (2 << 8), 0xbb112233 | 0, 0x00_09_ccdd | 0];
        expect(findValueFault(Uint32Array.from(palette), 4, 24)).toBeUndefined();
        expect([0, 1, 2, 3].map((cell) => cellValue(Uint32Array.from(palette), cell))).toEqual([0xccddbb, 0x112233, 0x112233, 0xccddbb]);
        expect(cellValue(Uint32Array.from([24, 1, 0]), 3)).toBe(0);
    });
    it('number the cells of every level', () => {
        const levels = [Uint32Array.from([0x81, 3, 5]), Uint32Array.from([0x13, 0, 0, 0x80000000])];
        expect(cellSums(levels, 3, 3)).toEqual({ sums: Uint32Array.from([4, 0, 3]), cells: 4 });
        // Voxels 0 and 1 share a cell of level 2, voxel 4 is in that cell too: one and one.
        expect(cellSums(levels, 3, 2)).toEqual({ sums: Uint32Array.from([2, 0, 1]), cells: 2 });
    });
});
