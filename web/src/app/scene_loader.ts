// SPDX-License-Identifier: MIT
import LoaderWorker from '../octv/worker?worker&inline';
import type { Order, Origin, Report } from '../octv/worker';

/** One file on its way into the page. */
export class SceneLoader {
    private readonly worker: Worker;

    constructor(origin: Origin, maxDagBytes: number, handle: (report: Report) => void) {
        this.worker = new LoaderWorker();
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
