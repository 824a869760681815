// SPDX-License-Identifier: MIT
//
// The light of a picture, as octavo render chooses it.
import type { Metadata, StoredLight } from '../octv/metadata';
import { type Axes, type Box, directionAt } from './camera';
import { type Vec3, add, length, scale, sub } from './vec';
import type { Settings } from './settings';

export interface Lamp {
    sun: boolean;
    direction: Vec3; // towards the sun; the way of a spot's light
    position: Vec3; // world space
    radius: number; // sun: radians; lamp: world units
    intensity: Vec3;
    spot?: { outer: number; inner: number }; // cosines
}

const kSunLight: Vec3 = [2.2, 0.88 * 2.2, 0.72 * 2.2];
const kSunRadius = 0.02; // of a sun whose file does not say
const kKnownKinds = ['sun', 'point', 'spot'];

/** Those that this page can shade with; numbers are the file's. */
export function usableLights(metadata: Metadata): number[] {
    return metadata.lights.map((_, i) => i).filter((i) => kKnownKinds.includes(metadata.lights[i]!.kind));
}

/** The first sun, else the first lamp; -1: none. */
export function storedLight(metadata: Metadata): number {
    const usable = usableLights(metadata);
    return usable.find((i) => metadata.lights[i]!.kind === 'sun') ?? usable[0] ?? -1;
}

const radians = (degrees: number): number => (degrees * Math.PI) / 180;

export function lampOf(settings: Settings, metadata: Metadata, axes: Axes, box: Box): Lamp {
    const stored = usableLights(metadata).includes(settings.light) ? metadata.lights[settings.light]! : undefined;
    if (!stored) {
        return {
            sun: true,
            direction: directionAt(axes, radians(settings.sunAzimuth), radians(settings.sunElevation)),
            position: [0, 0, 0],
            radius: radians(settings.sunSize),
            intensity: kSunLight,
        };
    }
    const sun = stored.kind === 'sun';
    const lamp: Lamp = {
        sun,
        direction: sun ? scale(-1, stored.direction) : stored.direction,
        position: stored.position,
        radius: stored.size > 0 || !sun ? stored.size : kSunRadius,
        intensity: scale(brightening(stored, box), stored.intensity),
    };
    if (stored.kind === 'spot') {
        const outer = Math.cos(stored.outerAngle);
        lamp.spot = { outer, inner: Math.max(Math.cos(stored.innerAngle), outer + 1e-6) };
    }
    return lamp;
}

/** Lights in unknown units are made as bright as the default sun; see octavo render. */
function brightening(light: StoredLight, box: Box): number {
    const brightest = Math.max(...light.intensity);
    if (!(brightest > 0)) return 1;
    if (light.kind === 'sun') return Math.min(1, kSunLight[0] / brightest);
    const centre = scale(0.5, add(box.low, box.high));
    const distance = Math.max(length(sub(light.position, centre)), 0.25 * length(sub(box.high, box.low)));
    return (kSunLight[0] * distance * distance) / brightest;
}
