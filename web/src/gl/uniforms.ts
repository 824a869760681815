// SPDX-License-Identifier: MIT
//
// What programs are told of a shot, in the names of shaders/.
import type { Mode } from '../view/settings';
import type { Canvas } from './canvas';
import type { Program } from './program';
import type { Shot, StoredSky } from './shot';

const kModeNumbers: Record<Mode, number> = { shaded: 0, normals: 1, levels: 2, steps: 3, color: 4 }; // of views.frag

/** Of view.glsl. */
export function setView(gl: WebGL2RenderingContext, program: Program, width: number, height: number, shot: Shot): void {
    const { camera } = shot;
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

/** Of sample.glsl. */
export function setSample(gl: WebGL2RenderingContext, program: Program, canvas: Canvas, centred: boolean): void {
    gl.uniform1i(program.at('centred'), centred ? 1 : 0);
    gl.uniform1i(program.at('sample_number'), canvas.samples);
}

/** Of shade.frag, without its lamps. */
export function setShading(gl: WebGL2RenderingContext, program: Program, shot: Shot): void {
    gl.uniform1i(program.at('sky_samples'), shot.skySamples);
    gl.uniform1f(program.at('sky_radius'), shot.skyRadius);
    gl.uniform1i(program.at('shadows'), { none: 0, hard: 1, soft: 2 }[shot.shadows]);
}

/** Of views.frag. */
export function setViews(gl: WebGL2RenderingContext, program: Program, shot: Shot): void {
    gl.uniform1i(program.at('mode'), kModeNumbers[shot.mode]);
    gl.uniform1f(program.at('depth_levels'), shot.gridDepth);
}

/** Of stored.frag. */
export function setStoredSky(gl: WebGL2RenderingContext, program: Program, sky: StoredSky): void {
    gl.uniform1i(program.at('sky_kind'), sky.kind);
    gl.uniform1f(program.at('sky_factor'), sky.factor);
    gl.uniform3fv(program.at('sky_colors'), sky.colors.flat());
}
