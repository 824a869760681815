// SPDX-License-Identifier: MIT
//
// Camera and settings as the fragment of a URL: docs/viewer.md. What it says is not trusted.
import type { Camera } from './camera';
import { clampElevation } from './camera';
import { type Mode, type NumberSetting, type Settings, type Shadows, kDefaults, kModes, kRanges, kShadows } from './settings';

export interface View {
    camera?: Camera;
    settings: Partial<Settings>;
}

const kNames: Record<NumberSetting, string> = {
    light: 'light',
    sunAzimuth: 'sun',
    sunElevation: 'height',
    sunSize: 'size',
    ambientRadius: 'reach',
    exposure: 'exposure',
    detail: 'detail',
    finestLevel: 'level',
    scale: 'scale',
    samples: 'samples',
    memory: 'memory',
};

const degrees = (radians: number): number => (radians * 180) / Math.PI;
const radians = (value: number): number => (value * Math.PI) / 180;
/** As short as it can be with this many digits. */
const short = (value: number, digits: number): string => String(Number(value.toPrecision(digits)));

/** Only what differs from the defaults, and the camera. */
export function linkOf(camera: Camera | undefined, settings: Settings, base: Settings = kDefaults): string {
    const parts: string[] = [];
    if (camera) {
        parts.push(`eye=${camera.eye.map((value) => short(value, 9)).join(',')}`);
        parts.push(`look=${short(degrees(camera.azimuth), 8)},${short(degrees(camera.elevation), 8)},${short(camera.distance, 6)}`);
        parts.push(`fov=${short(degrees(camera.verticalFov), 7)}`);
    }
    if (settings.mode !== base.mode) parts.push(`mode=${settings.mode}`);
    if (settings.up !== base.up) parts.push(`up=${settings.up}`);
    if (settings.shadows !== base.shadows) parts.push(`shadows=${settings.shadows}`);
    if (settings.ambient !== base.ambient) parts.push(`ambient=${settings.ambient ? 1 : 0}`);
    if (settings.stored !== base.stored) parts.push(`stored=${settings.stored ? 1 : 0}`);
    if (settings.smooth !== base.smooth) parts.push(`smooth=${settings.smooth ? 1 : 0}`);
    for (const key of Object.keys(kNames) as NumberSetting[]) {
        if (settings[key] !== base[key]) parts.push(`${kNames[key]}=${short(settings[key], 6)}`);
    }
    return parts.join('&');
}

function numbers(value: string | undefined, count: number): number[] | undefined {
    const list = value?.split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
    if (!list || list.length !== count || !list.every(Number.isFinite)) return undefined;
    return list;
}

function flag(value: string | undefined): boolean | undefined {
    return value === '1' ? true : value === '0' ? false : undefined;
}

/** What cannot be read is as if it were not there. */
export function readLink(fragment: string): View {
    const pairs = fragment.replace(/^#/, '').split('&').map((part) => part.split('='));
    const values = new Map(pairs.map(([key, value]) => [key, value]));
    const settings: Partial<Settings> = {};
    for (const key of Object.keys(kNames) as NumberSetting[]) {
        const value = numbers(values.get(kNames[key]), 1)?.[0];
        const range = kRanges[key];
        if (value !== undefined) settings[key] = Math.max(range.least, Math.min(range.most, value));
    }
    if (settings.samples !== undefined) settings.samples = Math.round(settings.samples);
    if (settings.light !== undefined) settings.light = Math.round(settings.light);
    if (settings.finestLevel !== undefined) settings.finestLevel = Math.round(settings.finestLevel);
    const mode = values.get('mode');
    if (kModes.includes(mode as Mode)) settings.mode = mode as Mode;
    const shadows = values.get('shadows');
    if (kShadows.includes(shadows as Shadows)) settings.shadows = shadows as Shadows;
    const up = values.get('up');
    if (up === 'y' || up === 'z') settings.up = up;
    const ambient = flag(values.get('ambient'));
    if (ambient !== undefined) settings.ambient = ambient;
    const stored = flag(values.get('stored'));
    if (stored !== undefined) settings.stored = stored;
    const smooth = flag(values.get('smooth'));
    if (smooth !== undefined) settings.smooth = smooth;

    const eye = numbers(values.get('eye'), 3);
    const look = numbers(values.get('look'), 3);
    const fov = numbers(values.get('fov'), 1)?.[0];
    if (!eye || !look || !(look[2]! > 0)) return { settings };
    const camera: Camera = {
        eye: [eye[0]!, eye[1]!, eye[2]!],
        azimuth: radians(look[0]!),
        elevation: clampElevation(radians(look[1]!)),
        distance: look[2]!,
        verticalFov: radians(Math.max(1, Math.min(150, fov ?? 40))),
    };
    return { camera, settings };
}
