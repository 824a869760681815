// SPDX-License-Identifier: MIT
//
// When to draw what. While something moves: one sample of a picture as large as can be drawn 30 times
// a second. When all rests: the full picture, sample after sample, in strips small enough that the
// page stays quick. The GPU never has more than one piece of work waiting.
import type { Canvas, Renderer, Shot } from './renderer';

const kFrame = 33; // milliseconds: 30 frames a second
const kStrip = 24; // for a strip of the picture at rest
/** Pixels of a strip: where the way to the GPU is slow and varies, smaller ones would take for ever. */
const kLeastStrip = 4096;
const kRestAfter = 180; // without a change
const kLeastScale = 0.125;
const kProbeEvery = 500;
/** While something moves, each frame makes the normals of one pixel in so many that lack one. */
const kTurns = 8;

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
    private stripRows = 16;
    private scale = 0.5; // of the live picture
    private changed = -Infinity;
    private liveStale = true;
    private restStale = true;
    private waiting: { sync: WebGLSync; began: number; pixels: number; rest: boolean } | undefined;
    private pending = 0;
    private frameTimes: number[] = [];
    private probed = 0;
    private probeSamples = 1;
    private raysPerSample = 1;
    /** What the shortest piece of work takes: the way to the GPU and back, which fewer pixels do not shorten. */
    private overhead = 1000;
    private pixelTimes: { at: number; pixels: number }[] = [];
    private smoothSeen: boolean;
    private presented: Canvas | undefined;
    private screen = { width: 0, height: 0 };
    private wantsPresent = false;

    constructor(
        private readonly gl: WebGL2RenderingContext,
        private readonly renderer: Renderer,
        private readonly onFrame: () => void,
    ) {
        this.smoothSeen = renderer.smoothReady;
    }

    /** Something that the picture depends on is new. */
    change(plan: Plan): void {
        this.plan = plan;
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
        return !this.plan || (!this.restStale && !!this.rest && this.rest.samples >= this.enough && this.presented === this.rest);
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
        return Math.min(this.plan?.samples ?? 1, this.renderer.mostSamples);
    }

    private readonly tick = (): void => {
        this.pending = 0;
        const { gl, plan } = this;
        if (!plan || gl.isContextLost()) return;
        if (!this.renderer.ready) return this.wake();
        if (this.renderer.smoothReady !== this.smoothSeen) {
            this.smoothSeen = this.renderer.smoothReady;
            this.liveStale = this.restStale = true;
        }
        this.fitScreen();
        if (this.waiting && !this.collect()) return this.wake();
        this.collectProbe();
        const now = performance.now();
        const resting = now - this.changed > kRestAfter;
        if (!resting && this.liveStale) this.drawLive(plan);
        else if (resting) this.drawRest(plan);
        if (this.wantsPresent && this.presented) this.show(this.presented);
        this.wantsPresent = false;
        if (!this.finished || this.waiting || !this.smoothSeen) this.wake();
        this.onFrame();
    };

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
        if (canvas && canvas === this.presented) this.presented = undefined;
        canvas?.free();
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
        this.live.samples = 0;
        const shot = this.shotFor(plan, this.live);
        this.renderer.drawBeams(this.live, shot);
        this.turn += 1;
        this.renderer.drawRows(this.live, shot, 0, this.live.height, true, this.turn, kTurns);
        this.renderer.finishSample(this.live);
        this.show(this.live);
        this.liveStale = false;
        this.submit(this.live.width * this.live.height, false);
    }

    private drawRest(plan: Plan): void {
        if (this.restStale || !this.rest) {
            this.rest = this.sized(this.rest, plan.restScale);
            this.rest.samples = 0;
            this.restRow = 0;
            this.restStale = false;
            this.renderer.drawBeams(this.rest, this.shotFor(plan, this.rest));
        }
        const { rest } = this;
        if (rest.samples >= this.enough) {
            if (this.presented !== rest) this.show(rest);
            return;
        }
        const to = Math.min(rest.height, this.restRow + this.stripRows);
        this.renderer.drawRows(rest, this.shotFor(plan, rest), this.restRow, to, false, 0, 1);
        const pixels = rest.width * (to - this.restRow);
        this.restRow = to;
        if (to === rest.height) {
            this.renderer.finishSample(rest);
            this.restRow = 0;
            this.show(rest);
        }
        this.submit(pixels, true);
    }

    private show(canvas: Canvas): void {
        const { plan } = this;
        if (!plan) return;
        this.renderer.present(canvas, this.screen.width, this.screen.height, plan.exposure, plan.toneMapped);
        this.presented = canvas;
    }

    private submit(pixels: number, rest: boolean): void {
        const sync = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        this.gl.flush();
        if (sync) this.waiting = { sync, began: performance.now(), pixels, rest };
    }

    /** @returns whether the GPU has done the last piece of work */
    private collect(): boolean {
        const { gl, waiting } = this;
        if (!waiting) return true;
        if (gl.getSyncParameter(waiting.sync, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
        gl.deleteSync(waiting.sync);
        this.waiting = undefined;
        const now = performance.now();
        const elapsed = now - waiting.began;
        this.overhead = Math.min(this.overhead * 1.01, elapsed);
        const took = Math.max(1, elapsed - 0.9 * this.overhead);
        this.pixelTimes = this.pixelTimes.filter(({ at }) => now - at < 1000);
        this.pixelTimes.push({ at: now, pixels: waiting.pixels });
        if (waiting.rest) {
            const rows = this.stripRows * Math.max(0.25, Math.min(2, kStrip / took));
            const least = Math.ceil(kLeastStrip / (this.rest?.width ?? 1));
            this.stripRows = Math.max(least, Math.round(rows));
        } else {
            this.frameTimes = this.frameTimes.filter((time) => now - time < 1000);
            this.frameTimes.push(now);
            if (took > kFrame) this.scale *= Math.max(0.5, Math.sqrt((0.9 * kFrame) / took));
            else if (took < 0.6 * kFrame) this.scale *= 1.08;
            this.scale = Math.max(kLeastScale, Math.min(1, this.scale));
        }
        if (now - this.probed > kProbeEvery && this.presented && this.presented.samples > 0) {
            this.probed = now;
            this.renderer.probeRays(this.presented);
            this.probeSamples = this.presented.samples;
        }
        return true;
    }

    private collectProbe(): void {
        const rays = this.renderer.collectRays();
        if (rays !== undefined) this.raysPerSample = rays / this.probeSamples;
    }
}
