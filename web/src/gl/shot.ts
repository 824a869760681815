// SPDX-License-Identifier: MIT
import type { CameraUniforms } from '../view/camera';
import type { PlacedLamps } from '../view/lamps';
import type { Mode, Shadows } from '../view/settings';
import type { Vec3 } from '../view/vec';

/** All that a sample of the picture depends on. */
export interface Shot {
    camera: CameraUniforms;
    depth: number; // of what may be traced: 0 for nothing
    gridDepth: number;
    stopHeight: number;
    cone: number;
    mode: Mode;
    smooth: boolean;
    cells: boolean; // the scene has colours
    stored?: StoredSky; // shaded by the light of the cells, under this sky
    up: Vec3;
    skySamples: number;
    skyRadius: number; // voxels
    shadows: Shadows;
    lamps: PlacedLamps;
}

export interface StoredSky {
    kind: number; // of sky_radiance.h
    factor: number;
    colors: [Vec3, Vec3, Vec3]; // zenith, horizon, ground
}
