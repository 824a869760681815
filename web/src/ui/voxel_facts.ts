// SPDX-License-Identifier: MIT
import type { Grid } from '../octv/metadata';
import { type Vec3, add, length, scale, sub } from '../view/vec';
import { rounded, srgbText, worldNumber } from './numbers';

/** A cell that is seen, as a GPU or another machine finds it. */
export interface FoundCell {
    path: Vec3;
    height: number;
    face: number; // see traverse.h
    albedo?: Vec3; // linear; where it has a colour
    emission?: Vec3; // where it shines
}

/** World space. */
export function centreOf(found: FoundCell, grid: Grid): Vec3 {
    const size = 2 ** found.height * grid.voxelSize;
    return add(add(grid.origin, scale(size, found.path)), [size / 2, size / 2, size / 2]);
}

export function voxelFacts(found: FoundCell, grid: Grid, eye: Vec3): [string, string][] {
    const faces = ['−x', '+x', '−y', '+y', '−z', '+z', 'inside'];
    const centre = centreOf(found, grid);
    const facts: [string, string][] = [
        ['Path', found.path.join(', ')],
        ['Level', found.height === 0 ? `${grid.depth}, a voxel` : `${grid.depth - found.height}, ${2 ** found.height} voxels wide`],
        ['Position', centre.map((value) => worldNumber(value, grid.voxelSize)).join(', ')],
        ['Size', rounded(2 ** found.height * grid.voxelSize)],
        ['Face', faces[found.face] ?? ''],
        ['Distance', rounded(length(sub(centre, eye)), 4)],
    ];
    if (found.albedo) facts.push(['Colour', srgbText(found.albedo)]);
    if (found.emission) facts.push(['Emission', found.emission.map((value) => rounded(value)).join(', ')]);
    return facts;
}

/** What fits in a line. */
export function shortFacts(facts: [string, string][]): string {
    const kept = facts.filter(([term]) => ['Path', 'Level', 'Colour'].includes(term));
    return kept.map(([term, value]) => `${term} ${value}`).join(' · ');
}

/** A sentence for a screen reader. */
export function spokenFacts(facts: [string, string][]): string {
    const value = new Map(facts);
    const kept = ['Path', 'Level', 'Position', 'Distance', 'Colour'].filter((term) => value.has(term));
    return `Voxel. ${kept.map((term) => `${term} ${value.get(term)}`).join('. ')}.`;
}
