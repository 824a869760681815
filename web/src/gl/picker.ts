// SPDX-License-Identifier: MIT
//
// Reads what is behind one pixel.
import type { Vec3 } from '../view/vec';
import { target } from './canvas';
import type { Program } from './program';
import type { SceneTextures } from './scene_textures';
import type { Shot } from './shot';
import { setView } from './uniforms';

export interface Pick {
    path: Vec3;
    height: number;
    face: number; // see traverse.h
    time: number;
    steps: number;
    albedo?: Vec3; // linear; of a cell with a colour
    emission?: Vec3; // radiance, where there is any
}

const kFaceNone = 7;
const kAttachments = [0, 1, 2, 3]; // of pick.frag

export class Picker {
    private made: WebGLFramebuffer | undefined;

    constructor(private readonly gl: WebGL2RenderingContext) {}

    /** One pixel of pick.frag's outputs. */
    get frame(): WebGLFramebuffer {
        return (this.made ??= this.makeFrame());
    }

    /** @param program  of pick.frag. Waits for the GPU. */
    pick(program: Program, scene: SceneTextures, shot: Shot, width: number, height: number, x: number, y: number): Pick | undefined {
        if (shot.depth === 0 || shot.camera.seesNothing) return undefined;
        const { gl } = this;
        program.use();
        scene.bindWords();
        setView(gl, program, width, height, shot);
        scene.bindCells(program);
        gl.uniform2i(program.at('picked'), Math.floor(x), Math.floor(y));
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
        gl.viewport(0, 0, 1, 1);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        const [cell, way, albedo, emission] = kAttachments.map((i) => {
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

    private makeFrame(): WebGLFramebuffer {
        const { gl } = this;
        const frame = gl.createFramebuffer();
        const attachments = kAttachments.map((i) => gl.COLOR_ATTACHMENT0 + i);
        const textures = attachments.map(() => target(gl, gl.RGBA32UI, 1, 1).texture);
        gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
        attachments.forEach((attachment, i) => {
            gl.framebufferTexture2D(gl.FRAMEBUFFER, attachment, gl.TEXTURE_2D, textures[i]!, 0);
        });
        gl.drawBuffers(attachments);
        return frame;
    }
}
