// SPDX-License-Identifier: MIT
//
// Lights placed in a grid, as texels for the shader: octavo::Lamp. A lamp takes nine texels of four
// words, then its triangles six each: shaders/lamps.glsl and placed_lamp.glsl read them.
import type { Grid, StoredLight } from '../octv/metadata';
import { type Vec3, add, cross, length, scale, sub } from './vec';

const kSun = 0;
const kPoint = 1; // spots too
const kPatch = 2;
const kMesh = 3;
const kDisc = 0;
const kRectangle = 1;
const kFarthest = 2 ** 29; // voxels; a lamp farther away is moved there
const kLampTexels = 9;
const kTriangleTexels = 6;
export const kLampRow = 256; // texels of a row

export interface PlacedLamps {
    count: number;
    texels: Uint32Array<ArrayBuffer>; // whole rows
    onlySuns: boolean;
    sun: { towards: Vec3; intensity: Vec3 }; // the first one; black where there is none
}

const kKinds: Record<string, number> = { sun: kSun, point: kPoint, spot: kPoint, disc: kPatch, rectangle: kPatch, mesh: kMesh };
export const knownKind = (light: StoredLight): boolean => light.kind in kKinds && (light.kind !== 'mesh' || light.triangles.length > 0);

/** Corners of a lamp's triangle. */
export function cornersOf(triangle: number[]): [Vec3, Vec3, Vec3] {
    return [0, 3, 6].map((i) => triangle.slice(i, i + 3) as Vec3) as [Vec3, Vec3, Vec3];
}

class Writer {
    readonly words: Uint32Array<ArrayBuffer>;
    private readonly ints: Int32Array;
    private readonly floats: Float32Array;
    constructor(texels: number) {
        const rows = Math.max(1, Math.ceil(texels / kLampRow));
        this.words = new Uint32Array(4 * kLampRow * rows);
        this.ints = new Int32Array(this.words.buffer);
        this.floats = new Float32Array(this.words.buffer);
    }
    setInts(texel: number, values: number[]): void {
        this.ints.set(values, 4 * texel);
    }
    setFloats(texel: number, values: number[]): void {
        this.floats.set(values, 4 * texel);
    }
    setFloat(texel: number, part: number, value: number): void {
        this.floats[4 * texel + part] = value;
    }
    /** A place in grid space: its cell, and the rest one texel on. */
    setPlace(texel: number, at: Vec3): void {
        const near = at.map((x) => Math.max(-kFarthest, Math.min(kFarthest, x)));
        const cell = near.map(Math.floor);
        this.setInts(texel, cell);
        this.setFloats(texel + 1, near.map((x, axis) => x - cell[axis]!));
    }
}

/** @param lights  of known kinds */
export function placeLamps(lights: StoredLight[], grid: Grid): PlacedLamps {
    const triangles = lights.reduce((sum, light) => sum + (light.kind === 'mesh' ? light.triangles.length : 0), 0);
    const writer = new Writer(kLampTexels * lights.length + kTriangleTexels * triangles);
    const toGrid = (v: Vec3): Vec3 => scale(1 / grid.voxelSize, sub(v, grid.origin));
    let next = kLampTexels * lights.length;
    lights.forEach((light, i) => {
        const at = kLampTexels * i;
        const kind = kKinds[light.kind]!;
        const radius = kind === kSun ? light.size : light.size / grid.voxelSize;
        const rectangle = light.kind === 'rectangle';
        const outer = light.kind === 'spot' ? Math.cos(light.outerAngle) : -2;
        const inner = light.kind === 'spot' ? Math.max(Math.cos(light.innerAngle), outer + 1e-6) : -2;
        const u = scale(1 / grid.voxelSize, light.halfU);
        const v = scale(1 / grid.voxelSize, light.halfV);
        writer.setInts(at, [kind, rectangle ? kRectangle : kDisc, 0, next]);
        writer.setPlace(at + 1, toGrid(light.position));
        writer.setFloat(at + 2, 3, radius);
        writer.setFloats(at + 3, [...light.direction, rectangle ? 4 * length(cross(u, v)) : Math.PI * radius * radius]);
        writer.setFloats(at + 4, [...u, grid.voxelSize]);
        writer.setFloats(at + 5, [...v, inner]);
        writer.setFloat(at + 6, 3, outer);
        writer.setFloats(at + 8, light.intensity);
        if (kind === kMesh) next = placeTriangles(writer, light, at, next, toGrid);
    });
    const sun = lights.find(({ kind }) => kind === 'sun');
    return {
        count: lights.length,
        texels: writer.words,
        onlySuns: lights.every(({ kind }) => kind === 'sun'),
        sun: { towards: sun ? scale(-1, sun.direction) : [0, 1, 0], intensity: sun?.intensity ?? [0, 0, 0] },
    };
}

/** @returns the texel behind the last triangle */
function placeTriangles(writer: Writer, light: StoredLight, lamp: number, begin: number, toGrid: (v: Vec3) => Vec3): number {
    const all = light.triangles.map((triangle) => cornersOf(triangle).map(toGrid) as [Vec3, Vec3, Vec3]);
    const corners = all.flat();
    const bound = (pick: (...values: number[]) => number): Vec3 =>
        corners.reduce((so, corner) => so.map((value, axis) => pick(value, corner[axis]!)) as Vec3);
    const [low, high] = [bound(Math.min), bound(Math.max)];
    const middle = scale(0.5, add(low, high));
    writer.setPlace(lamp + 1, middle);
    // Some bits more, for the rounding to float.
    writer.setFloats(lamp + 6, sub(low, middle).map((x) => x * 1.00001 - 1e-2));
    writer.setFloats(lamp + 7, sub(high, middle).map((x) => x * 1.00001 + 1e-2));
    let area = 0;
    let count = 0;
    for (const [a, b, c] of all) {
        const u = sub(b, a);
        const v = sub(c, a);
        const normal = cross(u, v);
        const size = length(normal);
        if (!(size > 0) || !Number.isFinite(size)) continue;
        area += 0.5 * size;
        const at = begin + kTriangleTexels * count;
        writer.setPlace(at, a);
        writer.setFloat(at, 3, size);
        writer.setFloat(at + 1, 3, area);
        writer.setFloats(at + 2, u);
        writer.setFloats(at + 3, v);
        writer.setFloats(at + 4, scale(1 / size, normal));
        writer.setFloats(at + 5, add(sub(a, middle), scale(1 / 3, add(u, v))));
        count += 1;
    }
    writer.setInts(lamp, [kMesh, kDisc, count, begin]);
    writer.setFloat(lamp + 3, 3, area);
    return begin + kTriangleTexels * count;
}
