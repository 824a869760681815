// SPDX-License-Identifier: MIT
//
// The textures that a picture is made in.
export const kBeamBlock = 8; // pixels of a side that one beam is for

/** A picture under way: two textures that take turns to hold the sum of the samples. */
export class Canvas {
    readonly targets: Target[];
    readonly beam: Target;
    readonly hits: Target;
    readonly normals: Target;
    samples = 0; // whole ones
    current = 0; // the target that holds them
    hasBeams = false; // of this picture
    shown = 0; // samples in that target: those of the picture before, until one of the new is there

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

    /** Begins a new picture; the one before is shown until a sample of it is there. */
    restart(): void {
        this.samples = 0;
    }

    finishSample(): void {
        this.current = 1 - this.current;
        this.samples += 1;
        this.shown = this.samples;
    }

    free(): void {
        for (const { texture, frame } of [...this.targets, this.beam, this.hits, this.normals]) {
            this.gl.deleteFramebuffer(frame);
            this.gl.deleteTexture(texture);
        }
    }
}

export interface Target {
    texture: WebGLTexture;
    frame: WebGLFramebuffer;
}

export function target(gl: WebGL2RenderingContext, format: number, width: number, height: number): Target {
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
