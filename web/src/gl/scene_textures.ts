// SPDX-License-Identifier: MIT
//
// The scene on the GPU: the words of its DAG, what its cells look like, and its lamps.
import type { CellLayout } from '../octv/cells';
import { type PlacedLamps, kLampRow } from '../view/lamps';
import { target } from './canvas';
import { type Program, bindTexture, kUnits } from './program';
import { WordsTexture } from './words_texture';

export class SceneTextures {
    private words: WordsTexture | undefined;
    private cells: { texture: WordsTexture; layout: CellLayout; ready: boolean } | undefined;
    private readonly noCells: WordsTexture;
    private lamps: { of: PlacedLamps; texture: WebGLTexture } | undefined;

    constructor(
        private readonly gl: WebGL2RenderingContext,
        private readonly rowBits: number,
    ) {
        this.noCells = WordsTexture.make(gl, 1, rowBits)!;
    }

    /** Room for so many words of a DAG, in place of what was there. @returns whether there is room */
    reserve(words: number): boolean {
        this.words?.free();
        this.words = WordsTexture.make(this.gl, words, this.rowBits);
        return this.words !== undefined;
    }
    append(words: Uint32Array): void {
        this.words?.append(words);
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

    get bytes(): number {
        return (this.words?.bytes ?? 0) + (this.cells?.texture.bytes ?? 0);
    }

    bindWords(): void {
        this.gl.activeTexture(this.gl.TEXTURE0 + kUnits.dag_words);
        this.gl.bindTexture(this.gl.TEXTURE_2D_ARRAY, this.words?.texture ?? null);
    }

    /** The texture and the uniforms of cells.glsl. */
    bindCells(program: Program): void {
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

    /** The texture and the uniform of lamps.glsl. */
    bindLamps(program: Program, lamps: PlacedLamps): void {
        this.gl.uniform1i(program.at('lamp_count'), lamps.count);
        bindTexture(this.gl, 'lamp_texels', this.lampTexture(lamps));
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
}
