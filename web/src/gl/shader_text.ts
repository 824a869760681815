// SPDX-License-Identifier: MIT
//
// Puts the programs together from the library's shared text and this backend's parts.
import sharedText from '../../../src/octavo/trace/shared_text.h?raw';
import traverse from '../../../src/octavo/trace/traverse.h?raw';
import beams from '../../../src/octavo/trace/beam.h?raw';
import sampling from '../../../src/octavo/light/sampling.h?raw';
import ambientOcclusion from '../../../src/octavo/render/ambient_occlusion.h?raw';
import shadow from '../../../src/octavo/light/shadow.h?raw';
import cameraRay from '../../../src/octavo/render/camera_ray.h?raw';
import toneCurve from '../../../src/octavo/render/tone_curve.h?raw';
import plainView from '../../../src/octavo/render/plain_view.h?raw';
import surface from '../../../src/octavo/light/surface.h?raw';
import smoothNormal from '../../../src/octavo/light/smooth_normal.h?raw';
import shading from '../../../src/octavo/light/shade.h?raw';
import cellRank from '../../../src/octavo/attributes/cell_rank.h?raw';
import cellValue from '../../../src/octavo/attributes/cell_value.h?raw';
import srgb from '../../../src/octavo/attributes/srgb.h?raw';
import cellLooks from '../../../src/octavo/attributes/cell_looks.h?raw';
import skyRadiance from '../../../src/octavo/light/sky_radiance.h?raw';
import cachedLight from '../../../src/octavo/light/cached_light.h?raw';
import lampTriangle from '../../../src/octavo/light/lamp_triangle.h?raw';
import lampLight from '../../../src/octavo/light/lamp_light.h?raw';
import lampTexels from '../shaders/lamps.glsl?raw';
import anyLamps from '../shaders/any_lamps.glsl?raw';
import sunLamps from '../shaders/sun_lamps.glsl?raw';
import flatSurface from '../shaders/flat_surface.glsl?raw';
import smoothSurface from '../shaders/smooth_surface.glsl?raw';
import clayLooks from '../shaders/clay_looks.glsl?raw';
import dag from '../shaders/dag.glsl?raw';
import cells from '../shaders/cells.glsl?raw';
import looks from '../shaders/looks.glsl?raw';
import skyPixels from '../shaders/sky.glsl?raw';
import storedMain from '../shaders/stored.frag?raw';
import view from '../shaders/view.glsl?raw';
import beamMain from '../shaders/beam.frag?raw';
import hit from '../shaders/hit.glsl?raw';
import sample from '../shaders/sample.glsl?raw';
import primaryMain from '../shaders/primary.frag?raw';
import keepVertex from '../shaders/keep.vert?raw';
import keepMain from '../shaders/keep.frag?raw';
import normalMain from '../shaders/normal.frag?raw';
import shadeMain from '../shaders/shade.frag?raw';
import viewsMain from '../shaders/views.frag?raw';
import previewMain from '../shaders/preview.frag?raw';
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

const kTrace = [sharedText, dag, traverse, beams, sampling, cameraRay, surface, hit, view, sample];

/** @param rowBits  of dag.glsl */
function assemble(rowBits: number, parts: string[]): string {
    return `${kVersion}#define ROW_BITS ${rowBits}\n${kPrecision}${parts.join('\n')}`;
}

export function primaryText(rowBits: number): string {
    return assemble(rowBits, [...kTrace, plainView, primaryMain]);
}

export function normalText(rowBits: number): string {
    return assemble(rowBits, [sharedText, dag, traverse, sampling, surface, smoothNormal, hit, normalMain]);
}

export function keepVertexText(rowBits: number): string {
    return assemble(rowBits, [sharedText, dag, traverse, sampling, hit, keepVertex]);
}
export function keepText(): string {
    return `${kVersion}${kPrecision}${keepMain}`;
}

/** What a program is to have; it is smaller without. */
export interface Parts {
    smooth: boolean; // normals of the cache
    cells: boolean; // looks of the file's cells
    anyLamp: boolean; // else suns only
}

const kLooks = [cells, cellRank, cellValue, srgb, cellLooks, looks];
const surfaceOf = ({ smooth }: Parts): string => (smooth ? smoothSurface : flatSurface);
const looksOf = ({ cells }: Parts): string[] => (cells ? kLooks : [clayLooks]);
const lampsOf = ({ anyLamp }: Parts): string[] => [lampTriangle, lampTexels, ...(anyLamp ? [lampLight, anyLamps] : [sunLamps])];

export function shadeText(rowBits: number, parts: Parts): string {
    return assemble(rowBits, [...kTrace, ambientOcclusion, shadow, shading, surfaceOf(parts), ...looksOf(parts), ...lampsOf(parts), shadeMain]);
}

export function viewsText(rowBits: number, parts: Parts): string {
    return assemble(rowBits, [...kTrace, plainView, shading, surfaceOf(parts), ...looksOf(parts), viewsMain]);
}

export function storedText(rowBits: number, parts: Parts): string {
    return assemble(rowBits, [...kTrace, shading, surfaceOf(parts), ...kLooks, cachedLight, skyPixels, skyRadiance, storedMain]);
}

export function previewText(rowBits: number): string {
    return assemble(rowBits, [sharedText, dag, traverse, beams, cameraRay, plainView, surface, view, shading, previewMain]);
}

export function beamText(rowBits: number): string {
    return assemble(rowBits, [sharedText, dag, traverse, beams, cameraRay, view, beamMain]);
}

export function pickText(rowBits: number): string {
    return assemble(rowBits, [sharedText, dag, traverse, beams, cameraRay, plainView, view, shading, ...kLooks, pickMain]);
}

export function presentText(): string {
    return kVersion + kPrecision + [sharedText, srgb, toneCurve, presentMain].join('\n');
}
