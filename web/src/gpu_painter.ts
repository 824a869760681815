// SPDX-License-Identifier: MIT
//
// This machine draws, with WebGL 2. A context can be lost, and everything on the GPU with it: until it
// is back nothing is drawn, and then the scene has to be given again.
import { Engine } from './gl/engine';
import { Renderer } from './gl/renderer';
import type { CellLayout } from './octv/cells';
import type { Metadata } from './octv/metadata';
import { levelsThatFit } from './octv/reader';
import type { Painter, View } from './painter';
import { engineFacts } from './ui/statistics';
import type { FoundCell } from './ui/voxel_facts';
import { LampPlacer, shotOf } from './view/shot';

export interface GpuEvents {
    drawn(): void;
    lost(): void;
    restored(): void;
    /** The GPU's driver cannot do what the viewer needs. */
    refused(why: string): void;
}

export class GpuPainter implements Painter {
    private renderer: Renderer | undefined;
    private engine: Engine | undefined;
    private readonly lamps = new LampPlacer();

    /** @returns undefined where the browser has no WebGL 2 */
    static make(canvas: HTMLCanvasElement, events: GpuEvents): GpuPainter | undefined {
        const gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false, powerPreference: 'high-performance' });
        return gl ? new GpuPainter(canvas, gl, events) : undefined;
    }

    private constructor(
        private readonly canvas: HTMLCanvasElement,
        private readonly gl: WebGL2RenderingContext,
        private readonly events: GpuEvents,
    ) {
        this.begin();
        canvas.addEventListener('webglcontextlost', (event) => {
            event.preventDefault();
            this.engine?.stop();
            this.engine = this.renderer = undefined;
            events.lost();
        });
        canvas.addEventListener('webglcontextrestored', () => {
            this.begin();
            events.restored();
        });
    }

    private begin(): void {
        this.renderer = new Renderer(this.gl);
        this.engine = new Engine(this.gl, this.renderer, this.events.drawn, (error) => this.events.refused(error.message));
    }

    /** Drawn by the processor, where no GPU is. */
    get software(): boolean {
        return this.renderer?.software ?? false;
    }

    /** Takes room for as many levels as fit in so many bytes. @returns their number */
    reserve(metadata: Metadata, bytes: number): number {
        let levels = levelsThatFit(metadata, bytes);
        const words = (count: number): number => metadata.levels.slice(0, count).reduce((sum, level) => sum + level.words, 0);
        while (levels > 0 && this.renderer && !this.renderer.reserve(words(levels))) levels -= 1;
        return levels;
    }
    append(words: Uint32Array): void {
        this.renderer?.words?.append(words);
    }
    /** Room for what cells look like. @returns whether there is room */
    reserveCells(layout: CellLayout): boolean {
        return this.renderer?.reserveCells(layout) ?? false;
    }
    appendCells(words: Uint32Array): void {
        this.renderer?.appendCells(words);
    }
    showCells(): void {
        this.renderer?.showCells();
    }
    dropCells(): void {
        this.renderer?.dropCells();
    }

    show(view: View): void {
        const { settings } = view;
        this.engine?.change({
            shot: shotOf(view, this.lamps.place(view), this.canvas),
            exposure: settings.exposure,
            toneMapped: settings.mode === 'shaded',
            restScale: settings.scale / 100,
            samples: settings.samples,
        });
    }

    showAgain({ settings }: View): void {
        this.engine?.changeLook(settings.exposure, settings.mode === 'shaded');
    }

    fill(): void {
        this.engine?.presentNow();
    }

    async pick(view: View, x: number, y: number): Promise<FoundCell | undefined> {
        const { canvas } = this;
        while (this.renderer && !this.renderer.canPick) await new Promise((resolve) => setTimeout(resolve, 50));
        return this.renderer?.pick(shotOf(view, this.lamps.place(view), canvas), canvas.width, canvas.height, x, y);
    }

    picture(): Promise<Blob | undefined> {
        this.engine?.presentNow();
        return new Promise((resolve) => this.canvas.toBlob((blob) => resolve(blob ?? undefined)));
    }

    get finished(): boolean {
        return this.engine?.finished ?? false;
    }

    get samples(): number {
        return this.engine?.statistics.samples ?? 0;
    }

    facts(): [string, string][] {
        const { engine, renderer } = this;
        return engine && renderer ? [...engineFacts(engine.statistics, renderer.sceneBytes), ['Drawn by', renderer.name]] : [];
    }
}
