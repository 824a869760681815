// SPDX-License-Identifier: MIT
//
// octavo view --render-here.
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { closePages, colouredCourtyard, difference, kLook, open, rest, saved, set, startBrowser, stopBrowser, text, view } from './harness';

beforeAll(startBrowser);
afterEach(closePages);
afterAll(stopBrowser);

describe('a machine that draws', () => {
    it('sends the picture that was asked for, and finds voxels', async () => {
        const { page, faults } = await open(`${await view(colouredCourtyard(), '--render-here')}#${kLook}`, 760, 200);
        await rest(page);
        const first = await saved(page);
        expect([first.width, first.height]).toEqual([760, 200]);
        await set(page, 'sunAzimuth', 100);
        await rest(page);
        expect(difference(first, await saved(page)).mean).toBeGreaterThan(0.3);
        await page.mouse.click(200, 120);
        await page.locator('#voxel').waitFor();
        expect(await text(page, '#voxel-facts')).toMatch(/Path[^]*Colour/);
        for (const row of ['memory', 'samples', 'detail', 'finestLevel']) {
            expect(await page.locator(`#row-${row}`).isVisible(), `${row}: what it cannot do is not offered`).toBe(false);
        }
        await set(page, 'scale', 50);
        await rest(page);
        const half = await saved(page);
        expect([half.width, half.height]).toEqual([380, 100]);
        expect(faults).toEqual([]);
    });

    it('shows what the page itself would without light, in every mode', async () => {
        const fragment = `${kLook}&samples=16&smooth=0&level=5&scale=100`;
        const here = await open(`${await view(colouredCourtyard())}#${fragment}`, 200, 120);
        const there = await open(`${await view(colouredCourtyard(), '--render-here')}#${fragment}`, 200, 120);
        await Promise.all([rest(here.page), rest(there.page)]);
        const modes = (page: typeof here.page): Promise<string[]> => page.locator('#modes button').allInnerTexts();
        expect(await modes(there.page)).toEqual(await modes(here.page));
        for (const [key, mode] of [['2', 'normals'], ['3', 'levels'], ['4', 'steps'], ['5', 'color']] as const) {
            for (const { page } of [here, there]) {
                await page.keyboard.press(key);
                await rest(page);
            }
            expect(await there.page.locator('#modes [aria-checked=true]').getAttribute('data-value')).toBe(mode);
            expect(await there.page.locator('#row-finestLevel').evaluate((row: HTMLElement) => row.hidden)).toBe(false);
            const { pixels, mean } = difference(await saved(here.page), await saved(there.page));
            console.log(`${mode}: ${(100 * pixels).toFixed(3)} % of the pixels differ, by ${mean.toFixed(3)} of 255 on average`);
            expect({ pixels: pixels < 0.01, mean: mean < 1 }, `${mode}: ${pixels}, ${mean}`).toEqual({ pixels: true, mean: true });
        }
        expect([...here.faults, ...there.faults]).toEqual([]);
    });
});
