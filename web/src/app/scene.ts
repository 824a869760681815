// SPDX-License-Identifier: MIT
import { type CellLayout, kCellArrays } from '../octv/cells';
import type { Metadata } from '../octv/metadata';
import { megabytes, rounded } from '../ui/numbers';
import type { Box } from '../view/camera';

/** One file that is shown, or on its way. */
export interface Scene {
    name: string;
    metadata: Metadata;
    fileBytes: number;
    loadedBytes: number;
    loadedLevels: number; // from the root
    levelsWanted: number; // what fits
    box: Box | undefined; // of the voxels, world space
    cells: CellLayout | undefined; // what cells look like, when all of it is there
    cellsToCome: CellLayout | undefined; // that the GPU has room for
    done: boolean;
}

/** Cells of this level are the finest that can be shown now. */
export function openLevel(scene: Scene): number {
    const { depth } = scene.metadata.grid;
    return scene.loadedLevels >= depth - 1 ? depth : scene.loadedLevels;
}

/** @param here  is what cells look like needed here, or does another machine have it? */
export function hasColors(scene: Scene, here: boolean): boolean {
    return scene.metadata.attributes !== undefined && (!here || scene.cells !== undefined);
}

/** Is the light of the cells there? @param here  as of hasColors() */
export function hasStoredLight(scene: Scene, here = true): boolean {
    if (scene.metadata.storedLight === undefined) return false;
    return !here || scene.cells?.begins[kCellArrays.indexOf('LITE')] !== undefined;
}

export function sceneFacts({ metadata }: Scene): [string, string][] {
    const resolution = 2 ** metadata.grid.depth;
    const { attributes } = metadata;
    return [
        ['Resolution', `${resolution} × ${resolution} × ${resolution}`],
        ['Voxels', metadata.voxels.toLocaleString('en')],
        ['Triangles', metadata.triangles.toLocaleString('en')],
        ['DAG', megabytes(4 * metadata.words)],
        ['Bits a voxel', metadata.voxels > 0 ? rounded((32 * metadata.words) / metadata.voxels) : '0'],
        ...(attributes ? [['Coloured cells', `${attributes.cells.toLocaleString('en')} at ${2 ** attributes.level}³`] as [string, string]] : []),
    ];
}
