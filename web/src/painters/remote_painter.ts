// SPDX-License-Identifier: MIT
//
// Another machine draws: octavo view --render-here. It gets what is wished for, and answers with
// pictures that grow sharper.
import type { FoundCell } from '../ui/voxel_facts';
import { cameraUniforms } from '../view/camera';
import { add, scale } from '../view/vec';
import { FrameSplitter } from './frame_splitter';
import type { Painter, View } from './painter';
import { type Wish, wishOf } from './wish';

const kFrames = 4; // of one view, each sharper than the one before

export class RemotePainter implements Painter {
    private readonly page = [...crypto.getRandomValues(new Uint8Array(8))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
    private number = 0;
    private next: Wish | undefined;
    private current: { abort: AbortController; frames: number } | undefined;
    private shownUrl = '';
    private shown: Blob | undefined;
    samples = 0; // frames of the last wish
    finished = false;

    constructor(
        private readonly image: HTMLImageElement,
        private readonly canvas: { width: number; height: number },
        private readonly url: string,
        private readonly pickUrl: string,
        private readonly onFrame: () => void,
        private readonly onFault: (message: string) => void,
    ) {}

    /** A view that is being drawn is left when its first picture has come. */
    show(view: View): void {
        this.next = wishOf(view, this.canvas);
        this.finished = false;
        if (!this.current) void this.work();
        else if (this.current.frames > 0) this.current.abort.abort();
    }

    showAgain(view: View): void {
        this.show(view);
    }

    fill(): void {
        // The browser does.
    }

    async pick({ camera, axes, scene }: View, x: number, y: number): Promise<FoundCell | undefined> {
        const { width, height } = this.canvas;
        const view = cameraUniforms(camera, axes, scene.metadata.grid, width, height);
        const aside = add(scale(x - width / 2, view.right), scale(y - height / 2, view.down));
        const body = JSON.stringify({ eye: camera.eye, direction: add(view.forward, aside) });
        const answer = await fetch(this.pickUrl, { method: 'POST', body });
        return answer.ok ? (((await answer.json()) as FoundCell | null) ?? undefined) : undefined;
    }

    picture(): Promise<Blob | undefined> {
        return Promise.resolve(this.shown);
    }

    facts(): [string, string][] {
        return [
            ['Drawn by', 'octavo, on the other machine'],
            ['Picture', this.finished ? 'as sharp as it gets' : `picture ${this.samples} of ${kFrames}`],
        ];
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
                await this.put(frame);
                this.current!.frames += 1;
                this.samples = this.current!.frames;
                this.onFrame();
                if (this.next) this.current!.abort.abort();
            }
        }
    }

    private async put(frame: Uint8Array<ArrayBuffer>): Promise<void> {
        this.shown = new Blob([frame], { type: frame[0] === 0x89 ? 'image/png' : 'image/jpeg' });
        const url = URL.createObjectURL(this.shown);
        const before = this.shownUrl;
        this.image.src = url;
        this.shownUrl = url;
        await this.image.decode().catch(() => undefined);
        if (before) URL.revokeObjectURL(before);
    }
}
