// SPDX-License-Identifier: MIT
//
// The META section: what the scene is, checked before anything is sized by it.
import { damaged } from './errors';
import type { Vec3 } from '../view/vec';

export const kMaxMetadataBytes = 16 * 1024 * 1024;
const kMinDepth = 2;
const kMaxDepth = 17;
const kMaxWords = 2 ** 32;

export interface Grid {
    origin: Vec3; // world position of the low corner
    voxelSize: number; // world units
    depth: number; // 2^depth voxels along each side
}

export interface Level {
    svoNodes: number;
    dagNodes: number;
    words: number;
}

export interface StoredCamera {
    name: string;
    eye: Vec3;
    forward: Vec3;
    up: Vec3;
    verticalFov: number; // radians
}

export interface StoredLight {
    name: string;
    kind: string;
    position: Vec3;
    direction: Vec3; // the way the light travels
    intensity: Vec3;
    innerAngle: number;
    outerAngle: number;
    size: number; // a radius; a sun's in radians
    halfU: Vec3; // of a rectangle: from its middle to the middles of two sides
    halfV: Vec3;
    triangles: number[][]; // of a mesh: nine numbers each
}

export interface Metadata {
    source: string;
    rule: string;
    grid: Grid;
    triangles: number;
    voxels: number;
    levels: Level[]; // 0 to depth - 1
    words: number; // of all levels
    cameras: StoredCamera[];
    lights: StoredLight[];
    attributes?: { level: number; cells: number }; // whose occupied cells have colours
    storedLight?: { bounces: number; sky: string }; // of these cells
}

type Json = Record<string, unknown>;

function fail(key: string, what: string): never {
    throw damaged(`The metadata is damaged: ${key} ${what}.`);
}

function object(value: unknown, key: string): Json {
    if (typeof value !== 'object' || value === null || Array.isArray(value)) fail(key, 'is not an object');
    return value as Json;
}
function array(value: unknown, key: string): unknown[] {
    if (!Array.isArray(value)) fail(key, 'is not a list');
    return value as unknown[];
}
function text(value: unknown, key: string): string {
    if (typeof value !== 'string') fail(key, 'is not a text');
    return value as string;
}
function number(value: unknown, key: string): number {
    if (typeof value !== 'number' || !Number.isFinite(value)) fail(key, 'is not a number');
    return value as number;
}
/** Beyond 2^53 counts lose their last digits, which only shows in statistics. */
function count(value: unknown, key: string): number {
    const n = number(value, key);
    if (n < 0 || !Number.isInteger(n)) fail(key, 'is not a count');
    return n;
}
function vec3(value: unknown, key: string): Vec3 {
    const list = array(value, key);
    if (list.length !== 3) fail(key, 'does not have three numbers');
    return [number(list[0], key), number(list[1], key), number(list[2], key)];
}
function unit(value: unknown, key: string): Vec3 {
    const v = vec3(value, key);
    const length = Math.hypot(...v);
    if (!(length > 1e-6 && length < 1e6)) fail(key, 'is not a direction');
    return [v[0] / length, v[1] / length, v[2] / length];
}

function readGrid(value: unknown): Grid {
    const json = object(value, 'grid');
    const grid = {
        origin: vec3(json.origin, 'grid.origin'),
        voxelSize: number(json.voxel_size, 'grid.voxel_size'),
        depth: count(json.depth, 'grid.depth'),
    };
    if (!(grid.voxelSize > 0)) fail('grid.voxel_size', 'is not above 0');
    if (grid.depth < kMinDepth || grid.depth > kMaxDepth) fail('grid.depth', `is not ${kMinDepth} to ${kMaxDepth}`);
    return grid;
}

function readLevels(value: unknown, depth: number): Level[] {
    const list = array(value, 'levels');
    if (list.length !== depth) fail('levels', `has ${list.length} entries where the depth is ${depth}`);
    const levels = list.map((entry, i) => {
        const json = object(entry, `levels[${i}]`);
        return {
            svoNodes: count(json.svo_nodes, `levels[${i}].svo_nodes`),
            dagNodes: count(json.dag_nodes, `levels[${i}].dag_nodes`),
            words: count(json.words, `levels[${i}].words`),
        };
    });
    const words = levels.reduce((sum, level) => sum + level.words, 0);
    const leafLevel = depth - 2;
    levels.forEach((level, i) => {
        const [least, most] = i < leafLevel ? [2, 9] : i === leafLevel ? [2, 2] : [0, 0];
        if (level.words < least * level.dagNodes || level.words > most * level.dagNodes) {
            fail(`levels[${i}].words`, `is ${level.words}, which ${level.dagNodes} nodes cannot take`);
        }
        if (words > 0 && i <= leafLevel && level.dagNodes === 0) fail(`levels[${i}]`, 'is empty between others');
    });
    if (words > 0 && levels[0]!.dagNodes !== 1) fail('levels[0]', 'is not a single node');
    if (words > kMaxWords) fail('levels', 'have more than 2^32 words');
    return levels;
}

function readCamera(value: unknown, i: number): StoredCamera {
    const key = `cameras[${i}]`;
    const json = object(value, key);
    const fov = number(json.vertical_fov, `${key}.vertical_fov`);
    if (!(fov > 0 && fov < Math.PI)) fail(`${key}.vertical_fov`, 'is not an angle of view');
    return {
        name: text(json.name, `${key}.name`),
        eye: vec3(json.eye, `${key}.eye`),
        forward: unit(json.forward, `${key}.forward`),
        up: unit(json.up, `${key}.up`),
        verticalFov: fov,
    };
}

/** A light of a kind that this page does not know is kept by its kind's name alone. */
function readLight(value: unknown, i: number): StoredLight {
    const key = `lights[${i}]`;
    const json = object(value, key);
    const angle = (name: string): number => (json[name] === undefined ? 0 : number(json[name], `${key}.${name}`));
    return {
        name: text(json.name, `${key}.name`),
        kind: text(json.kind, `${key}.kind`),
        position: json.position === undefined ? [0, 0, 0] : vec3(json.position, `${key}.position`),
        direction: json.direction === undefined ? [0, -1, 0] : unit(json.direction, `${key}.direction`),
        intensity: json.intensity === undefined ? [1, 1, 1] : vec3(json.intensity, `${key}.intensity`),
        innerAngle: angle('inner_angle'),
        outerAngle: angle('outer_angle'),
        size: angle('size'),
        halfU: json.half_u === undefined ? [0, 0, 0] : vec3(json.half_u, `${key}.half_u`),
        halfV: json.half_v === undefined ? [0, 0, 0] : vec3(json.half_v, `${key}.half_v`),
        triangles: readTriangles(json.triangles, `${key}.triangles`),
    };
}

function readTriangles(value: unknown, key: string): number[][] {
    if (value === undefined) return [];
    const list = array(value, key).map((entry) => number(entry, key));
    if (list.length % 9 !== 0) fail(key, 'does not have nine numbers for each triangle');
    return Array.from({ length: list.length / 9 }, (_, i) => list.slice(9 * i, 9 * i + 9));
}

function readAttributes(value: unknown, depth: number): Metadata['attributes'] {
    if (value === undefined) return undefined;
    const json = object(value, 'attributes');
    const level = count(json.level, 'attributes.level');
    if (level < kMinDepth || level > depth) fail('attributes.level', `is not ${kMinDepth} to ${depth}`);
    return { level, cells: count(json.cells, 'attributes.cells') };
}

function readStoredLight(value: unknown): Metadata['storedLight'] {
    if (value === undefined) return undefined;
    const json = object(value, 'light');
    return { bounces: count(json.bounces, 'light.bounces'), sky: text(json.sky, 'light.sky') };
}

/** @throws FileFault damaged */
export function readMetadata(bytes: Uint8Array): Metadata {
    let json: Json;
    try {
        json = object(JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes)), 'META');
    } catch (error) {
        if (error instanceof Error && error.name === 'FileFault') throw error;
        throw damaged('The metadata is damaged: it is not JSON.');
    }
    const grid = readGrid(json.grid);
    const levels = readLevels(json.levels, grid.depth);
    return {
        source: text(json.source, 'source'),
        rule: text(json.rule, 'rule'),
        grid,
        triangles: count(object(json.triangles, 'triangles').total, 'triangles.total'),
        voxels: count(json.voxels, 'voxels'),
        levels,
        words: levels.reduce((sum, level) => sum + level.words, 0),
        cameras: array(json.cameras, 'cameras').map(readCamera),
        lights: array(json.lights, 'lights').map(readLight),
        attributes: readAttributes(json.attributes, grid.depth),
        storedLight: readStoredLight(json.light),
    };
}
