// SPDX-License-Identifier: MIT
//
// The sky that the file's light is of, from the text of octavo light's --sky.
import type { StoredSky } from '../gl/shot';
import type { Vec3 } from './vec';

const kBlack = 0;
const kConstant = 1;
const kGradient = 2;
const kZenith: Vec3 = [0.3, 0.47, 0.78]; // of the clear sky
const kHorizon: Vec3 = [0.8, 0.86, 0.93];
const kGround: Vec3 = [0.42, 0.39, 0.35];

function color(text: string | undefined): Vec3 | undefined {
    const list = text?.split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
    return list?.length === 3 && list.every((value) => Number.isFinite(value) && value >= 0) ? (list as Vec3) : undefined;
}

/** A picture, or what cannot be read, is shown as the clear sky; the light of the cells is what it is. */
export function storedSky(text: string): StoredSky {
    const [kind, ...parts] = text.split(':');
    const values = new Map(parts.map((part) => part.split('=') as [string, string]));
    const power = Number(values.get('power') ?? 1);
    const factor = Number.isFinite(power) && power >= 0 ? power : 1;
    if (kind === 'none') return { kind: kBlack, factor, colors: [kZenith, kHorizon, kGround] };
    const one = kind === 'color' ? color(parts[0]) : undefined;
    if (one) return { kind: kConstant, factor, colors: [one, one, one] };
    const own = kind === 'gradient';
    const of = (name: string, otherwise: Vec3): Vec3 => (own && color(values.get(name))) || otherwise;
    return { kind: kGradient, factor, colors: [of('zenith', kZenith), of('horizon', kHorizon), of('ground', kGround)] };
}
