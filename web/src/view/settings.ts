// SPDX-License-Identifier: MIT
//
// What the picture shows beside the camera: all that a link carries.
import type { UpAxis } from './camera';

export const kModes = ['shaded', 'normals', 'levels', 'steps', 'color'] as const;
export type Mode = (typeof kModes)[number];
export const kShadows = ['none', 'hard', 'soft'] as const;
export type Shadows = (typeof kShadows)[number];

export interface Settings {
    mode: Mode;
    up: UpAxis;
    stored: boolean; // by the light that the file has of its cells
    light: number; // of the file's lights; -1: the sun that the panel turns; -2: all
    sunAzimuth: number; // degrees
    sunElevation: number;
    sunSize: number; // degrees, the angular radius
    shadows: Shadows;
    ambient: boolean;
    ambientRadius: number; // per cent of the scene's diagonal
    smooth: boolean;
    exposure: number; // stops
    detail: number; // pixels that a cell may be small; 0: always voxels
    finestLevel: number; // no cells below it are shown
    scale: number; // per cent of the screen's pixels when the camera rests
    samples: number; // that a picture at rest ends with
    memory: number; // MiB of DAG that may be taken from the GPU
}

export const kDefaults: Settings = {
    mode: 'shaded',
    up: 'y',
    stored: false,
    light: -1,
    sunAzimuth: -20,
    sunElevation: 42,
    sunSize: 1.15, // 0.02 radians, as octavo render takes it
    shadows: 'soft',
    ambient: true,
    ambientRadius: 6,
    smooth: true,
    exposure: 0,
    detail: 1,
    finestLevel: 17,
    scale: 100,
    samples: 256,
    memory: 2048,
};

/** Number settings: what a control offers and a link may carry. */
export const kRanges = {
    light: { least: -2, most: 1000, step: 1 },
    sunAzimuth: { least: -180, most: 180, step: 1 },
    sunElevation: { least: -10, most: 90, step: 1 },
    sunSize: { least: 0, most: 10, step: 0.05 },
    ambientRadius: { least: 0.2, most: 30, step: 0.1 },
    exposure: { least: -4, most: 4, step: 0.1 },
    detail: { least: 0, most: 8, step: 0.5 },
    finestLevel: { least: 1, most: 17, step: 1 },
    scale: { least: 25, most: 100, step: 5 },
    samples: { least: 1, most: 1024, step: 1 },
    memory: { least: 0.001, most: 16384, step: 0.001 },
} as const;
export type NumberSetting = keyof typeof kRanges;
