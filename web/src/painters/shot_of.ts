// SPDX-License-Identifier: MIT
//
// What a view asks of this machine's GPU.
import { hasStoredLight, openLevel } from '../app/scene';
import type { Shot } from '../gl/shot';
import type { Metadata } from '../octv/metadata';
import { cameraUniforms, diagonalOf } from '../view/camera';
import { type PlacedLamps, placeLamps } from '../view/lamps';
import { lightsOf } from '../view/lights';
import { storedSky } from '../view/sky';
import type { View } from './painter';

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
    const stored = settings.mode === 'shaded' && settings.stored && hasStoredLight(scene);
    return {
        camera: uniforms,
        depth: scene.loadedLevels > 0 ? grid.depth : 0,
        gridDepth: grid.depth,
        stopHeight: grid.depth - level,
        // Light is stored around surfaces as they are: larger cells stand out into the dark.
        cone: stored ? 0 : settings.detail * uniforms.pitch,
        mode: settings.mode,
        smooth: settings.smooth,
        cells: scene.metadata.attributes !== undefined,
        stored: stored ? storedSky(scene.metadata.storedLight!.sky) : undefined,
        up: axes.y,
        skySamples: settings.ambient ? 4 : 0,
        skyRadius: (0.01 * settings.ambientRadius * diagonalOf(scene.box!)) / grid.voxelSize,
        shadows: settings.shadows,
        lamps,
    };
}
