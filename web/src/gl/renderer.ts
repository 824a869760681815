// SPDX-License-Identifier: MIT
//
// Draws samples of a picture, a strip at a time, and shows their mean. When to draw what is the
// engine's business (engine.ts).
import type { CellLayout } from '../octv/cells';
import { type CameraUniforms } from '../view/camera';
import { type PlacedLamps, kLampRow } from '../view/lamps';
import type { Mode, Shadows } from '../view/settings';
import type { Vec3 } from '../view/vec';
import { Canvas, type Target, kBeamBlock, target } from './canvas';
import { type Program, type Sampler, kUnits } from './program';
import { type Painting, Programs, type Recipe, kAnyLamp, kCells, kSmooth } from './programs';
import { WordsTexture } from './words_texture';

/** All that a sample of the picture depends on. */
export interface Shot {
    camera: CameraUniforms;
    depth: number; // of what may be traced: 0 for nothing
    gridDepth: number;
    stopHeight: number;
    cone: number;
    mode: Mode;
    smooth: boolean;
    cells: boolean; // the scene has colours
    stored?: StoredSky; // shaded by the light of the cells, under this sky
    up: Vec3;
    skySamples: number;
    skyRadius: number; // voxels
    shadows: Shadows;
    lamps: PlacedLamps;
}

export interface StoredSky {
    kind: number; // of sky_radiance.h
    factor: number;
    colors: [Vec3, Vec3, Vec3]; // zenith, horizon, ground
}

export interface Pick {
    path: Vec3;
    height: number;
    face: number; // see traverse.h
    time: number;
    steps: number;
    albedo?: Vec3; // linear; of a cell with a colour
    emission?: Vec3; // radiance, where there is any
}

const kModeNumbers: Record<Mode, number> = { shaded: 0, normals: 1, levels: 2, steps: 3, color: 4 }; // of views.frag
const kFaceNone = 7;
const kPickAttachments = [0, 1, 2, 3];
const kCacheSide = 1024; // of normals, see hit.glsl
export const kProbe = 32;

const kFirst: Recipe[] = [{ part: 'preview' }, { part: 'present' }];

/** What can be drawn of what was asked for: nothing, a preview, all but smoothed normals, all. */
export type Means = 'none' | 'preview' | 'faces' | 'all';

/** The program that paints the shot. */
function paintingOf(shot: Shot): { painting: Painting; features: number } {
    const cells = shot.cells ? kCells : 0;
    const smooth = shot.smooth && (shot.mode === 'shaded' || shot.mode === 'normals') ? kSmooth : 0;
    if (shot.mode !== 'shaded') return { painting: 'views', features: cells | smooth };
    if (shot.stored) return { painting: 'stored', features: kCells | smooth };
    return { painting: 'shade', features: cells | smooth | (shot.lamps.onlySuns ? 0 : kAnyLamp) };
}

export class Renderer {
    /** Samples that a sum can hold without losing digits. */
    readonly mostSamples: number;
    readonly name: string;
    words: WordsTexture | undefined;

    private readonly rowBits: number;
    private readonly format: number;
    private readonly programs: Programs;
    private readonly blank: Canvas; // of one pixel: what new programs draw first
    private readonly screenLike: Target; // a pixel as the screen's
    private cacheTarget: Target | undefined; // of normals, see hit.glsl
    private cells: { texture: WordsTexture; layout: CellLayout; ready: boolean } | undefined;
    private readonly noCells: WordsTexture;
    private lamps: { of: PlacedLamps; texture: WebGLTexture } | undefined;
    private pickFrame: WebGLFramebuffer | undefined;
    private probeFrame: WebGLFramebuffer | undefined;
    private probing: { buffer: WebGLBuffer; sync: WebGLSync } | undefined;

    constructor(private readonly gl: WebGL2RenderingContext) {
        const size = gl.getParameter(gl.MAX_TEXTURE_SIZE) as number;
        this.rowBits = size >= 4096 ? 12 : 11;
        const floats = gl.getExtension('EXT_color_buffer_float');
        const halfs = floats ? null : gl.getExtension('EXT_color_buffer_half_float');
        this.format = floats ? gl.RGBA32F : halfs ? gl.RGBA16F : gl.RGBA8;
        this.mostSamples = floats ? 4096 : halfs ? 64 : 1;
        const parallel = gl.getExtension('KHR_parallel_shader_compile');
        const info = gl.getExtension('WEBGL_debug_renderer_info');
        this.name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
        gl.bindVertexArray(gl.createVertexArray());
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
        this.programs = new Programs(gl, this.rowBits, parallel, (program, recipe) => this.warm(program, recipe), kFirst);
        this.blank = this.makeCanvas(1, 1);
        this.screenLike = target(gl, gl.RGBA8, 1, 1);
        this.noCells = WordsTexture.make(gl, 1, this.rowBits)!;
    }

    /** Drawn by the processor, where no GPU is. */
    get software(): boolean {
        return /swiftshader|llvmpipe|software|basic render/i.test(this.name);
    }

    /** Announces what is to be drawn, so that the programs for it are made. */
    prepare(shot: Shot): void {
        const { painting, features } = paintingOf(shot);
        const cells = features & kCells;
        this.programs.want([
            { part: 'primary' },
            { painting, features: features & ~kSmooth },
            { part: 'beam' },
            ...(features & kSmooth ? ([{ part: 'normals' }, { part: 'keep' }, { painting, features }] as Recipe[]) : []),
            { part: 'pick' },
            // One press away, so that it does not wait for the compiler then.
            { painting: painting === 'views' ? 'shade' : 'views', features: cells },
        ]);
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
        const { painting, features } = paintingOf(shot);
        const { programs } = this;
        if (!programs.part('present')) return 'none';
        if (!programs.part('primary') || !programs.painter(painting, features & ~kSmooth)) return programs.part('preview') ? 'preview' : 'none';
        if ((features & kSmooth) === 0) return 'all';
        return this.smoothing(shot) ? 'all' : 'faces';
    }

    /** Are normals smoothed, and is all there that it takes? */
    private smoothing(shot: Shot): boolean {
        const { painting, features } = paintingOf(shot);
        const { programs } = this;
        return (features & kSmooth) !== 0 && !!programs.part('normals') && !!programs.part('keep') && !!programs.painter(painting, features);
    }

    /** A pixel of a new program. All uniforms are zero, so no ray goes anywhere. */
    private warm(program: Program, recipe: Recipe): void {
        const { gl, blank } = this;
        this.bind('hits', blank.hits.texture);
        this.bind('normals', blank.normals.texture);
        this.bind('beam', blank.beam.texture);
        this.bind('cache', this.cache.texture);
        this.bind('sum_before', blank.targets[0]!.texture);
        this.bind('sum', blank.targets[0]!.texture);
        const part = 'part' in recipe ? recipe.part : 'paint';
        const frames = { present: this.screenLike, primary: blank.hits, beam: blank.beam, normals: blank.normals, keep: this.cache, paint: blank.targets[1]!, preview: blank.targets[1]! };
        gl.bindFramebuffer(gl.FRAMEBUFFER, part === 'pick' ? (this.pickFrame ??= this.makePickFrame()) : frames[part as keyof typeof frames].frame);
        gl.viewport(0, 0, 1, 1);
        program.use();
        gl.drawArrays(part === 'keep' ? gl.POINTS : gl.TRIANGLES, 0, part === 'keep' ? 1 : 3);
    }

    private get cache(): Target {
        return (this.cacheTarget ??= target(this.gl, this.gl.RGBA32UI, kCacheSide, kCacheSide));
    }

    /** Room for so many words of a DAG, in place of what was there. @returns whether there is room */
    reserve(words: number): boolean {
        this.words?.free();
        if (this.cacheTarget) {
            this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, this.cacheTarget.frame);
            this.gl.clearBufferuiv(this.gl.COLOR, 0, [0, 0, 0, 0]);
        }
        this.words = WordsTexture.make(this.gl, words, this.rowBits);
        return this.words !== undefined;
    }

    /** Room for what cells look like. @returns whether there is room */
    reserveCells(layout: CellLayout): boolean {
        this.dropCells();
        const texture = WordsTexture.make(this.gl, layout.words, this.rowBits);
        if (!texture) return false;
        this.cells = { texture, layout, ready: false };
        return true;
    }
    appendCells(words: Uint32Array): void {
        this.cells?.texture.append(words);
    }
    /** All that was announced has come: from now on it is shown. */
    showCells(): void {
        if (this.cells) this.cells.ready = true;
    }
    dropCells(): void {
        this.cells?.texture.free();
        this.cells = undefined;
    }
    /** Bytes of the scene on the GPU. */
    get sceneBytes(): number {
        return (this.words?.bytes ?? 0) + (this.cells?.texture.bytes ?? 0);
    }

    makeCanvas(width: number, height: number): Canvas {
        return new Canvas(this.gl, width, height, this.format);
    }

    /** A whole picture, quick and plain. */
    drawPreview(canvas: Canvas, shot: Shot): void {
        const { gl } = this;
        const program = this.programs.part('preview')!;
        program.use();
        this.setView(program, canvas.width, canvas.height, shot);
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
        canvas.hasBeams = beams !== undefined && shot.depth > 0 && shot.camera.before === 0;
        if (!beams || !canvas.hasBeams) return;
        const { gl } = this;
        beams.use();
        this.setView(beams, canvas.width, canvas.height, shot);
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
        const smooth = this.smoothing(shot);
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

    private drawHits(canvas: Canvas, shot: Shot, centred: boolean, smooth: boolean): void {
        const { gl } = this;
        const primary = this.programs.part('primary')!;
        primary.use();
        this.setView(primary, canvas.width, canvas.height, shot);
        this.setSample(primary, canvas, centred);
        gl.uniform1i(primary.at('use_beam'), canvas.hasBeams ? 1 : 0);
        this.bind('beam', canvas.beam.texture);
        gl.uniform1i(primary.at('smoothed'), smooth ? 1 : 0);
        if (smooth) this.bind('cache', this.cache.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.hits.frame);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    private drawNormals(canvas: Canvas, shot: Shot, from: number, turn: number, turns: number): void {
        const { gl } = this;
        const normals = this.programs.part('normals')!;
        normals.use();
        this.bindWords();
        gl.uniform1i(normals.at('depth'), shot.depth);
        gl.uniform1i(normals.at('first_row'), from);
        gl.uniform1i(normals.at('turn'), turn % turns);
        gl.uniform1i(normals.at('turns'), turns);
        this.bind('hits', canvas.hits.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.normals.frame);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    private keepNormals(canvas: Canvas, from: number, to: number): void {
        const { gl } = this;
        const keeper = this.programs.part('keep')!;
        keeper.use();
        gl.uniform1i(keeper.at('first_row'), from);
        this.bind('hits', canvas.hits.texture);
        this.bind('normals', canvas.normals.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.cache.frame);
        gl.viewport(0, 0, kCacheSide, kCacheSide);
        gl.drawArrays(gl.POINTS, 0, canvas.width * (to - from));
    }

    private paint(canvas: Canvas, shot: Shot, centred: boolean, smooth: boolean): void {
        const { gl } = this;
        const { painting, features } = paintingOf(shot);
        const program = this.programs.painter(painting, smooth ? features : features & ~kSmooth)!;
        program.use();
        this.setView(program, canvas.width, canvas.height, shot);
        this.setSample(program, canvas, centred);
        gl.uniform3fv(program.at('up'), shot.up);
        if (painting === 'stored') this.setStoredSky(program, shot.stored!);
        else if (painting === 'views') this.setViews(program, shot);
        else this.setShading(program, shot);
        this.setCells(program);
        gl.uniform1i(program.at('first'), canvas.samples === 0 ? 1 : 0);
        gl.uniform1i(program.at('smoothed'), smooth ? 1 : 0);
        this.bind('hits', canvas.hits.texture);
        if (smooth) this.bind('cache', this.cache.texture);
        this.bind('sum_before', canvas.targets[canvas.current]!.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.targets[1 - canvas.current]!.frame);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    private setSample(program: Program, canvas: Canvas, centred: boolean): void {
        this.gl.uniform1i(program.at('centred'), centred ? 1 : 0);
        this.gl.uniform1i(program.at('sample_number'), canvas.samples);
    }

    present(canvas: Canvas, width: number, height: number, exposure: number, toneMapped: boolean): void {
        const { gl } = this;
        const program = this.programs.part('present')!;
        program.use();
        this.bind('sum', canvas.targets[canvas.current]!.texture);
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
        const picker = this.programs.part('pick');
        if (!picker || shot.depth === 0 || shot.camera.seesNothing) return undefined;
        const { gl } = this;
        this.pickFrame ??= this.makePickFrame();
        picker.use();
        this.setView(picker, width, height, shot);
        this.setCells(picker);
        gl.uniform2i(picker.at('picked'), Math.floor(x), Math.floor(y));
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.pickFrame);
        gl.viewport(0, 0, 1, 1);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        const [cell, way, albedo, emission] = kPickAttachments.map((i) => {
            const values = new Uint32Array(4);
            gl.readBuffer(gl.COLOR_ATTACHMENT0 + i);
            gl.readPixels(0, 0, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, values);
            return values;
        }) as [Uint32Array, Uint32Array, Uint32Array, Uint32Array];
        const face = cell[3]! & 255;
        if (face === kFaceNone) return undefined;
        const floats = (words: Uint32Array): Vec3 => [...new Float32Array(words.buffer, 0, 3)] as Vec3;
        const found: Pick = { path: [cell[0]!, cell[1]!, cell[2]!], height: cell[3]! >>> 8, face, time: floats(way)[0], steps: way[1]! };
        if (albedo[3] === 1) found.albedo = floats(albedo);
        if (floats(emission).some((value) => value > 0)) found.emission = floats(emission);
        return found;
    }

    /** Starts to read how many rays some pixels have taken; collectRays() has the answer later. */
    probeRays(canvas: Canvas): void {
        const { gl } = this;
        if (this.format === gl.RGBA8 || this.probing) return;
        this.probeFrame ??= target(gl, this.format, kProbe, kProbe).frame;
        // A new one each time: browsers that keep copies of such buffers warn of a second use.
        const buffer = gl.createBuffer();
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
        gl.bufferData(gl.PIXEL_PACK_BUFFER, 16 * kProbe * kProbe, gl.STREAM_READ);
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, canvas.targets[canvas.current]!.frame);
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, this.probeFrame);
        gl.blitFramebuffer(0, 0, canvas.width, canvas.height, 0, 0, kProbe, kProbe, gl.COLOR_BUFFER_BIT, gl.NEAREST);
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.probeFrame);
        gl.readPixels(0, 0, kProbe, kProbe, gl.RGBA, gl.FLOAT, 0);
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
        const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        if (sync) this.probing = { buffer, sync };
        else gl.deleteBuffer(buffer);
        gl.flush();
    }

    /** Rays that a pixel has taken in all its samples, on average; undefined until it is known. */
    collectRays(): number | undefined {
        const { gl } = this;
        const probing = this.probing;
        if (!probing || gl.getSyncParameter(probing.sync, gl.SYNC_STATUS) !== gl.SIGNALED) return undefined;
        this.probing = undefined;
        const pixels = new Float32Array(4 * kProbe * kProbe);
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, probing.buffer);
        gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, pixels);
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
        gl.deleteBuffer(probing.buffer);
        gl.deleteSync(probing.sync);
        let rays = 0;
        for (let i = 3; i < pixels.length; i += 4) rays += pixels[i]!;
        return rays / (kProbe * kProbe);
    }

    private bind(sampler: Sampler, texture: WebGLTexture): void {
        this.gl.activeTexture(this.gl.TEXTURE0 + kUnits[sampler]);
        this.gl.bindTexture(this.gl.TEXTURE_2D, texture);
    }

    private bindWords(): void {
        this.gl.activeTexture(this.gl.TEXTURE0 + kUnits.dag_words);
        this.gl.bindTexture(this.gl.TEXTURE_2D_ARRAY, this.words?.texture ?? null);
    }

    private setView(program: Program, width: number, height: number, shot: Shot): void {
        const { gl } = this;
        const { camera } = shot;
        this.bindWords();
        gl.uniform2i(program.at('picture'), width, height);
        gl.uniform1i(program.at('depth'), camera.seesNothing ? 0 : shot.depth);
        gl.uniform3iv(program.at('eye_cell'), camera.cell);
        gl.uniform3fv(program.at('eye_frac'), camera.frac);
        gl.uniform3fv(program.at('view_forward'), camera.forward);
        gl.uniform3fv(program.at('view_right'), camera.right);
        gl.uniform3fv(program.at('view_down'), camera.down);
        gl.uniform1f(program.at('t_before'), camera.before);
        gl.uniform1i(program.at('primary_stop.height'), shot.stopHeight);
        gl.uniform1f(program.at('primary_stop.cone'), shot.cone);
        gl.uniform1f(program.at('primary_stop.time_before'), camera.before);
    }

    private setShading(program: Program, shot: Shot): void {
        const { gl } = this;
        gl.uniform1i(program.at('sky_samples'), shot.skySamples);
        gl.uniform1f(program.at('sky_radius'), shot.skyRadius);
        gl.uniform1i(program.at('shadows'), { none: 0, hard: 1, soft: 2 }[shot.shadows]);
        gl.uniform1i(program.at('lamp_count'), shot.lamps.count);
        this.bind('lamp_texels', this.lampTexture(shot.lamps));
    }

    private setViews(program: Program, shot: Shot): void {
        this.gl.uniform1i(program.at('mode'), kModeNumbers[shot.mode]);
        this.gl.uniform1f(program.at('depth_levels'), shot.gridDepth);
    }

    private lampTexture(lamps: PlacedLamps): WebGLTexture {
        if (this.lamps?.of === lamps) return this.lamps.texture;
        const { gl } = this;
        if (this.lamps) gl.deleteTexture(this.lamps.texture);
        const rows = lamps.texels.length / (4 * kLampRow);
        const { texture, frame } = target(gl, gl.RGBA32UI, kLampRow, rows);
        gl.deleteFramebuffer(frame);
        gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, kLampRow, rows, gl.RGBA_INTEGER, gl.UNSIGNED_INT, lamps.texels);
        this.lamps = { of: lamps, texture };
        return texture;
    }

    private setCells(program: Program): void {
        const { gl } = this;
        const cells = this.cells?.ready ? this.cells : undefined;
        gl.activeTexture(gl.TEXTURE0 + kUnits.cell_words);
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, (cells?.texture ?? this.noCells).texture);
        gl.uniform1i(program.at('cell_level'), cells?.layout.level ?? 0);
        const begins = cells?.layout.begins ?? [];
        const has = [1, 2, 3, 4].reduce((bits, i) => bits | (begins[i] === undefined ? 0 : 1 << (i - 1)), 0);
        gl.uniform1i(program.at('cell_has'), has);
        gl.uniform1uiv(program.at('cell_begins'), [0, 1, 2, 3, 4, 5].map((i) => begins[i] ?? 0));
    }

    private setStoredSky(program: Program, sky: StoredSky): void {
        const { gl } = this;
        gl.uniform1i(program.at('sky_kind'), sky.kind);
        gl.uniform1f(program.at('sky_factor'), sky.factor);
        gl.uniform3fv(program.at('sky_colors'), sky.colors.flat());
    }

    private makePickFrame(): WebGLFramebuffer {
        const { gl } = this;
        const frame = gl.createFramebuffer();
        const attachments = kPickAttachments.map((i) => gl.COLOR_ATTACHMENT0 + i);
        const textures = attachments.map(() => target(gl, gl.RGBA32UI, 1, 1).texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
        attachments.forEach((attachment, i) => {
            gl.framebufferTexture2D(gl.FRAMEBUFFER, attachment, gl.TEXTURE_2D, textures[i]!, 0);
        });
        gl.drawBuffers(attachments);
        return frame;
    }
}
