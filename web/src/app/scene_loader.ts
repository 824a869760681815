// SPDX-License-Identifier: MIT
import type { Order, Origin, Report } from '../octv/worker';
import LoaderWorker from '../octv/worker?worker&inline';

/** Starts while the rest of the page does: that takes longer than reading a small file. */
let spare: Worker | undefined = new LoaderWorker();
spare.onerror = () => (spare = undefined); // another will say why

/** One file on its way into the page. */
export class SceneLoader {
    private readonly worker: Worker;

    constructor(origin: Origin, maxDagBytes: number, handle: (report: Report) => void) {
        this.worker = spare ?? new LoaderWorker();
        spare = undefined;
        this.worker.onmessage = ({ data }: MessageEvent<Report>) => handle(data);
        this.worker.onerror = (event) => {
            handle({ is: 'fault', kind: 'unreachable', message: `The loader failed: ${event.message ?? 'it could not be started'}.` });
        };
        const order: Order = { origin, maxDagBytes };
        this.worker.postMessage(order);
    }

    cancel(): void {
        this.worker.onmessage = null;
        this.worker.terminate();
    }
}
