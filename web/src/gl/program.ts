// SPDX-License-Identifier: MIT

/** The texture unit of each sampler, the same in all programs, so that textures stay where they are. */
export const kUnits = {
    dag_words: 0, hits: 1, cache: 2, sum_before: 3, cell_words: 4, lamp_texels: 5, beam: 6, normals: 7, sum: 8,
} as const;
export type Sampler = keyof typeof kUnits;

export function bindTexture(gl: WebGL2RenderingContext, sampler: Sampler, texture: WebGLTexture): void {
    gl.activeTexture(gl.TEXTURE0 + kUnits[sampler]);
    gl.bindTexture(gl.TEXTURE_2D, texture);
}

/** A program that the browser compiles while the page goes on; programs.ts knows when it may be used. */
export class Program {
    private readonly program: WebGLProgram;
    private readonly shaders: WebGLShader[];
    private readonly uniforms = new Map<string, WebGLUniformLocation | null>();

    constructor(
        private readonly gl: WebGL2RenderingContext,
        vertexText: string,
        fragmentText: string,
        private readonly parallel: KHR_parallel_shader_compile | null,
    ) {
        this.program = gl.createProgram();
        this.shaders = [
            [gl.VERTEX_SHADER, vertexText] as const,
            [gl.FRAGMENT_SHADER, fragmentText] as const,
        ].map(([type, text]) => {
            const shader = gl.createShader(type)!;
            gl.shaderSource(shader, text);
            gl.compileShader(shader);
            gl.attachShader(this.program, shader);
            return shader;
        });
        gl.linkProgram(this.program);
    }

    /** Has the compiler finished? Asking waits for nothing; without the extension nobody can tell. */
    get compiled(): boolean {
        return this.parallel === null || this.gl.getProgramParameter(this.program, this.parallel.COMPLETION_STATUS_KHR) === true;
    }

    /** Makes it ready for use. Waits for the compiler. @throws Error with its words */
    check(): void {
        const { gl } = this;
        if (gl.isContextLost()) return;
        if (!gl.getProgramParameter(this.program, gl.LINK_STATUS)) {
            const log = this.shaders.map((shader) => gl.getShaderInfoLog(shader)).join('\n');
            throw new Error(`The GPU's compiler refuses a shader: ${gl.getProgramInfoLog(this.program)} ${log}`);
        }
        gl.useProgram(this.program);
        for (const [sampler, unit] of Object.entries(kUnits)) {
            const location = gl.getUniformLocation(this.program, sampler);
            if (location) gl.uniform1i(location, unit);
        }
    }

    use(): void {
        this.gl.useProgram(this.program);
    }

    at(name: string): WebGLUniformLocation | null {
        let location = this.uniforms.get(name);
        if (location === undefined) {
            location = this.gl.getUniformLocation(this.program, name);
            this.uniforms.set(name, location);
        }
        return location;
    }
}
