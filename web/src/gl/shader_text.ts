// SPDX-License-Identifier: MIT
//
// Puts the programs together from the library's shared text and this backend's parts.
import sharedText from '../../../src/octavo/trace/shared_text.h?raw';
import traverse from '../../../src/octavo/trace/traverse.h?raw';
import beams from '../../../src/octavo/trace/beam.h?raw';
import sampling from '../../../src/octavo/render/sampling.h?raw';
import ambientOcclusion from '../../../src/octavo/render/ambient_occlusion.h?raw';
import shadow from '../../../src/octavo/render/shadow.h?raw';
import cameraRay from '../../../src/octavo/render/camera_ray.h?raw';
import surface from '../../../src/octavo/render/surface.h?raw';
import smoothNormal from '../../../src/octavo/render/smooth_normal.h?raw';
import shading from '../../../src/octavo/render/shade.h?raw';
import dag from '../shaders/dag.glsl?raw';
import view from '../shaders/view.glsl?raw';
import beamMain from '../shaders/beam.frag?raw';
import traceMain from '../shaders/trace.frag?raw';
import pickMain from '../shaders/pick.frag?raw';
import presentMain from '../shaders/present.frag?raw';

const kVersion = '#version 300 es\n';
const kPrecision = `precision highp float;
precision highp int;
precision highp usampler2DArray;
`;

export const kVertexText = `${kVersion}void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}
`;

function assemble(defines: Record<string, number>, parts: string[]): string {
    const lines = Object.entries(defines).map(([name, value]) => `#define ${name} ${value}\n`);
    return kVersion + lines.join('') + kPrecision + parts.join('\n');
}

/** @param rowBits  see dag.glsl */
export function traceText(rowBits: number, smooth: boolean): string {
    const normals = smooth ? [smoothNormal] : [];
    return assemble({ ROW_BITS: rowBits, SMOOTH: smooth ? 1 : 0 }, [
        sharedText, dag, traverse, beams, sampling, ambientOcclusion, shadow, cameraRay, surface, ...normals,
        shading, view, traceMain,
    ]);
}

export function beamText(rowBits: number): string {
    return assemble({ ROW_BITS: rowBits }, [sharedText, dag, traverse, beams, cameraRay, view, beamMain]);
}

export function pickText(rowBits: number): string {
    return assemble({ ROW_BITS: rowBits }, [sharedText, dag, traverse, beams, cameraRay, view, pickMain]);
}

export function presentText(): string {
    return kVersion + presentMain;
}
