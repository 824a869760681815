// SPDX-License-Identifier: MIT
//
// Runs the reader beside the page, so that checking a large file never delays a frame.
import type { CellLayout } from './cells';
import type { CellBox } from './content_bounds';
import { type FaultKind, FileFault } from './errors';
import { type FileFacts, readOctv } from './reader';
import { BlobSource, MemorySource, openUrl } from './source';

/** Which file: a URL, a file of the user's, or bytes that came inside the page. */
export type Origin = { url: string } | { blob: Blob } | { bytes: Uint8Array<ArrayBuffer> };

export interface Order {
    origin: Origin;
    maxDagBytes: number;
}

export type Report =
    | { is: 'opened'; facts: FileFacts }
    | { is: 'progress'; bytes: number }
    | { is: 'words'; words: Uint32Array<ArrayBuffer> }
    | { is: 'level'; level: number }
    | { is: 'bounds'; box: CellBox }
    | { is: 'cells'; layout: CellLayout }
    | { is: 'cellWords'; words: Uint32Array<ArrayBuffer> }
    | { is: 'cellsReady' }
    | { is: 'cellsLeftOut'; why: string }
    | { is: 'done' }
    | { is: 'fault'; kind: FaultKind; message: string };

const scope = self as unknown as {
    postMessage(report: Report, transfer?: Transferable[]): void;
    onmessage: ((event: MessageEvent<Order>) => void) | null;
};
const tell = (report: Report): void => scope.postMessage(report);

async function openOrigin(origin: Origin): Promise<BlobSource | MemorySource | Awaited<ReturnType<typeof openUrl>>> {
    if ('url' in origin) return openUrl(origin.url);
    if ('blob' in origin) return new BlobSource(origin.blob);
    return new MemorySource(origin.bytes);
}

scope.onmessage = async ({ data }) => {
    try {
        const source = await openOrigin(data.origin);
        await readOctv(
            source,
            {
                opened: (facts) => tell({ is: 'opened', facts }),
                progress: (bytes) => tell({ is: 'progress', bytes }),
                words: (words) => scope.postMessage({ is: 'words', words }, [words.buffer]),
                level: (level) => tell({ is: 'level', level }),
                bounds: (box) => tell({ is: 'bounds', box }),
                cells: (layout) => tell({ is: 'cells', layout }),
                cellWords: (words) => scope.postMessage({ is: 'cellWords', words }, [words.buffer]),
                cellsReady: () => tell({ is: 'cellsReady' }),
                cellsLeftOut: (why) => tell({ is: 'cellsLeftOut', why }),
            },
            { maxDagBytes: data.maxDagBytes },
        );
        source.close();
        tell({ is: 'done' });
    } catch (error) {
        if (error instanceof FileFault) return tell({ is: 'fault', kind: error.kind, message: error.message });
        if (error instanceof RangeError) {
            return tell({ is: 'fault', kind: 'limit', message: 'The browser has not enough memory to load this file.' });
        }
        throw error;
    }
};
