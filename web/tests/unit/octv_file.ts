// SPDX-License-Identifier: MIT
import { readFileSync } from 'node:fs';
import { xxhash3 } from 'hash-wasm';

export type Bytes = Uint8Array<ArrayBuffer>;

/** The worked example of docs/file-format.md, from its hex dump. */
export function exampleFile(): Bytes {
    const text = readFileSync(new URL('../../../docs/file-format.md', import.meta.url), 'utf8');
    const rows = [...text.matchAll(/^([0-9a-f]{8})  ((?:[0-9a-f]{2} ?)+ ?(?:[0-9a-f]{2} ?)*)/gm)];
    const size = parseInt(/^([0-9a-f]{8})$/m.exec(text)![1]!, 16);
    const bytes = new Uint8Array(size);
    for (const [, at, row] of rows) {
        bytes.set(row!.trim().split(/\s+/).map((byte) => parseInt(byte, 16)).slice(0, 16), parseInt(at!, 16));
    }
    return bytes;
}

/** Makes the checksums right again, so that what a test has changed is met by the later checks. */
export async function resealed(bytes: Bytes): Promise<Bytes> {
    const view = new DataView(bytes.buffer);
    const hash = async (part: Bytes): Promise<bigint> => BigInt(`0x${await xxhash3(part)}`);
    const count = view.getUint32(24, true);
    for (let at = 64; at < 64 + 48 * count; at += 48) {
        const offset = Number(view.getBigUint64(at + 8, true));
        const size = Number(view.getBigUint64(at + 16, true));
        view.setBigUint64(at + 32, await hash(bytes.slice(offset, offset + size)), true);
    }
    view.setBigUint64(32, 0n, true);
    view.setBigUint64(32, await hash(bytes.slice(0, 64 + 48 * count)), true);
    return bytes;
}

/** The example with other metadata of the same length. */
export async function withMetadata(from: string, to: string): Promise<Bytes> {
    const bytes = exampleFile();
    const text = new TextDecoder('latin1').decode(bytes);
    const at = text.indexOf(from);
    if (at < 0) throw new Error(`The example has no ${from}`);
    bytes.set(new TextEncoder().encode(to.padEnd(from.length)), at);
    return resealed(bytes);
}

/** The example with other words in its DAG. */
export async function withWords(words: Record<number, number>): Promise<Bytes> {
    const bytes = exampleFile();
    const view = new DataView(bytes.buffer);
    for (const [word, value] of Object.entries(words)) view.setUint32(0x2000 + 4 * Number(word), value, true);
    return resealed(bytes);
}

/** The example with attributes of a level: more sections, and what the metadata says of them. */
export async function colouredFile(sections: Record<string, number[]>, level: number, cells: number): Promise<Bytes> {
    const example = exampleFile();
    const old = new DataView(example.buffer);
    const text = new TextDecoder('latin1').decode(example.slice(0x1000, 0x1000 + Number(old.getBigUint64(64 + 16, true))));
    const metadata = new TextEncoder().encode(`${text.slice(0, -1)},"attributes":{"level":${level},"cells":${cells},"tolerance":0}}`);
    const all: [string, Bytes][] = [
        ['META', metadata as Bytes],
        ['DAG ', example.slice(0x2000)],
        ...Object.entries(sections).map(([id, words]): [string, Bytes] => [id, new Uint8Array(Uint32Array.from(words).buffer)]),
    ];
    const last = all.at(-1)![1];
    const bytes = new Uint8Array(0x1000 * all.length + last.length);
    bytes.set(example.slice(0, 64));
    const view = new DataView(bytes.buffer);
    view.setBigUint64(16, BigInt(bytes.length), true);
    view.setUint32(24, all.length, true);
    all.forEach(([id, content], i) => {
        const at = 64 + 48 * i;
        bytes.set(new TextEncoder().encode(id), at);
        view.setUint32(at + 4, i < 2 ? 1 : 0, true);
        view.setBigUint64(at + 8, BigInt(0x1000 * (i + 1)), true);
        view.setBigUint64(at + 16, BigInt(content.length), true);
        view.setBigUint64(at + 24, BigInt(content.length), true);
        bytes.set(content, 0x1000 * (i + 1));
    });
    return resealed(bytes);
}
