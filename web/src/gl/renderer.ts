// SPDX-License-Identifier: MIT
//
// Draws samples of a picture, a strip at a time, and shows their mean. When to draw what is the
// engine's business (engine.ts).
import type { CellLayout } from '../octv/cells';
import { type CameraUniforms } from '../view/camera';
import { type PlacedLamps, kLampRow } from '../view/lamps';
import type { Mode, Shadows } from '../view/settings';
import type { Vec3 } from '../view/vec';
import { Program } from './program';
import {
    beamText, kVertexText, keepText, keepVertexText, normalText, pickText, presentText, primaryText, shadeText, storedText,
} from './shader_text';
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

const kModeNumbers: Record<Mode, number> = { shaded: 0, normals: 1, levels: 2, steps: 3, color: 4 };
const kFaceNone = 7;
const kPickAttachments = [0, 1, 2, 3];
const kLightArray = 5; // of kCellArrays
const kBeamBlock = 8;
const kCacheSide = 1024; // of normals, see hit.glsl
export const kProbe = 32;

/** A picture under way: two textures that take turns to hold the sum of the samples. */
export class Canvas {
    readonly targets: { texture: WebGLTexture; frame: WebGLFramebuffer }[];
    readonly beam: { texture: WebGLTexture; frame: WebGLFramebuffer };
    readonly hits: { texture: WebGLTexture; frame: WebGLFramebuffer };
    readonly normals: { texture: WebGLTexture; frame: WebGLFramebuffer };
    samples = 0; // whole ones
    current = 0; // the target that holds them

    constructor(
        private readonly gl: WebGL2RenderingContext,
        readonly width: number,
        readonly height: number,
        format: number,
    ) {
        this.targets = [target(gl, format, width, height), target(gl, format, width, height)];
        const blocks = [Math.ceil(width / kBeamBlock), Math.ceil(height / kBeamBlock)] as const;
        this.beam = target(gl, gl.R32UI, ...blocks);
        this.hits = target(gl, gl.RGBA32UI, width, height);
        this.normals = target(gl, gl.R32UI, width, height);
    }

    get bytes(): number {
        return this.width * this.height * (3 * 16 + 4);
    }

    free(): void {
        for (const { texture, frame } of [...this.targets, this.beam, this.hits, this.normals]) {
            this.gl.deleteFramebuffer(frame);
            this.gl.deleteTexture(texture);
        }
    }
}

function target(gl: WebGL2RenderingContext, format: number, width: number, height: number): { texture: WebGLTexture; frame: WebGLFramebuffer } {
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    return { texture, frame };
}

export class Renderer {
    /** Samples that a sum can hold without losing digits. */
    readonly mostSamples: number;
    readonly name: string;
    words: WordsTexture | undefined;

    private readonly rowBits: number;
    private readonly format: number;
    private readonly parallel: KHR_parallel_shader_compile | null;
    private readonly primary: Program;
    private readonly normals: Program;
    private readonly keeper: Program;
    private readonly shader: Program;
    private readonly cache: { texture: WebGLTexture; frame: WebGLFramebuffer };
    private readonly beams: Program;
    private readonly presenter: Program;
    private stored: Program | undefined; // made for the first file that has light
    private cells: { texture: WordsTexture; layout: CellLayout; ready: boolean } | undefined;
    private readonly noCells: WordsTexture;
    private lamps: { of: PlacedLamps; texture: WebGLTexture } | undefined;
    private picker: Program | undefined;
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
        this.parallel = gl.getExtension('KHR_parallel_shader_compile');
        const info = gl.getExtension('WEBGL_debug_renderer_info');
        this.name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
        gl.bindVertexArray(gl.createVertexArray());
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
        this.cache = target(gl, gl.RGBA32UI, kCacheSide, kCacheSide);
        const program = (text: string): Program => new Program(gl, kVertexText, text, this.parallel);
        this.presenter = program(presentText());
        this.primary = program(primaryText(this.rowBits));
        this.beams = program(beamText(this.rowBits));
        this.shader = program(shadeText(this.rowBits));
        this.keeper = new Program(gl, keepVertexText(this.rowBits), keepText(), this.parallel);
        this.normals = program(normalText(this.rowBits));
        this.noCells = WordsTexture.make(gl, 1, this.rowBits)!;
    }

    /** Drawn by the processor, where no GPU is. */
    get software(): boolean {
        return /swiftshader|llvmpipe|software|basic render/i.test(this.name);
    }

    /** Can pictures be drawn at all? */
    get ready(): boolean {
        return this.presenter.ready && this.primary.ready && this.beams.ready && this.shader.ready && (this.stored?.ready ?? true);
    }
    /** What smooths normals takes longest to compile; until then faces are shown as they are. */
    get smoothReady(): boolean {
        return this.normals.ready && this.keeper.ready;
    }

    /** Room for so many words of a DAG, in place of what was there. @returns whether there is room */
    reserve(words: number): boolean {
        this.words?.free();
        this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, this.cache.frame);
        this.gl.clearBufferuiv(this.gl.COLOR, 0, [0, 0, 0, 0]);
        this.words = WordsTexture.make(this.gl, words, this.rowBits);
        return this.words !== undefined;
    }

    /** Room for what cells look like. @returns whether there is room */
    reserveCells(layout: CellLayout): boolean {
        this.dropCells();
        const texture = WordsTexture.make(this.gl, layout.words, this.rowBits);
        if (!texture) return false;
        this.cells = { texture, layout, ready: false };
        if (layout.begins[kLightArray] !== undefined) {
            this.stored ??= new Program(this.gl, kVertexText, storedText(this.rowBits), this.parallel);
        }
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

    /** The times before which no ray of a block meets anything. Once, before the first sample. */
    drawBeams(canvas: Canvas, shot: Shot): void {
        if (!this.beamsPay(shot)) return;
        const { gl } = this;
        this.beams.use();
        this.setView(this.beams, canvas.width, canvas.height, shot);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.beam.frame);
        gl.viewport(0, 0, Math.ceil(canvas.width / kBeamBlock), Math.ceil(canvas.height / kBeamBlock));
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    /**
     * Adds rows [from, to) of the next sample. The sample counts once `finishSample` is called.
     *
     * @param turn, turns  of the normals that are missing, those of one pixel in `turns` are made
     */
    drawRows(canvas: Canvas, shot: Shot, from: number, to: number, centred: boolean, turn: number, turns: number): void {
        const { gl } = this;
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.enable(gl.SCISSOR_TEST);
        gl.scissor(0, from, canvas.width, to - from);
        const shows = shot.mode === 'shaded' || shot.mode === 'normals';
        const smooth = shot.smooth && shows && this.smoothReady && shot.depth > 0;
        this.drawHits(canvas, shot, centred, smooth);
        if (smooth) {
            this.drawNormals(canvas, shot, from, turn, turns);
            gl.disable(gl.SCISSOR_TEST);
            this.keepNormals(canvas, from, to);
            gl.enable(gl.SCISSOR_TEST);
            gl.viewport(0, 0, canvas.width, canvas.height);
        }
        this.drawShading(canvas, shot, centred, smooth);
        gl.disable(gl.SCISSOR_TEST);
    }

    private drawHits(canvas: Canvas, shot: Shot, centred: boolean, smooth: boolean): void {
        const { gl, primary } = this;
        primary.use();
        this.setView(primary, canvas.width, canvas.height, shot);
        this.setSample(primary, canvas, centred);
        gl.uniform1i(primary.at('use_beam'), this.beamsPay(shot) ? 1 : 0);
        this.bind(primary, 'beam', 1, canvas.beam.texture);
        gl.uniform1i(primary.at('smoothed'), smooth ? 1 : 0);
        this.bind(primary, 'cache', 2, this.cache.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.hits.frame);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    private drawNormals(canvas: Canvas, shot: Shot, from: number, turn: number, turns: number): void {
        const { gl, normals } = this;
        normals.use();
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.words?.texture ?? null);
        gl.uniform1i(normals.at('dag_words'), 0);
        gl.uniform1i(normals.at('depth'), shot.depth);
        gl.uniform1i(normals.at('first_row'), from);
        gl.uniform1i(normals.at('turn'), turn % turns);
        gl.uniform1i(normals.at('turns'), turns);
        this.bind(normals, 'hits', 1, canvas.hits.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.normals.frame);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    private keepNormals(canvas: Canvas, from: number, to: number): void {
        const { gl, keeper } = this;
        keeper.use();
        gl.uniform1i(keeper.at('first_row'), from);
        this.bind(keeper, 'hits', 1, canvas.hits.texture);
        this.bind(keeper, 'normals', 2, canvas.normals.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.cache.frame);
        gl.viewport(0, 0, kCacheSide, kCacheSide);
        gl.drawArrays(gl.POINTS, 0, canvas.width * (to - from));
    }

    private drawShading(canvas: Canvas, shot: Shot, centred: boolean, smooth: boolean): void {
        const { gl } = this;
        const stored = shot.mode === 'shaded' && shot.stored && this.cells?.ready ? this.stored : undefined;
        const shader = stored ?? this.shader;
        shader.use();
        this.setView(shader, canvas.width, canvas.height, shot);
        this.setSample(shader, canvas, centred);
        if (stored) this.setStoredSky(stored, shot.stored!, shot.up);
        else this.setShading(shader, shot);
        this.setCells(shader);
        gl.uniform1i(shader.at('first'), canvas.samples === 0 ? 1 : 0);
        gl.uniform1i(shader.at('smoothed'), smooth ? 1 : 0);
        this.bind(shader, 'hits', 1, canvas.hits.texture);
        this.bind(shader, 'cache', 2, this.cache.texture);
        this.bind(shader, 'sum_before', 3, canvas.targets[canvas.current]!.texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, canvas.targets[1 - canvas.current]!.frame);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    private setSample(program: Program, canvas: Canvas, centred: boolean): void {
        this.gl.uniform1i(program.at('centred'), centred ? 1 : 0);
        this.gl.uniform1i(program.at('sample_number'), canvas.samples);
    }

    finishSample(canvas: Canvas): void {
        canvas.current = 1 - canvas.current;
        canvas.samples += 1;
    }

    present(canvas: Canvas, width: number, height: number, exposure: number, toneMapped: boolean): void {
        const { gl } = this;
        const program = this.presenter;
        program.use();
        this.bind(program, 'sum', 1, canvas.targets[canvas.current]!.texture);
        gl.uniform1f(program.at('samples'), Math.max(1, canvas.samples));
        gl.uniform1f(program.at('exposure'), 2 ** exposure);
        gl.uniform1i(program.at('tone_mapped'), toneMapped ? 1 : 0);
        gl.uniform2f(program.at('canvas'), width, height);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.viewport(0, 0, width, height);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    /** What is behind a pixel of the picture. Waits for the GPU. */
    pick(shot: Shot, width: number, height: number, x: number, y: number): Pick | undefined {
        if (shot.depth === 0 || shot.camera.seesNothing) return undefined;
        const { gl } = this;
        this.picker ??= new Program(gl, kVertexText, pickText(this.rowBits), this.parallel);
        this.pickFrame ??= this.makePickFrame();
        this.picker.use();
        this.setView(this.picker, width, height, shot);
        this.setCells(this.picker);
        gl.uniform2i(this.picker.at('picked'), Math.floor(x), Math.floor(y));
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

    private beamsPay(shot: Shot): boolean {
        return shot.depth > 0 && shot.camera.before === 0;
    }

    private bind(program: Program, sampler: string, unit: number, texture: WebGLTexture): void {
        this.gl.activeTexture(this.gl.TEXTURE0 + unit);
        this.gl.bindTexture(this.gl.TEXTURE_2D, texture);
        this.gl.uniform1i(program.at(sampler), unit);
    }

    private setView(program: Program, width: number, height: number, shot: Shot): void {
        const { gl } = this;
        const { camera } = shot;
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.words?.texture ?? null);
        gl.uniform1i(program.at('dag_words'), 0);
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
        gl.uniform1i(program.at('mode'), kModeNumbers[shot.mode]);
        gl.uniform3fv(program.at('up'), shot.up);
        gl.uniform1f(program.at('depth_levels'), shot.gridDepth);
        gl.uniform1i(program.at('sky_samples'), shot.skySamples);
        gl.uniform1f(program.at('sky_radius'), shot.skyRadius);
        gl.uniform1i(program.at('shadows'), { none: 0, hard: 1, soft: 2 }[shot.shadows]);
        gl.uniform1i(program.at('lamp_count'), shot.lamps.count);
        this.bind(program, 'lamp_texels', 5, this.lampTexture(shot.lamps));
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
        gl.activeTexture(gl.TEXTURE4);
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, (cells?.texture ?? this.noCells).texture);
        gl.uniform1i(program.at('cell_words'), 4);
        gl.uniform1i(program.at('cell_level'), cells?.layout.level ?? 0);
        const begins = cells?.layout.begins ?? [];
        const has = [1, 2, 3, 4].reduce((bits, i) => bits | (begins[i] === undefined ? 0 : 1 << (i - 1)), 0);
        gl.uniform1i(program.at('cell_has'), has);
        gl.uniform1uiv(program.at('cell_begins'), [0, 1, 2, 3, 4, 5].map((i) => begins[i] ?? 0));
    }

    private setStoredSky(program: Program, sky: StoredSky, up: Vec3): void {
        const { gl } = this;
        gl.uniform1i(program.at('sky_kind'), sky.kind);
        gl.uniform1f(program.at('sky_factor'), sky.factor);
        gl.uniform3fv(program.at('sky_colors'), sky.colors.flat());
        gl.uniform3fv(program.at('up'), up);
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
