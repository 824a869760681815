// SPDX-License-Identifier: MIT
//
// When to draw what. While something moves: one sample of a picture as large as can be drawn 30 times
// a second. When all rests: larger pictures up to the full one, and of that sample after sample, in
// strips small enough that the page stays quick. While programs are missing: previews, which sharpen as
// well. The GPU never has more than one piece of work waiting.
import type { Canvas } from './canvas';
import type { Means } from './needs';
import { RayCounter } from './ray_counter';
import type { Renderer } from './renderer';
import { kLeastScale, kLeastStrip, liveScaleAfter, restScales, stripAfter } from './resolution';
import type { Shot } from './shot';

const kRestAfter = 180; // milliseconds without a change
const kProbeEvery = 500;
/** While something moves, each frame makes the normals of one pixel in so many that lack one. */
const kTurns = 8;

type Work = 'live' | 'rest' | 'program';

export interface Plan {
    shot: Shot;
    exposure: number;
    toneMapped: boolean;
    restScale: number; // 0 to 1: pixels of the picture at rest, along a side
    samples: number; // that it ends with
}

export interface EngineStatistics {
    width: number; // of the picture shown
    height: number;
    samples: number;
    framesPerSecond: number;
    raysPerSecond: number;
    resting: boolean;
    bytes: number; // of pictures
}

export class Engine {
    private plan: Plan | undefined;
    private live: Canvas | undefined;
    private rest: Canvas | undefined;
    private restRow = 0; // rows of the next sample that are drawn
    private turn = 0;
    private stripPixels = kLeastStrip;
    private scale = kLeastScale; // of the live picture
    private restSizes: number[] = []; // scales of the picture at rest that are still to come
    private means: Means = 'none';
    private drewLast = false; // the last piece of work was no program's
    private changed = -Infinity;
    private liveStale = true;
    private restStale = true;
    private waiting: { sync: WebGLSync; began: number; pixels: number; of: Work } | undefined;
    private pending = 0;
    private frameTimes: number[] = [];
    private probed = 0;
    private probeSamples = 1;
    private raysPerSample = 1;
    /** What the shortest piece of work takes: the way to the GPU and back, which fewer pixels do not shorten. */
    private overhead = 1000;
    private pixelTimes: { at: number; pixels: number }[] = [];
    private presented: Canvas | undefined;
    private screen = { width: 0, height: 0 };
    private wantsPresent = false;
    private readonly counter: RayCounter;

    constructor(
        private readonly gl: WebGL2RenderingContext,
        private readonly renderer: Renderer,
        private readonly onFrame: () => void,
        private readonly onFault: (error: Error) => void,
    ) {
        this.counter = new RayCounter(gl, renderer.machine.format);
        this.wake(); // for the first programs
    }

    /** Something that the picture depends on is new. */
    change(plan: Plan): void {
        this.plan = plan;
        this.renderer.prepare(plan.shot);
        this.liveStale = true;
        this.restStale = true;
        this.changed = performance.now();
        this.wake();
    }

    /** The same picture, shown in another way. */
    changeLook(exposure: number, toneMapped: boolean): void {
        if (!this.plan) return;
        this.plan = { ...this.plan, exposure, toneMapped };
        this.wantsPresent = true;
        this.wake();
    }

    wake(): void {
        if (this.pending === 0) this.pending = requestAnimationFrame(this.tick);
    }

    stop(): void {
        cancelAnimationFrame(this.pending);
        this.pending = 0;
        this.plan = undefined;
    }

    /** Has everything been drawn that will be? */
    get finished(): boolean {
        return !this.plan || (this.means === 'all' && !this.restStale && this.restSizes.length === 0 && !!this.rest && this.rest.samples >= this.enough && this.presented === this.rest);
    }

    get statistics(): EngineStatistics {
        const now = performance.now();
        const recent = this.frameTimes.filter((time) => now - time < 1000);
        const traced = this.pixelTimes.filter(({ at }) => now - at < 1000);
        const pixels = traced.reduce((sum, each) => sum + each.pixels, 0);
        const shown = this.presented;
        return {
            width: shown?.width ?? 0,
            height: shown?.height ?? 0,
            samples: shown?.samples ?? 0,
            framesPerSecond: recent.length,
            raysPerSecond: pixels * this.raysPerSample,
            resting: shown !== undefined && shown === this.rest,
            bytes: (this.live?.bytes ?? 0) + (this.rest?.bytes ?? 0),
        };
    }

    /** Draws the shown picture again, for someone who reads the canvas in the same breath. */
    presentNow(): void {
        if (this.presented) this.show(this.presented);
    }

    private get enough(): number {
        return Math.min(this.plan?.samples ?? 1, this.renderer.machine.mostSamples);
    }

    private readonly tick = (): void => {
        this.pending = 0;
        if (this.gl.isContextLost()) return;
        if (this.waiting && !this.collect()) return this.wake();
        try {
            // By turns, so that neither waits for ever.
            if (this.drewLast) this.prepare() || this.draw();
            else this.draw() || this.prepare();
        } catch (error) {
            this.stop();
            return this.onFault(error as Error);
        }
        if (!this.finished || this.waiting || this.renderer.preparing) this.wake();
        if (this.plan) this.onFrame();
    };

    /** Takes the programs on. @returns whether the GPU is at work for them now */
    private prepare(): boolean {
        if (!this.renderer.prepareMore()) return false;
        this.drewLast = false;
        this.submit(0, 'program');
        return true;
    }

    /** @returns whether the GPU is at work for a picture now */
    private draw(): boolean {
        const { plan } = this;
        if (!plan) return false;
        this.fitScreen();
        const means = this.renderer.means(plan.shot);
        if (means !== this.means) {
            this.means = means;
            this.liveStale = this.restStale = true;
            this.scale = kLeastScale; // another pace
        }
        if (means === 'none') return false;
        this.collectProbe();
        const now = performance.now();
        const resting = now - this.changed > kRestAfter && means !== 'preview';
        if (!resting && this.liveStale) this.drawLive(plan);
        else if (resting) this.drawRest(plan);
        if (this.wantsPresent && this.presented) this.show(this.presented);
        this.wantsPresent = false;
        this.drewLast = this.waiting !== undefined;
        return this.drewLast;
    }

    private fitScreen(): void {
        const { width, height } = this.gl.canvas;
        if (width === this.screen.width && height === this.screen.height) return;
        this.screen = { width, height };
        this.liveStale = this.restStale = true;
    }

    private sized(canvas: Canvas | undefined, scale: number): Canvas {
        const width = Math.max(1, Math.round(this.screen.width * scale));
        const height = Math.max(1, Math.round(this.screen.height * scale));
        if (canvas && canvas.width === width && canvas.height === height) return canvas;
        if (canvas !== this.presented) canvas?.free(); // else when another is shown
        return this.renderer.makeCanvas(width, height);
    }

    private shotFor(plan: Plan, canvas: Canvas): Shot {
        // The camera's uniforms were made for the full picture; a pixel of this one is larger.
        const factor = this.screen.height / canvas.height;
        const aside = this.screen.width / canvas.width;
        const { camera } = plan.shot;
        return {
            ...plan.shot,
            cone: plan.shot.cone * factor,
            camera: {
                ...camera,
                right: camera.right.map((value) => value * aside) as Shot['camera']['right'],
                down: camera.down.map((value) => value * factor) as Shot['camera']['down'],
            },
        };
    }

    private drawLive(plan: Plan): void {
        this.live = this.sized(this.live, this.scale);
        const { live } = this;
        live.restart();
        const shot = this.shotFor(plan, live);
        if (this.means === 'preview') {
            this.renderer.drawPreview(live, shot);
        } else {
            this.renderer.drawBeams(live, shot);
            this.turn += 1;
            this.renderer.drawRows(live, shot, 0, live.height, true, this.turn, kTurns);
            live.finishSample();
        }
        this.show(live);
        this.liveStale = false;
        this.submit(live.width * live.height, 'live');
    }

    private drawRest(plan: Plan): void {
        if (this.restStale) {
            this.restStale = false;
            this.restSizes = restScales(this.liveStale ? 0 : this.scale, plan.restScale);
            this.beginRest(plan);
        }
        if (this.restSizes.length > 0 && this.rest!.samples > 0) this.beginRest(plan);
        const rest = this.rest!;
        if (rest.samples >= this.enough) {
            if (this.presented !== rest) this.show(rest);
            return;
        }
        const rows = Math.max(1, Math.round(this.stripPixels / rest.width));
        const to = Math.min(rest.height, this.restRow + rows);
        this.renderer.drawRows(rest, this.shotFor(plan, rest), this.restRow, to, false, 0, 1);
        const pixels = rest.width * (to - this.restRow);
        this.restRow = to;
        if (to === rest.height) {
            rest.finishSample();
            this.restRow = 0;
            this.show(rest);
        }
        this.submit(pixels, 'rest');
    }

    private beginRest(plan: Plan): void {
        this.rest = this.sized(this.rest, this.restSizes.shift()!);
        this.rest.restart();
        this.restRow = 0;
        this.renderer.drawBeams(this.rest, this.shotFor(plan, this.rest));
    }

    private show(canvas: Canvas): void {
        const { plan } = this;
        if (!plan) return;
        this.renderer.present(canvas, this.screen.width, this.screen.height, plan.exposure, plan.toneMapped);
        const before = this.presented;
        this.presented = canvas;
        if (before !== canvas && before !== this.live && before !== this.rest) before?.free();
    }

    private submit(pixels: number, of: Work): void {
        const sync = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        this.gl.flush();
        if (sync) this.waiting = { sync, began: performance.now(), pixels, of };
    }

    /** @returns whether the GPU has done the last piece of work */
    private collect(): boolean {
        const { gl, waiting } = this;
        if (!waiting) return true;
        if (gl.getSyncParameter(waiting.sync, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
        gl.deleteSync(waiting.sync);
        this.waiting = undefined;
        const now = performance.now();
        if (waiting.of === 'program') return true;
        const elapsed = now - waiting.began;
        this.overhead = Math.min(this.overhead * 1.01, elapsed);
        const took = Math.max(1, elapsed - 0.9 * this.overhead);
        this.pixelTimes = this.pixelTimes.filter(({ at }) => now - at < 1000);
        this.pixelTimes.push({ at: now, pixels: waiting.pixels });
        if (waiting.of === 'rest') {
            this.stripPixels = stripAfter(waiting.pixels, took);
        } else {
            this.frameTimes = this.frameTimes.filter((time) => now - time < 1000);
            this.frameTimes.push(now);
            this.fitScale(took);
        }
        if (now - this.probed > kProbeEvery && this.presented && this.presented.samples > 0) {
            this.probed = now;
            this.counter.ask(this.presented);
            this.probeSamples = this.presented.samples;
        }
        return true;
    }

    private fitScale(took: number): void {
        const before = this.scale;
        this.scale = liveScaleAfter(before, took);
        // Nothing else sharpens a preview.
        if (this.means === 'preview' && this.scale > 1.2 * before) this.liveStale = true;
    }

    private collectProbe(): void {
        const rays = this.counter.collect();
        if (rays !== undefined) this.raysPerSample = rays / this.probeSamples;
    }
}
