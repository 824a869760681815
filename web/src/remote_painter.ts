// SPDX-License-Identifier: MIT
//
// Another machine draws: octavo view --render-here. It gets what is wished for, and answers with
// pictures that grow sharper.

export interface Wish {
    width: number;
    height: number;
    eye: number[];
    forward: number[];
    up: number[];
    fov: number;
    shadows: string;
    ambient: boolean;
    reach: number; // world units
    smooth: boolean;
    stored: boolean; // by the light of the file's cells
    light: number;
    azimuth: number; // of the sun; radians
    elevation: number;
    size: number;
    exposure: number;
}

export interface Found {
    path: [number, number, number];
    height: number;
    face: number;
    time: number;
    albedo?: [number, number, number]; // linear
    emission?: [number, number, number];
}

/** Takes the frames out of an answer: each comes behind its length in four bytes. */
export class FrameSplitter {
    private bytes = new Uint8Array(0);

    add(piece: Uint8Array): Uint8Array<ArrayBuffer>[] {
        const joined = new Uint8Array(this.bytes.length + piece.length);
        joined.set(this.bytes);
        joined.set(piece, this.bytes.length);
        this.bytes = joined;
        const frames: Uint8Array<ArrayBuffer>[] = [];
        while (this.bytes.length >= 4) {
            const view = new DataView(this.bytes.buffer, this.bytes.byteOffset);
            const end = 4 + view.getUint32(0, true);
            if (this.bytes.length < end) break;
            frames.push(this.bytes.slice(4, end));
            this.bytes = this.bytes.slice(end);
        }
        return frames;
    }
}

export class RemotePainter {
    private readonly page = [...crypto.getRandomValues(new Uint8Array(8))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
    private number = 0;
    private next: Wish | undefined;
    private current: { abort: AbortController; frames: number } | undefined;
    private shownUrl = '';
    picture: Blob | undefined;
    frames = 0; // of the last wish
    finished = false;

    constructor(
        private readonly image: HTMLImageElement,
        private readonly url: string,
        private readonly pickUrl: string,
        private readonly onFrame: () => void,
        private readonly onFault: (message: string) => void,
    ) {}

    /** The newest wish counts. One that is being drawn is left when its first picture has come. */
    ask(wish: Wish): void {
        this.next = wish;
        this.finished = false;
        if (!this.current) void this.work();
        else if (this.current.frames > 0) this.current.abort.abort();
    }

    async pick(eye: number[], direction: number[]): Promise<Found | undefined> {
        const answer = await fetch(this.pickUrl, { method: 'POST', body: JSON.stringify({ eye, direction }) });
        return answer.ok ? (((await answer.json()) as Found | null) ?? undefined) : undefined;
    }

    private async work(): Promise<void> {
        while (this.next) {
            const wish = this.next;
            this.next = undefined;
            this.number += 1;
            this.current = { abort: new AbortController(), frames: 0 };
            try {
                await this.draw(wish, this.current.abort.signal);
                if (!this.next) this.finished = true;
            } catch {
                if (!this.current.abort.signal.aborted) {
                    this.next = undefined;
                    this.onFault('The machine that draws does not answer: is octavo view still running?');
                }
            }
            this.current = undefined;
            this.onFrame();
        }
    }

    private async draw(wish: Wish, signal: AbortSignal): Promise<void> {
        const answer = await fetch(this.url, {
            method: 'POST',
            signal,
            body: JSON.stringify({ page: this.page, number: this.number, ...wish }),
        });
        if (!answer.ok || !answer.body) throw new Error(await answer.text());
        const splitter = new FrameSplitter();
        const reader = answer.body.getReader();
        for (;;) {
            const { done, value } = await reader.read();
            if (done) return;
            for (const frame of splitter.add(value)) {
                await this.show(frame);
                this.current!.frames += 1;
                this.frames = this.current!.frames;
                this.onFrame();
                if (this.next) this.current!.abort.abort();
            }
        }
    }

    private async show(frame: Uint8Array<ArrayBuffer>): Promise<void> {
        this.picture = new Blob([frame], { type: frame[0] === 0x89 ? 'image/png' : 'image/jpeg' });
        const url = URL.createObjectURL(this.picture);
        const before = this.shownUrl;
        this.image.src = url;
        this.shownUrl = url;
        await this.image.decode().catch(() => undefined);
        if (before) URL.revokeObjectURL(before);
    }
}
