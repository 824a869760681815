// SPDX-License-Identifier: MIT
import { type Canvas, target } from './canvas';

const kSide = 32; // pixels that are asked, along a side

/** Reads how many rays some pixels of a picture have taken, without waiting for the GPU. */
export class RayCounter {
    private frame: WebGLFramebuffer | undefined;
    private reading: { buffer: WebGLBuffer; sync: WebGLSync } | undefined;

    constructor(
        private readonly gl: WebGL2RenderingContext,
        private readonly format: number,
    ) {}

    /** Starts to read; collect() has the answer later. */
    ask(canvas: Canvas): void {
        const { gl } = this;
        if (this.format === gl.RGBA8 || this.reading) return;
        this.frame ??= target(gl, this.format, kSide, kSide).frame;
        // A new one each time: browsers that keep copies of such buffers warn of a second use.
        const buffer = gl.createBuffer();
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
        gl.bufferData(gl.PIXEL_PACK_BUFFER, 16 * kSide * kSide, gl.STREAM_READ);
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, canvas.targets[canvas.current]!.frame);
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, this.frame);
        gl.blitFramebuffer(0, 0, canvas.width, canvas.height, 0, 0, kSide, kSide, gl.COLOR_BUFFER_BIT, gl.NEAREST);
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.frame);
        gl.readPixels(0, 0, kSide, kSide, gl.RGBA, gl.FLOAT, 0);
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
        const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        if (sync) this.reading = { buffer, sync };
        else gl.deleteBuffer(buffer);
        gl.flush();
    }

    /** Rays that a pixel has taken in all its samples, on average; undefined until it is known. */
    collect(): number | undefined {
        const { gl, reading } = this;
        if (!reading || gl.getSyncParameter(reading.sync, gl.SYNC_STATUS) !== gl.SIGNALED) return undefined;
        this.reading = undefined;
        const pixels = new Float32Array(4 * kSide * kSide);
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, reading.buffer);
        gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, pixels);
        gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
        gl.deleteBuffer(reading.buffer);
        gl.deleteSync(reading.sync);
        let rays = 0;
        for (let i = 3; i < pixels.length; i += 4) rays += pixels[i]!;
        return rays / (kSide * kSide);
    }
}
