// SPDX-License-Identifier: MIT
import { FileFault } from './errors';

/** Where the bytes of a file come from. Sections are read in the order in which they lie. */
export interface ByteSource {
    /** Bytes of the whole file; not known where a server does not say. */
    readonly size: number | undefined;
    /** These bytes; fewer only where the file ends. Offsets never go back by more than 64 KiB. */
    read(offset: number, length: number): Promise<Uint8Array<ArrayBuffer>>;
    /** Stops what is under way. */
    close(): void;
}

export class MemorySource implements ByteSource {
    constructor(private readonly bytes: Uint8Array<ArrayBuffer>) {}
    get size(): number {
        return this.bytes.length;
    }
    async read(offset: number, length: number): Promise<Uint8Array<ArrayBuffer>> {
        return this.bytes.slice(offset, offset + length);
    }
    close(): void {}
}

/** A file of the user's machine, dropped on the page. */
export class BlobSource implements ByteSource {
    constructor(private readonly blob: Blob) {}
    get size(): number {
        return this.blob.size;
    }
    async read(offset: number, length: number): Promise<Uint8Array<ArrayBuffer>> {
        try {
            const part = this.blob.slice(offset, offset + length);
            return new Uint8Array(await part.arrayBuffer());
        } catch {
            throw new FileFault('unreachable', 'The file cannot be read any more: was it changed or moved?');
        }
    }
    close(): void {}
}

const kFirstBytes = 65536;
const kAttempts = 3;

/**
 * A file behind a URL. Asks for ranges; a server that does not know them sends the whole file, which
 * is then read as it comes.
 */
export async function openUrl(url: string, fetcher: typeof fetch = fetch): Promise<ByteSource> {
    const abort = new AbortController();
    const response = await fetchOrExplain(fetcher, url, {
        headers: { Range: `bytes=0-${kFirstBytes - 1}` },
        signal: abort.signal,
    });
    if (response.status === 206) {
        const total = /\/(\d+)$/.exec(response.headers.get('Content-Range') ?? '');
        if (!total) throw new FileFault('unreachable', 'The server answers with ranges of unknown size.');
        const first = new Uint8Array(await response.arrayBuffer());
        return new RangeSource(fetcher, url, Number(total[1]), first, abort);
    }
    if (response.status === 416) return new MemorySource(new Uint8Array(0));
    if (!response.ok || !response.body) {
        throw new FileFault('unreachable', `The server answers ${response.status} to the request for the scene.`);
    }
    const encoded = response.headers.get('Content-Encoding');
    const length = response.headers.get('Content-Length');
    const size = length !== null && !encoded ? Number(length) : undefined;
    return new StreamSource(response.body.getReader(), size, abort);
}

async function fetchOrExplain(fetcher: typeof fetch, url: string, init: RequestInit): Promise<Response> {
    try {
        return await fetcher(url, { ...init, cache: 'no-store' });
    } catch {
        throw new FileFault('unreachable', 'The scene cannot be fetched: is the server still running?');
    }
}

class RangeSource implements ByteSource {
    constructor(
        private readonly fetcher: typeof fetch,
        private readonly url: string,
        readonly size: number,
        private readonly first: Uint8Array<ArrayBuffer>,
        private readonly abort: AbortController,
    ) {}

    async read(offset: number, length: number): Promise<Uint8Array<ArrayBuffer>> {
        const end = Math.min(offset + length, this.size);
        if (end <= offset) return new Uint8Array(0);
        if (end <= this.first.length) return this.first.slice(offset, end);
        for (let attempt = 1; ; attempt += 1) {
            try {
                return await this.fetchRange(offset, end);
            } catch (error) {
                if (attempt === kAttempts || this.abort.signal.aborted) throw error;
                await new Promise((resolve) => setTimeout(resolve, 200 * attempt));
            }
        }
    }

    close(): void {
        this.abort.abort();
    }

    private async fetchRange(offset: number, end: number): Promise<Uint8Array<ArrayBuffer>> {
        const response = await fetchOrExplain(this.fetcher, this.url, {
            headers: { Range: `bytes=${offset}-${end - 1}` },
            signal: this.abort.signal,
        });
        const stated = `bytes ${offset}-${end - 1}/${this.size}`;
        if (response.status !== 206 || response.headers.get('Content-Range') !== stated) {
            throw new FileFault('unreachable', 'The file behind this page has changed; reload the page.');
        }
        let bytes: Uint8Array<ArrayBuffer>;
        try {
            bytes = new Uint8Array(await response.arrayBuffer());
        } catch {
            throw new FileFault('unreachable', 'The connection broke while the scene was loading.');
        }
        if (bytes.length !== end - offset) {
            throw new FileFault('unreachable', 'The connection broke while the scene was loading.');
        }
        return bytes;
    }
}

/** A response that is read once, from its first byte to its last. */
export class StreamSource implements ByteSource {
    private parts: Uint8Array[] = []; // from `begin` on
    private begin = 0;
    private end = 0;
    private finished = false;

    constructor(
        private readonly reader: ReadableStreamDefaultReader<Uint8Array>,
        readonly size: number | undefined,
        private readonly abort: AbortController,
    ) {}

    async read(offset: number, length: number): Promise<Uint8Array<ArrayBuffer>> {
        while (!this.finished && this.end < offset + length) {
            await this.receive();
            this.forget(offset - kFirstBytes);
        }
        const count = Math.max(0, Math.min(offset + length, this.end) - offset);
        const bytes = new Uint8Array(count);
        let at = this.begin;
        for (const part of this.parts) {
            const from = Math.max(offset, at);
            const to = Math.min(offset + count, at + part.length);
            if (from < to) bytes.set(part.subarray(from - at, to - at), from - offset);
            at += part.length;
        }
        this.forget(offset + count - kFirstBytes);
        return bytes;
    }

    close(): void {
        this.abort.abort();
    }

    private async receive(): Promise<void> {
        let next;
        try {
            next = await this.reader.read();
        } catch {
            throw new FileFault('unreachable', 'The connection broke while the scene was loading.');
        }
        if (next.done) {
            this.finished = true;
            return;
        }
        this.parts.push(next.value);
        this.end += next.value.length;
    }

    private forget(offset: number): void {
        while (this.parts.length > 0 && this.begin + this.parts[0]!.length <= offset) {
            this.begin += this.parts.shift()!.length;
        }
    }
}
