// SPDX-License-Identifier: MIT
//
// Where the viewer stands, by the link that the page makes; and what is where in the picture, by
// formulas of its own.
import type { Page } from 'playwright-core';

export type Vec = [number, number, number];
export const plus = (a: Vec, b: Vec, s = 1): Vec => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
export const dot = (a: Vec, b: Vec): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const size = (a: Vec): number => Math.sqrt(dot(a, a));

export interface Stand {
    eye: Vec;
    forward: Vec; // unit length, as the others
    right: Vec;
    up: Vec; // of the picture
    distance: number;
    target: Vec;
    slope: number; // half the picture's height at distance 1
    link: URLSearchParams;
}

/** @param fragment  with y up */
export function standOf(fragment: string): Stand {
    const link = new URLSearchParams(fragment.replace(/^#/, ''));
    const numbers = (key: string): number[] => link.get(key)!.split(',').map(Number);
    const [azimuth, elevation] = numbers('look').map((degrees) => (degrees * Math.PI) / 180) as [number, number];
    const [sa, ca, se, ce] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(elevation), Math.cos(elevation)];
    const eye = numbers('eye') as Vec;
    const forward: Vec = [ce * sa, se, ce * ca];
    const distance = numbers('look')[2]!;
    return {
        eye, forward, distance, link,
        right: [-ca, 0, sa],
        up: [-se * sa, ce, -se * ca],
        target: plus(eye, forward, distance),
        slope: Math.tan((numbers('fov')[0]! * Math.PI) / 360),
    };
}

/** What the page would put on the clipboard now. */
export async function stand(page: Page): Promise<Stand> {
    return standOf(
        await page.evaluate(() => {
            document.querySelector<HTMLElement>('#copy-link')!.click();
            return location.hash;
        }),
    );
}

/** Where a point is in the picture, pixels from its middle: rightwards and downwards. */
export function seenAt(from: Stand, point: Vec, height: number): [number, number] {
    const way = plus(point, from.eye, -1);
    const unit = height / 2 / from.slope / dot(way, from.forward);
    return [dot(way, from.right) * unit, -dot(way, from.up) * unit];
}

/** The direction through a point of the picture, pixels from its middle. */
export function through(from: Stand, x: number, y: number, height: number): Vec {
    const unit = (2 * from.slope) / height;
    return plus(plus(from.forward, from.right, x * unit), from.up, -y * unit);
}
