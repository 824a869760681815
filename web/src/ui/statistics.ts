// SPDX-License-Identifier: MIT
import type { EngineStatistics } from '../gl/engine';
import { megabytes, shortCount } from './numbers';

export function engineFacts(s: EngineStatistics, sceneBytes: number): [string, string][] {
    return [
        ['Rays', s.raysPerSecond > 0 ? `${shortCount(s.raysPerSecond)} a second` : 'at rest'],
        ['Picture', `${s.width} × ${s.height}, ${s.samples} ${s.samples === 1 ? 'sample' : 'samples'}`],
        ['Frames', s.framesPerSecond > 0 ? `${s.framesPerSecond} a second` : 'at rest'],
        ['GPU memory', `${megabytes(sceneBytes)} scene, ${megabytes(s.bytes)} pictures`],
    ];
}
