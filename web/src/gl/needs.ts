// SPDX-License-Identifier: MIT
//
// Which programs a shot takes, and how well it can be drawn with those that are there.
import { type Painting, type Programs, type Recipe, kAnyLamp, kCells, kSmooth } from './programs';
import type { Shot } from './shot';

/** Without these nothing can be shown. */
export const kFirst: Recipe[] = [{ part: 'preview' }, { part: 'present' }];

/** What can be drawn of what was asked for: nothing, a preview, all but smoothed normals, all. */
export type Means = 'none' | 'preview' | 'faces' | 'all';

/** The program that paints the shot. */
export function paintingOf(shot: Shot): { painting: Painting; features: number } {
    const cells = shot.cells ? kCells : 0;
    const smooth = shot.smooth && (shot.mode === 'shaded' || shot.mode === 'normals') ? kSmooth : 0;
    if (shot.mode !== 'shaded') return { painting: 'views', features: cells | smooth };
    if (shot.stored) return { painting: 'stored', features: kCells | smooth };
    return { painting: 'shade', features: cells | smooth | (shot.lamps.onlySuns ? 0 : kAnyLamp) };
}

/** All that this shot takes, and what is one press away, so that it does not wait for the compiler then. */
export function recipesFor(shot: Shot): Recipe[] {
    const { painting, features } = paintingOf(shot);
    return [
        { part: 'primary' },
        { painting, features: features & ~kSmooth },
        { part: 'beam' },
        ...(features & kSmooth ? ([{ part: 'normals' }, { part: 'keep' }, { painting, features }] as Recipe[]) : []),
        { part: 'pick' },
        { painting: painting === 'views' ? 'shade' : 'views', features: features & kCells },
    ];
}

export function meansFor(programs: Programs, shot: Shot): Means {
    const { painting, features } = paintingOf(shot);
    if (!programs.part('present')) return 'none';
    if (!programs.part('primary') || !programs.painter(painting, features & ~kSmooth)) return programs.part('preview') ? 'preview' : 'none';
    if ((features & kSmooth) === 0) return 'all';
    return canSmooth(programs, shot) ? 'all' : 'faces';
}

/** Are normals to be smoothed, and is all there that it takes? */
export function canSmooth(programs: Programs, shot: Shot): boolean {
    const { painting, features } = paintingOf(shot);
    return (features & kSmooth) !== 0 && !!programs.part('normals') && !!programs.part('keep') && !!programs.painter(painting, features);
}
