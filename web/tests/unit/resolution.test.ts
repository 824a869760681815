// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { kFrame, kLeastScale, kLeastStrip, liveScaleAfter, restScales, stripAfter } from '../../src/gl/resolution';

/** A GPU that takes so many milliseconds for the full picture, and some for each however small. */
const run = (full: number, fixed: number, pictures: number, from = kLeastScale, noise = (_: number): number => 1): { scale: number; took: number }[] => {
    const drawn = [];
    let scale = from;
    for (let i = 0; i < pictures; i += 1) {
        const took = (full * scale * scale + fixed) * noise(i);
        drawn.push({ scale, took });
        scale = liveScaleAfter(scale, took);
    }
    return drawn;
};

describe('the picture of a camera that moves', () => {
    it('is smaller after one that was late, larger after one that was early', () => {
        expect(liveScaleAfter(0.5, 2 * kFrame)).toBeLessThan(0.5);
        expect(liveScaleAfter(0.5, 0.25 * kFrame)).toBeGreaterThan(0.5);
        expect(liveScaleAfter(0.5, 0.8 * kFrame)).toBe(0.5);
    });
    it('stays between the least and the full size', () => {
        expect(liveScaleAfter(1, 0.001)).toBe(1);
        expect(liveScaleAfter(kLeastScale, 10000)).toBe(kLeastScale);
    });
    it('is changed by half at most by one that was late by chance', () => {
        expect(liveScaleAfter(0.8, 100000)).toBeGreaterThanOrEqual(0.4);
    });
    it.each([5, 20, 60, 250, 1000, 1900])('comes to rest, in time and not wastefully, where the full one takes %d ms', (full) => {
        for (const fixed of [0, 4, 12])
            for (const from of [kLeastScale, 0.4, 1]) {
                const drawn = run(full, fixed, 60, from);
                const settled = drawn.slice(20);
                const { scale } = settled[0]!;
                expect(settled.every((each) => each.scale === scale), `${full} + ${fixed} ms from ${from}: no to and fro`).toBe(true);
                if (scale > kLeastScale) expect(settled[0]!.took).toBeLessThanOrEqual(kFrame);
                if (scale < 1) expect(settled[0]!.took).toBeGreaterThan(0.59 * kFrame);
            }
    });
    it('grows without ever being late on a GPU that is steady', () => {
        for (const full of [30, 100, 400, 1500]) for (const { took } of run(full, 3, 60)) expect(took).toBeLessThanOrEqual(kFrame);
    });
    it('stays within a narrow band where times vary by a fifth', () => {
        let seed = 1;
        const noise = (): number => 0.8 + 0.4 * ((seed = (seed * 16807) % 2147483647) / 2147483647);
        const drawn = run(200, 3, 400, kLeastScale, noise).slice(50);
        const scales = drawn.map(({ scale }) => scale);
        expect(Math.max(...scales) / Math.min(...scales)).toBeLessThan(1.25);
        expect(drawn.filter(({ took }) => took > kFrame).length / drawn.length).toBeLessThan(0.1);
    });
    it('follows a GPU that becomes slower, within five pictures', () => {
        const before = run(40, 2, 30).at(-1)!.scale;
        const after = run(600, 2, 6, before);
        expect(after[0]!.took).toBeGreaterThan(5 * kFrame);
        expect(after[5]!.took).toBeLessThanOrEqual(kFrame);
    });
});

describe('the pictures of a camera that rests', () => {
    it('end with the full one, each larger than the one before', () => {
        for (const shown of [0, 0.125, 0.3, 0.7, 1])
            for (const full of [1, 0.5, 0.25]) {
                const scales = restScales(shown, full);
                expect(scales.at(-1)).toBe(full);
                for (let i = 1; i < scales.length; i += 1) expect(scales[i]!).toBeGreaterThan(scales[i - 1]!);
            }
    });
    it('begin with what is better than what is shown', () => {
        expect(restScales(0, 1)).toEqual([0.25, 0.5, 1]);
        expect(restScales(0.25, 1)).toEqual([0.5, 1]);
        expect(restScales(1, 1)).toEqual([1]);
    });
    it('are drawn in strips that are larger where a strip is quick', () => {
        expect(stripAfter(10000, 6)).toBe(20000);
        expect(stripAfter(40000, 48)).toBe(20000);
        expect(stripAfter(5000, 1e6)).toBe(kLeastStrip);
        let strip = kLeastStrip;
        for (let i = 0; i < 40; i += 1) strip = stripAfter(strip, strip * 0.001);
        expect(strip * 0.001).toBeCloseTo(24, 6);
    });
});
