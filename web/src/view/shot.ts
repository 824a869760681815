// SPDX-License-Identifier: MIT
//
// What a view asks for: of this machine's GPU, and of another machine.
import type { Shot } from '../gl/renderer';
import type { Metadata } from '../octv/metadata';
import type { View } from '../painter';
import { hasStoredLight, openLevel } from '../scene';
import { cameraUniforms, diagonalOf, forwardOf } from './camera';
import { type PlacedLamps, placeLamps } from './lamps';
import { lightsOf } from './lights';
import { storedSky } from './sky';

/** Keeps the lamps as long as they are the same, so that they are placed and uploaded once. */
export class LampPlacer {
    private last: { key: string; metadata: Metadata; lamps: PlacedLamps } | undefined;

    place({ scene, settings, axes }: View): PlacedLamps {
        const { light, sunAzimuth, sunElevation, sunSize, up } = settings;
        const key = JSON.stringify([light, sunAzimuth, sunElevation, sunSize, up, scene.box]);
        if (this.last?.key !== key || this.last.metadata !== scene.metadata) {
            const lights = lightsOf(settings, scene.metadata, axes, scene.box!);
            this.last = { key, metadata: scene.metadata, lamps: placeLamps(lights, scene.metadata.grid) };
        }
        return this.last.lamps;
    }
}

export function shotOf({ scene, camera, settings, axes }: View, lamps: PlacedLamps, canvas: { width: number; height: number }): Shot {
    const { grid } = scene.metadata;
    const uniforms = cameraUniforms(camera, axes, grid, canvas.width, canvas.height);
    const level = Math.min(openLevel(scene), settings.finestLevel);
    return {
        camera: uniforms,
        depth: scene.loadedLevels > 0 ? grid.depth : 0,
        gridDepth: grid.depth,
        stopHeight: grid.depth - level,
        cone: settings.detail * uniforms.pitch,
        mode: settings.mode,
        smooth: settings.smooth,
        cells: scene.metadata.attributes !== undefined,
        stored: settings.stored && hasStoredLight(scene) ? storedSky(scene.metadata.storedLight!.sky) : undefined,
        up: axes.y,
        skySamples: settings.ambient ? 4 : 0,
        skyRadius: (0.01 * settings.ambientRadius * diagonalOf(scene.box!)) / grid.voxelSize,
        shadows: settings.shadows,
        lamps,
    };
}

/** As the server of octavo view --render-here takes it. */
export interface Wish {
    width: number;
    height: number;
    eye: number[];
    forward: number[];
    up: number[];
    fov: number;
    shadows: string;
    ambient: boolean;
    reach: number; // world units
    smooth: boolean;
    stored: boolean; // by the light of the file's cells
    light: number;
    azimuth: number; // of the sun; radians
    elevation: number;
    size: number;
    exposure: number;
}

const kMostSide = 4096; // pixels, of another machine's picture

export function wishOf({ scene, camera, settings, axes }: View, canvas: { width: number; height: number }): Wish {
    const radians = Math.PI / 180;
    return {
        width: Math.min(kMostSide, canvas.width),
        height: Math.min(kMostSide, canvas.height),
        eye: camera.eye,
        forward: forwardOf(camera, axes),
        up: axes.y,
        fov: camera.verticalFov,
        shadows: settings.shadows,
        ambient: settings.ambient,
        reach: 0.01 * settings.ambientRadius * diagonalOf(scene.box!),
        smooth: settings.smooth,
        stored: settings.stored && scene.metadata.storedLight !== undefined,
        light: settings.light,
        azimuth: settings.sunAzimuth * radians,
        elevation: settings.sunElevation * radians,
        size: settings.sunSize * radians,
        exposure: settings.exposure,
    };
}
