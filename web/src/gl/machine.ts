// SPDX-License-Identifier: MIT

/** What the WebGL 2 of this browser and machine can do. Makes its extensions available. */
export class Machine {
    /** As the driver tells it. */
    readonly name: string;
    /** Of a texture that sums up samples. */
    readonly format: number;
    /** Samples that such a sum can hold without losing digits. */
    readonly mostSamples: number;
    /** Of the texture that holds words: see dag.glsl. */
    readonly rowBits: number;
    /** Says when a program is compiled, without waiting; null where nobody can tell. */
    readonly parallel: KHR_parallel_shader_compile | null;

    constructor(gl: WebGL2RenderingContext) {
        const size = gl.getParameter(gl.MAX_TEXTURE_SIZE) as number;
        this.rowBits = size >= 4096 ? 12 : 11;
        const floats = gl.getExtension('EXT_color_buffer_float');
        const halfs = floats ? null : gl.getExtension('EXT_color_buffer_half_float');
        this.format = floats ? gl.RGBA32F : halfs ? gl.RGBA16F : gl.RGBA8;
        this.mostSamples = floats ? 4096 : halfs ? 64 : 1;
        this.parallel = gl.getExtension('KHR_parallel_shader_compile');
        const info = gl.getExtension('WEBGL_debug_renderer_info');
        this.name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
    }

    /** Drawn by the processor, where no GPU is. */
    get software(): boolean {
        return /swiftshader|llvmpipe|software|basic render/i.test(this.name);
    }
}
