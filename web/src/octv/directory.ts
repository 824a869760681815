// SPDX-License-Identifier: MIT
//
// Header and section table of an .octv file: docs/file-format.md. Nothing here is trusted.
import { FileFault, damaged } from './errors';

export const kPageBytes = 4096;
const kHeaderBytes = 64;
const kEntryBytes = 48;
const kMaxSections = (kPageBytes - kHeaderBytes) / kEntryBytes;
const kNewestVersion = 1;
const kMagic = [0x89, 0x4f, 0x43, 0x54, 0x56, 0x0d, 0x0a, 0x1a];
const kRequired = 1;
const kZstd = 2;

export interface Section {
    id: string;
    required: boolean;
    compressed: boolean;
    offset: number;
    storedBytes: number;
    rawBytes: number;
    checksum: bigint; // XXH3-64 of the stored bytes
}

export interface Directory {
    fileBytes: number;
    sections: Section[];
    checksum: bigint; // of header and table
    checked: Uint8Array<ArrayBuffer>; // the bytes that it is of
}

function safeNumber(value: bigint, what: string): number {
    if (value > BigInt(Number.MAX_SAFE_INTEGER)) throw damaged(`${what} is larger than any file.`);
    return Number(value);
}

function sectionName(view: DataView, at: number): string {
    const letters = [0, 1, 2, 3].map((i) => view.getUint8(at + i));
    if (letters.every((letter) => letter >= 0x20 && letter < 0x7f)) return String.fromCharCode(...letters);
    return letters.map((letter) => letter.toString(16).padStart(2, '0')).join('');
}

/**
 * Reads the first page of a file.
 *
 * @param page      its first 4096 bytes, or all of a shorter file
 * @param fileSize  bytes that are there, where it is known
 * @param known     ids that the caller can read; a required section of another id is refused
 * @throws FileFault  damaged, unsupported
 */
export function readDirectory(page: Uint8Array, fileSize: number | undefined, known: string[]): Directory {
    if (page.length < kHeaderBytes || kMagic.some((byte, i) => page[i] !== byte)) {
        throw damaged('This is not an .octv file.');
    }
    const view = new DataView(page.buffer, page.byteOffset, page.byteLength);
    const version = view.getUint32(8, true);
    if (view.getUint32(12, true) !== 0x01020304) throw damaged('The byte order mark is wrong.');
    if (version > kNewestVersion) {
        throw new FileFault('unsupported', `The file has format version ${version}; this page reads up to ${kNewestVersion}.`);
    }
    if (version === 0) throw damaged('Format version 0 does not exist.');
    const fileBytes = safeNumber(view.getBigUint64(16, true), 'The stated size of the file');
    if (fileSize !== undefined && fileSize !== fileBytes) {
        const how = fileSize < fileBytes ? 'cut off' : 'too long';
        throw damaged(`The file is ${how}: it has ${fileSize} bytes where ${fileBytes} are stated.`);
    }
    const count = view.getUint32(24, true);
    if (count > kMaxSections) throw damaged(`A file has at most ${kMaxSections} sections, not ${count}.`);
    const tableEnd = kHeaderBytes + count * kEntryBytes;
    if (page.length < tableEnd) throw damaged('The file ends inside its section table.');
    const zeros = [28, 40, 44, 48, 52, 56, 60];
    if (zeros.some((at) => view.getUint32(at, true) !== 0)) throw damaged('Spare bytes of the header are not zero.');

    const sections: Section[] = [];
    let end = kPageBytes;
    for (let i = 0; i < count; i += 1) {
        const section = readSection(view, kHeaderBytes + i * kEntryBytes);
        const name = section.id.trim();
        if (sections.some((other) => other.id === section.id)) throw damaged(`Section ${name} comes twice.`);
        if (section.offset % kPageBytes !== 0 || section.offset < end) {
            throw damaged(`Section ${name} does not begin on a page of its own.`);
        }
        end = section.offset + section.storedBytes;
        if (end > fileBytes) throw damaged(`Section ${name} reaches past the end of the file.`);
        if (section.required && !known.includes(section.id)) {
            throw new FileFault('unsupported', `The file needs a newer viewer: its section ${name} is unknown here.`);
        }
        sections.push(section);
    }
    const checked = page.slice(0, tableEnd);
    checked.fill(0, 32, 40);
    return { fileBytes, sections, checksum: view.getBigUint64(32, true), checked };
}

function readSection(view: DataView, at: number): Section {
    const id = sectionName(view, at);
    const name = id.trim();
    const flags = view.getUint32(at + 4, true);
    if ((flags & ~(kRequired | kZstd)) !== 0) throw damaged(`Section ${name} has unknown flags.`);
    if (view.getBigUint64(at + 40, true) !== 0n) throw damaged(`Spare bytes of section ${name} are not zero.`);
    const section = {
        id,
        required: (flags & kRequired) !== 0,
        compressed: (flags & kZstd) !== 0,
        offset: safeNumber(view.getBigUint64(at + 8, true), `The offset of section ${name}`),
        storedBytes: safeNumber(view.getBigUint64(at + 16, true), `The size of section ${name}`),
        rawBytes: safeNumber(view.getBigUint64(at + 24, true), `The size of section ${name}`),
        checksum: view.getBigUint64(at + 32, true),
    };
    if (!section.compressed && section.storedBytes !== section.rawBytes) {
        throw damaged(`Section ${name} states two sizes.`);
    }
    return section;
}
