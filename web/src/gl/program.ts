// SPDX-License-Identifier: MIT

/** A program that the browser compiles while the page goes on. */
export class Program {
    private readonly program: WebGLProgram;
    private readonly shaders: WebGLShader[];
    private readonly uniforms = new Map<string, WebGLUniformLocation | null>();
    private checked = false;

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

    /** Asking again costs nothing; without the extension the first use waits for the compiler. */
    get ready(): boolean {
        if (this.checked) return true;
        if (this.parallel === null) return true;
        return this.gl.getProgramParameter(this.program, this.parallel.COMPLETION_STATUS_KHR) === true;
    }

    /** @throws Error with the compiler's words */
    use(): void {
        const { gl } = this;
        if (!this.checked && !gl.isContextLost()) {
            if (!gl.getProgramParameter(this.program, gl.LINK_STATUS)) {
                const log = this.shaders.map((shader) => gl.getShaderInfoLog(shader)).join('\n');
                throw new Error(`The GPU's compiler refuses a shader: ${gl.getProgramInfoLog(this.program)} ${log}`);
            }
            this.checked = true;
        }
        gl.useProgram(this.program);
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
