// SPDX-License-Identifier: MIT
//
// Draws samples of a picture, a strip at a time, and shows their mean. When to draw what is the
// engine's business (engine.ts).
import { Canvas, type Target, kBeamBlock, target } from './canvas';
import type { Machine } from './machine';
import { type Means, canSmooth, kFirst, meansFor, paintingOf, recipesFor } from './needs';
import { type Pick, Picker } from './picker';
import { type Program, bindTexture } from './program';
import { Programs, type Recipe, kSmooth } from './programs';
import type { SceneTextures } from './scene_textures';
import type { Shot } from './shot';
import { setSample, setShading, setStoredSky, setView, setViews } from './uniforms';

const kCacheSide = 1024; // of normals, see hit.glsl

export class Renderer {
    private readonly programs: Programs;
    private readonly picker: Picker;
    private readonly blank: Canvas; // of one pixel: what new programs draw first
    private readonly screenLike: Target; // a pixel as the screen's
    private cacheTarget: Target | undefined; // of normals, see hit.glsl

    constructor(
        private readonly gl: WebGL2RenderingContext,
        readonly machine: Machine,
        private readonly scene: SceneTextures,
    ) {
        gl.bindVertexArray(gl.createVertexArray());
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
        this.programs = new Programs(gl, machine.rowBits, machine.parallel, (program, recipe) => this.warm(program, recipe), kFirst);
        this.picker = new Picker(gl);
        this.blank = this.makeCanvas(1, 1);
        this.screenLike = target(gl, gl.RGBA8, 1, 1);
    }

    /** Announces what is to be drawn, so that the programs for it are made. */
    prepare(shot: Shot): void {
        this.programs.want(recipesFor(shot));
    }
    /** Takes the programs on where some are missing. @returns whether the GPU has something to do now */
    prepareMore(): boolean {
        return this.programs.busy && this.programs.step();
    }
    /** Are programs still being made? */
    get preparing(): boolean {
        return this.programs.busy;
    }
    /** How well a shot can be drawn with the programs that are there. */
    means(shot: Shot): Means {
        return meansFor(this.programs, shot);
    }

    /** A pixel of a new program. All uniforms are zero, so no ray goes anywhere. */
    private warm(program: Program, recipe: Recipe): void {
        const { gl, blank } = this;
        bindTexture(gl, 'hits', blank.hits.texture);
        bindTexture(gl, 'normals', blank.normals.texture);
        bindTexture(gl, 'beam', blank.beam.texture);
        bindTexture(gl, 'cache', this.cache.texture);
        bindTexture(gl, 'sum_before', blank.targets[0]!.texture);
        bindTexture(gl, 'sum', blank.targets[0]!.texture);
        const part = 'part' in recipe ? recipe.part : 'paint';
        const frames = { present: this.screenLike, primary: blank.hits, beam: blank.beam, normals: blank.normals, keep: this.cache, paint: blank.targets[1]!, preview: blank.targets[1]! };
        gl.bindFramebuffer(gl.FRAMEBUFFER, part === 'pick' ? this.picker.frame : frames[part].frame);
        gl.viewport(0, 0, 1, 1);
        program.use();
        gl.drawArrays(part === 'keep' ? gl.POINTS : gl.TRIANGLES, 0, part === 'keep' ? 1 : 3);
    }

    private get cache(): Target {
        return (this.cacheTarget ??= target(this.gl, this.gl.RGBA32UI, kCacheSide, kCacheSide));
    }

    /** Another scene: its cells have other normals. */
    forgetNormals(): void {
        if (!this.cacheTarget) return;
        this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, this.cacheTarget.frame);
        this.gl.clearBufferuiv(this.gl.COLOR, 0, [0, 0, 0, 0]);
    }

    makeCanvas(width: number, height: number): Canvas {
        return new Canvas(this.gl, width, height, this.machine.format);
    }

    /** A whole picture, quick and plain. */
    drawPreview(canvas: Canvas, shot: Shot): void {
        const { gl } = this;
        const program = this.programs.part('preview')!;
        this.begin(program, canvas.width, canvas.height, shot);
        gl.uniform3fv(program.at('up'), shot.up);
        gl.uniform3fv(program.at('sun'), shot.lamps.sun.towards);
        gl.uniform3fv(program.at('sun_light'), shot.lamps.sun.intensity);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.targets[1 - canvas.current]!.frame);
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        canvas.finishSample();
    }

    /** The times before which no ray of a block meets anything. Once, before the first sample. */
    drawBeams(canvas: Canvas, shot: Shot): void {
        const beams = this.programs.part('beam');
        // Where the steps themselves are shown, a ray takes all of its own.
        canvas.hasBeams = beams !== undefined && shot.depth > 0 && shot.camera.before === 0 && shot.mode !== 'steps';
        if (!beams || !canvas.hasBeams) return;
        const { gl } = this;
        this.begin(beams, canvas.width, canvas.height, shot);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.beam.frame);
        gl.viewport(0, 0, Math.ceil(canvas.width / kBeamBlock), Math.ceil(canvas.height / kBeamBlock));
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    /**
     * Adds rows [from, to) of the next sample, which counts once the canvas has finished it.
     *
     * @param turn, turns  of the normals that are missing, those of one pixel in `turns` are made
     */
    drawRows(canvas: Canvas, shot: Shot, from: number, to: number, centred: boolean, turn: number, turns: number): void {
        const { gl } = this;
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.enable(gl.SCISSOR_TEST);
        gl.scissor(0, from, canvas.width, to - from);
        const smooth = canSmooth(this.programs, shot);
        this.drawHits(canvas, shot, centred, smooth);
        if (smooth) {
            this.drawNormals(canvas, shot, from, turn, turns);
            gl.disable(gl.SCISSOR_TEST);
            this.keepNormals(canvas, from, to);
            gl.enable(gl.SCISSOR_TEST);
            gl.viewport(0, 0, canvas.width, canvas.height);
        }
        this.paint(canvas, shot, centred, smooth);
        gl.disable(gl.SCISSOR_TEST);
    }

    private begin(program: Program, width: number, height: number, shot: Shot): void {
        program.use();
        this.scene.bindWords();
        setView(this.gl, program, width, height, shot);
    }

    private drawHits(canvas: Canvas, shot: Shot, centred: boolean, smooth: boolean): void {
        const { gl } = this;
        const primary = this.programs.part('primary')!;
        this.begin(primary, canvas.width, canvas.height, shot);
        setSample(gl, primary, canvas, centred);
        gl.uniform1i(primary.at('use_beam'), canvas.hasBeams ? 1 : 0);
        bindTexture(gl, 'beam', canvas.beam.texture);
        gl.uniform1i(primary.at('smoothed'), smooth ? 1 : 0);
        if (smooth) bindTexture(gl, 'cache', this.cache.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.hits.frame);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    private drawNormals(canvas: Canvas, shot: Shot, from: number, turn: number, turns: number): void {
        const { gl } = this;
        const normals = this.programs.part('normals')!;
        normals.use();
        this.scene.bindWords();
        gl.uniform1i(normals.at('depth'), shot.depth);
        gl.uniform1i(normals.at('first_row'), from);
        gl.uniform1i(normals.at('turn'), turn % turns);
        gl.uniform1i(normals.at('turns'), turns);
        bindTexture(gl, 'hits', canvas.hits.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.normals.frame);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    private keepNormals(canvas: Canvas, from: number, to: number): void {
        const { gl } = this;
        const keeper = this.programs.part('keep')!;
        keeper.use();
        gl.uniform1i(keeper.at('first_row'), from);
        bindTexture(gl, 'hits', canvas.hits.texture);
        bindTexture(gl, 'normals', canvas.normals.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.cache.frame);
        gl.viewport(0, 0, kCacheSide, kCacheSide);
        gl.drawArrays(gl.POINTS, 0, canvas.width * (to - from));
    }

    private paint(canvas: Canvas, shot: Shot, centred: boolean, smooth: boolean): void {
        const { gl } = this;
        const { painting, features } = paintingOf(shot);
        const program = this.programs.painter(painting, smooth ? features : features & ~kSmooth)!;
        this.begin(program, canvas.width, canvas.height, shot);
        setSample(gl, program, canvas, centred);
        gl.uniform3fv(program.at('up'), shot.up);
        if (painting === 'stored') {
            setStoredSky(gl, program, shot.stored!);
        } else if (painting === 'views') {
            setViews(gl, program, shot);
        } else {
            setShading(gl, program, shot);
            this.scene.bindLamps(program, shot.lamps);
        }
        this.scene.bindCells(program);
        gl.uniform1i(program.at('first'), canvas.samples === 0 ? 1 : 0);
        gl.uniform1i(program.at('smoothed'), smooth ? 1 : 0);
        bindTexture(gl, 'hits', canvas.hits.texture);
        if (smooth) bindTexture(gl, 'cache', this.cache.texture);
        bindTexture(gl, 'sum_before', canvas.targets[canvas.current]!.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.targets[1 - canvas.current]!.frame);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    present(canvas: Canvas, width: number, height: number, exposure: number, toneMapped: boolean): void {
        const { gl } = this;
        const program = this.programs.part('present')!;
        program.use();
        bindTexture(gl, 'sum', canvas.targets[canvas.current]!.texture);
        gl.uniform1f(program.at('samples'), Math.max(1, canvas.shown));
        gl.uniform1f(program.at('exposure'), 2 ** exposure);
        gl.uniform1i(program.at('tone_mapped'), toneMapped ? 1 : 0);
        gl.uniform2f(program.at('canvas'), width, height);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.viewport(0, 0, width, height);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    /** Is the program for pick() there? */
    get canPick(): boolean {
        return this.programs.part('pick') !== undefined;
    }
    /** What is behind a pixel of the picture. Waits for the GPU. */
    pick(shot: Shot, width: number, height: number, x: number, y: number): Pick | undefined {
        const program = this.programs.part('pick');
        return program && this.picker.pick(program, this.scene, shot, width, height, x, y);
    }
}
