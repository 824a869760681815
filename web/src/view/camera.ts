// SPDX-License-Identifier: MIT
//
// Where the viewer stands, in doubles and world space; and the same as a shader takes it.
import type { Grid, StoredCamera } from '../octv/metadata';
import { type Vec3, add, cross, dot, length, normalize, scale, sub } from './vec';

export type UpAxis = 'y' | 'z';

/** The directions that angles are measured from: azimuth 0 is along z, a quarter turn along x. */
export interface Axes {
    x: Vec3;
    y: Vec3; // up
    z: Vec3;
}

export function axesOf(up: UpAxis): Axes {
    return up === 'y'
        ? { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] }
        : { x: [-1, 0, 0], y: [0, 0, 1], z: [0, 1, 0] };
}

/** The unit vector at this azimuth and elevation; radians. */
export function directionAt(axes: Axes, azimuth: number, elevation: number): Vec3 {
    const level = add(scale(Math.sin(azimuth), axes.x), scale(Math.cos(azimuth), axes.z));
    return add(scale(Math.cos(elevation), level), scale(Math.sin(elevation), axes.y));
}

export interface Angles {
    azimuth: number;
    elevation: number;
}

export function anglesOf(axes: Axes, direction: Vec3): Angles {
    const d = normalize(direction);
    return {
        azimuth: Math.atan2(dot(d, axes.x), dot(d, axes.z)),
        elevation: Math.asin(Math.max(-1, Math.min(1, dot(d, axes.y)))),
    };
}

const kMostElevation = (89.9 * Math.PI) / 180;
export const kDefaultFov = (40 * Math.PI) / 180;

/** Looks from `eye` to a point `distance` before it, which it turns about. */
export interface Camera {
    eye: Vec3;
    azimuth: number; // of the view direction
    elevation: number;
    distance: number;
    verticalFov: number; // radians
}

export function forwardOf(camera: Camera, axes: Axes): Vec3 {
    return directionAt(axes, camera.azimuth, camera.elevation);
}

export function rightOf(camera: Camera, axes: Axes): Vec3 {
    return normalize(cross(forwardOf(camera, axes), axes.y));
}

export function targetOf(camera: Camera, axes: Axes): Vec3 {
    return add(camera.eye, scale(camera.distance, forwardOf(camera, axes)));
}

export function clampElevation(elevation: number): number {
    return Math.max(-kMostElevation, Math.min(kMostElevation, elevation));
}

/** Turned about its target by these angles. */
export function orbited(camera: Camera, axes: Axes, azimuth: number, elevation: number): Camera {
    const target = targetOf(camera, axes);
    const turned = { ...camera, azimuth: camera.azimuth + azimuth, elevation: clampElevation(camera.elevation + elevation) };
    return { ...turned, eye: sub(target, scale(camera.distance, forwardOf(turned, axes))) };
}

/** Looks at the target from `factor` times as far. */
export function dollied(camera: Camera, axes: Axes, factor: number, least: number): Camera {
    const target = targetOf(camera, axes);
    const distance = Math.max(least, camera.distance * factor);
    return { ...camera, distance, eye: sub(target, scale(distance, forwardOf(camera, axes))) };
}

/** Moved sideways and upwards in the picture's plane, and forwards; world units. */
export function moved(camera: Camera, axes: Axes, right: number, up: number, forward: number): Camera {
    const r = rightOf(camera, axes);
    const f = forwardOf(camera, axes);
    const u = cross(r, f);
    const way = add(add(scale(right, r), scale(up, u)), scale(forward, f));
    return { ...camera, eye: add(camera.eye, way) };
}

export interface Box {
    low: Vec3; // world space
    high: Vec3;
}

export function diagonalOf(box: Box): number {
    return length(sub(box.high, box.low));
}

/** How wide the picture is for its height, and what part of its width, at the left, nothing covers. */
export interface Frame {
    aspect: number;
    clear: number;
}

/** Sees the whole box from this direction: octavo::default_camera(), where nothing covers the picture. */
export function framing(box: Box, axes: Axes, { aspect, clear }: Frame, towardsEye: Vec3, verticalFov: number): Camera {
    const centre = scale(0.5, add(box.low, box.high));
    const size = sub(box.high, box.low);
    const forward = scale(-1, normalize(towardsEye));
    const right = normalize(cross(forward, axes.y));
    const up = cross(right, forward);
    const slope = Math.tan(0.5 * verticalFov);
    const wide = slope * aspect;
    let distance = 0;
    for (let i = 0; i < 8; i += 1) {
        const toCorner: Vec3 = [
            ((i & 1) - 0.5) * size[0],
            (((i >> 1) & 1) - 0.5) * size[1],
            ((i >> 2) - 0.5) * size[2],
        ];
        const ahead = dot(toCorner, forward);
        const aside = dot(toCorner, right);
        // The eye is moved aside by (1 - clear) * wide * distance, which near corners show more of.
        const left = (-aside - wide * ahead) / (wide * clear);
        const rightmost = (aside - wide * (2 * clear - 1) * ahead) / (wide * clear);
        const height = Math.abs(dot(toCorner, up)) / slope - ahead;
        distance = Math.max(distance, left, rightmost, height);
    }
    distance *= 1.04;
    const angles = anglesOf(axes, forward);
    const target = add(centre, scale((1 - clear) * wide * distance, right));
    return { eye: sub(target, scale(distance, forward)), ...angles, distance, verticalFov };
}

export function defaultCamera(box: Box, axes: Axes, frame: Frame): Camera {
    const towardsEye = add(add(axes.x, scale(0.6, axes.y)), scale(1.4, axes.z));
    return framing(box, axes, frame, towardsEye, kDefaultFov);
}

/** A camera of the file. Its target is taken to be as far as the middle of the scene. */
export function fromStored(stored: StoredCamera, axes: Axes, box: Box): Camera {
    const centre = scale(0.5, add(box.low, box.high));
    const ahead = dot(sub(centre, stored.eye), stored.forward);
    const angles = anglesOf(axes, stored.forward);
    return {
        eye: stored.eye,
        azimuth: angles.azimuth,
        elevation: clampElevation(angles.elevation),
        distance: Math.max(ahead, 0.1 * diagonalOf(box)),
        verticalFov: stored.verticalFov,
    };
}

/** The uniforms of camera_ray.h; as octavo::PixelRays makes them. */
export interface CameraUniforms {
    cell: Vec3;
    frac: Vec3;
    forward: Vec3;
    right: Vec3; // a pixel's width at depth 1
    down: Vec3;
    before: number;
    pitch: number;
    seesNothing: boolean;
}

const kNear = 2 ** 20;
const kFarthest = 2 ** 29;

export function cameraUniforms(camera: Camera, axes: Axes, grid: Grid, width: number, height: number): CameraUniforms {
    const pitch = (2 * Math.tan(0.5 * camera.verticalFov)) / height;
    const forward = forwardOf(camera, axes);
    const right = rightOf(camera, axes);
    const up = cross(right, forward);
    const side = 2 ** grid.depth;
    const centre: Vec3 = [0.5 * side, 0.5 * side, 0.5 * side];
    let start = scale(1 / grid.voxelSize, sub(camera.eye, grid.origin));
    let before = 0;
    let seesNothing = false;
    const toCentre = sub(centre, start);
    if (length(toCentre) > kNear) {
        before = Math.max(0, dot(forward, toCentre) - side);
        start = add(start, scale(before, forward));
        const toCorner = scale(0.5 * pitch, sub(scale(height, up), scale(width, right)));
        seesNothing = !(length(sub(add(start, scale(before, toCorner)), centre)) < kFarthest);
    }
    const cell: Vec3 = seesNothing ? [0, 0, 0] : [Math.floor(start[0]), Math.floor(start[1]), Math.floor(start[2])];
    return {
        cell,
        frac: sub(start, cell),
        forward,
        right: scale(pitch, right),
        down: scale(-pitch, up),
        before,
        pitch,
        seesNothing,
    };
}
