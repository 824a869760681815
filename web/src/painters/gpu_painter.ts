// SPDX-License-Identifier: MIT
//
// This machine draws, with WebGL 2. A context can be lost, and everything on the GPU with it: until it
// is back nothing is drawn, and then the scene has to be given again.
import { Engine } from '../gl/engine';
import { Machine } from '../gl/machine';
import { Renderer } from '../gl/renderer';
import { SceneTextures } from '../gl/scene_textures';
import type { CellLayout } from '../octv/cells';
import type { Metadata } from '../octv/metadata';
import { levelsThatFit } from '../octv/reader';
import { engineFacts } from '../ui/statistics';
import type { FoundCell } from '../ui/voxel_facts';
import type { Painter, View } from './painter';
import { LampPlacer, shotOf } from './shot_of';

export interface GpuEvents {
    drawn(): void;
    lost(): void;
    restored(): void;
    /** The GPU's driver cannot do what the viewer needs. */
    refused(why: string): void;
}

export class GpuPainter implements Painter {
    /** What is on the GPU while there is a context. */
    private gpu: { machine: Machine; scene: SceneTextures; renderer: Renderer; engine: Engine } | undefined;
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
            this.gpu?.engine.stop();
            this.gpu = undefined;
            events.lost();
        });
        canvas.addEventListener('webglcontextrestored', () => {
            this.begin();
            events.restored();
        });
    }

    private begin(): void {
        const { gl, events } = this;
        const machine = new Machine(gl);
        const scene = new SceneTextures(gl, machine.rowBits);
        const renderer = new Renderer(gl, machine, scene);
        const engine = new Engine(gl, renderer, events.drawn, (error) => events.refused(error.message));
        this.gpu = { machine, scene, renderer, engine };
    }

    /** Drawn by the processor, where no GPU is. */
    get software(): boolean {
        return this.gpu?.machine.software ?? false;
    }

    /** Takes room for as many levels as fit in so many bytes. @returns their number */
    reserve(metadata: Metadata, bytes: number): number {
        let levels = levelsThatFit(metadata, bytes);
        const words = (count: number): number => metadata.levels.slice(0, count).reduce((sum, level) => sum + level.words, 0);
        this.gpu?.renderer.forgetNormals();
        while (levels > 0 && this.gpu && !this.gpu.scene.reserve(words(levels))) levels -= 1;
        return levels;
    }
    append(words: Uint32Array): void {
        this.gpu?.scene.append(words);
    }
    /** Room for what cells look like. @returns whether there is room */
    reserveCells(layout: CellLayout): boolean {
        return this.gpu?.scene.reserveCells(layout) ?? false;
    }
    appendCells(words: Uint32Array): void {
        this.gpu?.scene.appendCells(words);
    }
    showCells(): void {
        this.gpu?.scene.showCells();
    }
    dropCells(): void {
        this.gpu?.scene.dropCells();
    }

    show(view: View): void {
        const { settings } = view;
        this.gpu?.engine.change({
            shot: shotOf(view, this.lamps.place(view), this.canvas),
            exposure: settings.exposure,
            toneMapped: settings.mode === 'shaded',
            restScale: settings.scale / 100,
            samples: settings.samples,
        });
    }

    showAgain({ settings }: View): void {
        this.gpu?.engine.changeLook(settings.exposure, settings.mode === 'shaded');
    }

    fill(): void {
        this.gpu?.engine.presentNow();
    }

    async pick(view: View, x: number, y: number): Promise<FoundCell | undefined> {
        const { canvas } = this;
        while (this.gpu && !this.gpu.renderer.canPick) await new Promise((resolve) => setTimeout(resolve, 50));
        return this.gpu?.renderer.pick(shotOf(view, this.lamps.place(view), canvas), canvas.width, canvas.height, x, y);
    }

    picture(): Promise<Blob | undefined> {
        this.gpu?.engine.presentNow();
        return new Promise((resolve) => this.canvas.toBlob((blob) => resolve(blob ?? undefined)));
    }

    get finished(): boolean {
        return this.gpu?.engine.finished ?? false;
    }

    get samples(): number {
        return this.gpu?.engine.statistics.samples ?? 0;
    }

    facts(): [string, string][] {
        if (!this.gpu) return [];
        const { engine, scene, machine } = this.gpu;
        return [...engineFacts(engine.statistics, scene.bytes), ['Drawn by', machine.name]];
    }
}
