// SPDX-License-Identifier: MIT
//
// The lights of a picture, as octavo render chooses them.
import type { Metadata, StoredLight } from '../octv/metadata';
import { type Axes, type Box, anglesOf, directionAt } from './camera';
import { cornersOf, knownKind } from './lamps';
import type { Settings } from './settings';
import { type Vec3, add, cross, length, scale, sub } from './vec';

export const kViewersSun = -1;
export const kAllLights = -2;

const kSunLight: Vec3 = [2.2, 0.88 * 2.2, 0.72 * 2.2];
const kSunRadius = 0.02; // of a sun whose file does not say

/** Those of a known kind; numbers are the file's. */
export function usableLights(metadata: Metadata): number[] {
    return metadata.lights.map((_, i) => i).filter((i) => knownKind(metadata.lights[i]!));
}

/** What a picture begins with: all lights of the file, or the only one, or the viewer's sun. */
export function storedLight(metadata: Metadata): number {
    const usable = usableLights(metadata);
    return usable.length > 1 ? kAllLights : (usable[0] ?? kViewersSun);
}

/** Where the file's sun stands, so that turning it begins there. */
export function storedSun(metadata: Metadata, light: number, axes: Axes): Partial<Settings> {
    const all = usableLights(metadata).map((i) => metadata.lights[i]!);
    const stored = light === kAllLights ? all.find(({ kind }) => kind === 'sun') : metadata.lights[light];
    if (stored?.kind !== 'sun') return {};
    const angles = anglesOf(axes, scale(-1, stored.direction));
    const degrees = 180 / Math.PI;
    return { sunAzimuth: Math.round(angles.azimuth * degrees), sunElevation: Math.round(angles.elevation * degrees) };
}

const radians = (degrees: number): number => (degrees * Math.PI) / 180;

export function lightsOf(settings: Settings, metadata: Metadata, axes: Axes, box: Box): StoredLight[] {
    const usable = usableLights(metadata);
    const stored = usable.filter((i) => settings.light === kAllLights || settings.light === i).map((i) => metadata.lights[i]!);
    if (stored.length > 0) return balanced(stored, box);
    return [
        {
            name: '', kind: 'sun', position: [0, 0, 0], innerAngle: 0, outerAngle: 0, halfU: [0, 0, 0], halfV: [0, 0, 0], triangles: [],
            direction: scale(-1, directionAt(axes, radians(settings.sunAzimuth), radians(settings.sunElevation))),
            intensity: kSunLight,
            size: radians(settings.sunSize),
        },
    ];
}

/** Lights in unknown units, together as bright as the default sun where they are brighter or no sun. */
function balanced(lights: StoredLight[], box: Box): StoredLight[] {
    const brightest = (light: StoredLight): number => Math.max(...light.intensity);
    const suns = lights.filter(({ kind }) => kind === 'sun').map(brightest);
    const brightestSun = Math.max(0, ...suns);
    const wanted = kSunLight[0];
    const sum = lights.reduce((all, light) => all + brightest(light) * reach(light, box), 0);
    const found = brightestSun > 0 ? Math.max(wanted, brightestSun) : sum;
    const factor = found > 0 ? wanted / found : 1;
    return lights.map((light) => ({
        ...light,
        size: light.kind === 'sun' && light.size === 0 ? kSunRadius : light.size,
        intensity: scale(factor, light.intensity),
    }));
}

/** What an intensity of 1 gives in the middle of the scene, with nothing in the way. */
function reach(light: StoredLight, box: Box): number {
    if (light.kind === 'sun') return 1;
    const centre = scale(0.5, add(box.low, box.high));
    const distance = Math.max(length(sub(middleOf(light), centre)), 0.25 * length(sub(box.high, box.low)));
    return shownArea(light) / Math.max(distance * distance, 1e-30);
}

function middleOf(light: StoredLight): Vec3 {
    if (light.kind !== 'mesh') return light.position;
    const sum = light.triangles.reduce<Vec3>((so, triangle) => add(so, scale(1 / 3, cornersOf(triangle).reduce(add))), [0, 0, 0]);
    return scale(1 / light.triangles.length, sum);
}

/** The area that a lamp shows in the direction that it shines in; a mesh is taken for a ball. */
function shownArea(light: StoredLight): number {
    if (light.kind === 'disc') return Math.PI * light.size * light.size;
    if (light.kind === 'rectangle') return 4 * length(cross(light.halfU, light.halfV));
    if (light.kind !== 'mesh') return 1;
    return light.triangles.reduce((sum, triangle) => {
        const [a, b, c] = cornersOf(triangle);
        return sum + 0.125 * length(cross(sub(b, a), sub(c, a)));
    }, 0);
}
