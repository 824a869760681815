// SPDX-License-Identifier: MIT
//
// What a view asks of another machine.
import { diagonalOf, forwardOf } from '../view/camera';
import type { Mode } from '../view/settings';
import type { View } from './painter';

/** As the server of octavo view --render-here takes it. */
export interface Wish {
    mode: Mode;
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
    level: number; // the finest that is shown; as `detail`, of modes without light
    detail: number; // pixels that a cell may be small
}

const kMostSide = 4096; // pixels, of another machine's picture

export function wishOf({ scene, camera, settings, axes }: View, canvas: { width: number; height: number }): Wish {
    const radians = Math.PI / 180;
    const side = (pixels: number): number => Math.max(1, Math.min(kMostSide, Math.round(0.01 * settings.scale * pixels)));
    return {
        mode: settings.mode,
        width: side(canvas.width),
        height: side(canvas.height),
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
        level: settings.finestLevel,
        detail: settings.detail,
    };
}
