// SPDX-License-Identifier: MIT

/** The words of a DAG in an array of R32UI layers, filled from the first word on. */
export class WordsTexture {
    readonly texture: WebGLTexture;
    private readonly rowWords: number;
    private readonly row: Uint32Array; // the one that is not full yet
    private filled = 0; // words

    /** @returns undefined where the GPU has no room for so many words */
    static make(gl: WebGL2RenderingContext, words: number, rowBits: number): WordsTexture | undefined {
        while (gl.getError() !== gl.NO_ERROR);
        const texture = new WordsTexture(gl, words, rowBits);
        if (gl.getError() === gl.NO_ERROR || gl.isContextLost()) return texture;
        texture.free();
        return undefined;
    }

    private constructor(
        private readonly gl: WebGL2RenderingContext,
        words: number,
        rowBits: number,
    ) {
        this.rowWords = 1 << rowBits;
        this.row = new Uint32Array(this.rowWords);
        const rows = Math.max(1, Math.ceil(words / this.rowWords));
        const layers = Math.ceil(rows / this.rowWords);
        this.texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture);
        gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.R32UI, this.rowWords, Math.min(rows, this.rowWords), layers);
    }

    append(words: Uint32Array): void {
        for (let at = 0; at < words.length; ) {
            const column = this.filled % this.rowWords;
            const inLayer = this.rowWords - ((this.filled / this.rowWords) % this.rowWords | 0);
            const wholeRows = Math.min(inLayer, Math.floor((words.length - at) / this.rowWords));
            if (column === 0 && wholeRows > 0) {
                const count = wholeRows * this.rowWords;
                this.upload(words.subarray(at, at + count), wholeRows);
                this.filled += count;
                at += count;
                continue;
            }
            const count = Math.min(this.rowWords - column, words.length - at);
            this.row.set(words.subarray(at, at + count), column);
            const begin = this.filled;
            this.filled = begin - column;
            this.upload(this.row, 1);
            this.filled = begin + count;
            at += count;
        }
    }

    get bytes(): number {
        return 4 * this.filled;
    }

    free(): void {
        this.gl.deleteTexture(this.texture);
    }

    /** Writes rows from word `filled` on, which is the first of a row. */
    private upload(words: Uint32Array, rows: number): void {
        const { gl } = this;
        const row = Math.floor(this.filled / this.rowWords);
        const layer = Math.floor(row / this.rowWords);
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture);
        gl.texSubImage3D(
            gl.TEXTURE_2D_ARRAY, 0, 0, row % this.rowWords, layer, this.rowWords, rows, 1,
            gl.RED_INTEGER, gl.UNSIGNED_INT, words,
        );
    }
}
