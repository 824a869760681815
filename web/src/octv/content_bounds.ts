// SPDX-License-Identifier: MIT
//
// The box that holds all voxels, to a 256th of the grid: what a camera needs to frame the scene. As
// octavo::content_bounds().
import type { Vec3 } from '../view/vec';
import { countBits8 } from './level_check';

export const kBoundsLevel = 8;

/** Words of the levels from the root on, each as it lies in the file. */
export interface TopLevels {
    depth: number;
    levels: Uint32Array[];
}

export interface CellBox {
    low: Vec3; // grid space, voxels
    high: Vec3;
}

/** Down to the last level given, or to kBoundsLevel. Undefined where there is no voxel. */
export function contentBounds(top: TopLevels): CellBox | undefined {
    const { depth, levels } = top;
    if (levels.length === 0 || levels[0]!.length === 0) return undefined;
    const leafLevel = depth - 2;
    const begins: number[] = [];
    levels.reduce((begin, words) => (begins.push(begin), begin + words.length), 0);
    const hasLeaves = levels.length > leafLevel;
    const finest = Math.min(kBoundsLevel, hasLeaves ? depth : levels.length);
    const low: Vec3 = [Infinity, Infinity, Infinity];
    const high: Vec3 = [-Infinity, -Infinity, -Infinity];

    const visit = (word: number, leafPart: number, level: number, x: number, y: number, z: number): void => {
        const width = 2 ** (depth - level);
        if (
            x >= low[0] && y >= low[1] && z >= low[2] &&
            x + width <= high[0] && y + width <= high[1] && z + width <= high[2]
        ) {
            return; // nothing in here can widen the box
        }
        if (level === finest) {
            [x, y, z].forEach((corner, axis) => {
                low[axis] = Math.min(low[axis]!, corner);
                high[axis] = Math.max(high[axis]!, corner + width);
            });
            return;
        }
        const words = levels[Math.min(level, leafLevel)]!;
        const at = word - begins[Math.min(level, leafLevel)]!;
        const voxels = (child: number): number => (words[at + (child >> 2)]! >>> (8 * (child & 3))) & 255;
        let mask = leafPart;
        if (level < leafLevel) mask = words[at]!;
        if (level === leafLevel) {
            mask = 0;
            for (let child = 0; child < 8; child += 1) if (voxels(child) !== 0) mask |= 1 << child;
        }
        for (let child = 0; child < 8; child += 1) {
            if (((mask >> child) & 1) === 0) continue;
            const half = width / 2;
            const next = level < leafLevel ? words[at + 1 + countBits8(mask & ((1 << child) - 1))]! : word;
            const part = level === leafLevel ? voxels(child) : 0;
            visit(next, part, level + 1, x + half * (child & 1), y + half * ((child >> 1) & 1), z + half * (child >> 2));
        }
    };
    visit(0, 0, 0, 0, 0, 0);
    return { low, high };
}
