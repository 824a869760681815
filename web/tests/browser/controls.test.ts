// SPDX-License-Identifier: MIT
//
// What each control does, by the picture, the link and the page's own words.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import type { FileChooser } from 'playwright-core';
import { PNG } from 'pngjs';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { closePages, colouredCourtyard, command, courtyard, difference, kLook, kPlace, litCourtyard, open, quick, ready, rest, saved, set, shown, startBrowser, stopBrowser, text, view } from './harness';
import { size, stand, through } from './stand';

beforeAll(startBrowser);
afterEach(closePages);
afterAll(stopBrowser);

describe('controls', () => {
    it('change the picture, each in its own way', async () => {
        const { page, faults } = await shown(`${kLook}&${quick}`);
        let before = await saved(page);
        const changes = async (what: string, act: () => Promise<unknown>): Promise<void> => {
            await act();
            await rest(page);
            const after = await saved(page);
            expect(difference(before, after).mean, what).toBeGreaterThan(0.3);
            before = after;
        };
        await changes('sun size', () => set(page, 'sunSize', 10));
        await changes('radius', () => set(page, 'ambientRadius', 30));
        await changes('ambient', () => page.locator('#ambient').click());
        await changes('hard shadows', () => page.locator('#shadows [data-value=hard]').click());
        await changes('no shadows', () => page.locator('#shadows [data-value=none]').click());
        await changes('sun direction', () => set(page, 'sunAzimuth', 100));
        await changes('sun height', () => set(page, 'sunElevation', 15));
        await changes('exposure', () => set(page, 'exposure', 1.5));
        await changes('level', () => set(page, 'finestLevel', 4));
        await changes('normals', () => page.locator('#modes [data-value=normals]').click());
        expect(await page.locator('#row-sunAzimuth').isVisible(), 'normals have no light').toBe(false);
        await changes('levels', () => page.keyboard.press('3'));
        expect(await page.locator('#legend').isVisible()).toBe(true);
        await changes('steps', () => page.locator('#modes [data-value=steps]').click());
        await changes('shaded', () => page.keyboard.press('1'));
        await changes('cells', () => set(page, 'finestLevel', 6));
        await changes('smallest cell', () => set(page, 'detail', 8));
        await changes('up', () => page.locator('#up [data-value=z]').click());
        expect(faults).toEqual([]);
    });

    it('say what they do to a screen reader and a keyboard', async () => {
        const { page } = await shown();
        const unnamed = await page.evaluate(() =>
            [...document.querySelectorAll<HTMLElement>('button, input, select, canvas, [role]')]
                .filter((element) => !element.closest('[hidden]'))
                .filter((element) => {
                    const labels = (element as HTMLInputElement).labels?.length ?? 0;
                    return !element.textContent!.trim() && !element.ariaLabel && !element.title && labels === 0 && !element.getAttribute('aria-live');
                })
                .map((element) => element.outerHTML.slice(0, 80)),
        );
        expect(unnamed).toEqual([]);
        await page.locator('#modes [aria-checked=true]').focus();
        await page.keyboard.press('ArrowRight');
        expect(await page.locator('#modes [aria-checked=true]').innerText()).toBe('Normals');
        expect(await page.evaluate(() => document.activeElement!.textContent)).toBe('Normals');
    });

    it('read the voxel that is clicked', async () => {
        const { page } = await shown(`${kLook}&${quick}`, 440);
        await page.mouse.click(250, 260);
        await page.locator('#voxel').waitFor();
        const facts = await text(page, '#voxel-facts');
        expect(facts).toMatch(/Path\s*\d+, \d+, \d+/);
        expect(facts).toMatch(/Position/);
        const [panel, voxel] = [(await page.locator('#panel').boundingBox())!, (await page.locator('#voxel').boundingBox())!];
        expect(voxel.y, 'what was found is in sight').toBeLessThan(panel.y + panel.height - 40);
        await page.locator('#toggle-panel').click();
        await page.mouse.click(250, 260);
        await page.waitForFunction(() => /Path \d+/.test(document.querySelector('#toast.shown')?.textContent ?? ''));
    });

    it('show the colours and the light of a file, and read them', async () => {
        const { page, faults } = await open(`${await view(litCourtyard())}#${kPlace}&${quick}`, 800, 440);
        await rest(page);
        const stored = await saved(page);
        expect(await page.locator('#row-sunAzimuth').isVisible(), 'stored light has no sun to turn').toBe(false);
        await page.locator('#stored').click();
        await rest(page);
        const direct = await saved(page);
        expect(difference(stored, direct).mean).toBeGreaterThan(0.3);
        await page.locator('#modes [data-value=color]').click();
        await rest(page);
        expect(difference(direct, await saved(page)).mean).toBeGreaterThan(0.3);
        await page.mouse.click(250, 260);
        await page.locator('#voxel').waitFor();
        expect(await text(page, '#voxel-facts')).toMatch(/Colour\s*#[0-9a-f]{6}/);
        expect(await text(page, '#statistics')).toMatch(/Coloured cells/);
        expect(faults).toEqual([]);
    });

    it('show of each cell what its read-out says', async () => {
        // Narrow, so that nothing covers the picture; one ray to a pixel.
        const [width, height, x, y] = [480, 320, 250, 240];
        const { page, faults } = await open(`${await view(colouredCourtyard())}#${kPlace}&smooth=0&samples=1&scale=100&detail=0`, width, height);
        await ready(page);
        await page.mouse.click(x, y);
        await page.waitForFunction(() => document.querySelector('#voxel-facts')!.childElementCount > 0);
        const facts = await page.locator('#voxel-facts').evaluate((list) => [...list.children].map((each) => each.textContent!));
        const fact = (term: string): string => facts[facts.indexOf(term) + 1]!;
        const place = await stand(page);
        const ray = through(place, x + 0.5 - width / 2, y + 0.5 - height / 2, height);
        const axis = 'xyz'.indexOf(fact('Face')[1]!);
        const sign = fact('Face')[0] === '+' ? 1 : -1;
        const shows = async (key: string, mode: string, wanted: number[]): Promise<void> => {
            await page.keyboard.press(key);
            expect((await stand(page)).link.get('mode'), key).toBe(mode);
            expect(await page.locator('#modes [aria-checked=true]').getAttribute('data-value')).toBe(mode);
            await rest(page);
            const { data } = await saved(page);
            const seen = [0, 1, 2].map((i) => data[4 * (y * width + x) + i]!);
            for (let i = 0; i < 3; i += 1) expect(Math.abs(seen[i]! - wanted[i]!), `${mode}: ${seen} for ${wanted}`).toBeLessThanOrEqual(2);
        };
        await shows('2', 'normals', [0, 1, 2].map((i) => 127.5 + (i === axis ? 127.5 * sign : 0)));
        const facing = 0.7 + 0.3 * Math.abs(ray[axis]! / size(ray));
        await shows('3', 'levels', [0.99, 0.91, 0.57].map((value) => 255 * value * facing));
        expect(await text(page, '#legend-high')).toBe('voxels, level 6');
        await shows('5', 'color', [1, 3, 5].map((at) => parseInt(fact('Colour').slice(at, at + 2), 16)));
        await page.keyboard.press('4');
        expect((await stand(page)).link.get('mode')).toBe('steps');
        expect(await text(page, '#legend-low')).toBe('0 cells');
        await page.keyboard.press('1');
        expect((await stand(page)).link.get('mode')).toBe(null);
        expect(faults).toEqual([]);
    });

    it('say how large and good the picture is, and how much of the scene is on the GPU', async () => {
        const { page } = await shown(`${kLook}&smooth=0&samples=3&scale=50`);
        const facts = (): Promise<string> => text(page, '#statistics');
        expect(await facts()).toMatch(/Picture\s+400 × 120, 3 samples/);
        await set(page, 'samples', 5);
        await rest(page);
        expect(await facts()).toMatch(/400 × 120, 5 samples/);
        await set(page, 'scale', 25);
        await rest(page);
        expect(await facts()).toMatch(/200 × 60, 5 samples/);
        const flat = await saved(page);
        await page.locator('#smooth').click(); // its picture is compared with that of octavo render elsewhere
        expect((await stand(page)).link.get('smooth')).toBe('1');
        await page.locator('#smooth').click();
        await rest(page);
        expect(difference(flat, await saved(page)).mean).toBeLessThan(0.05);
        await page.locator('#memory').fill('0.003');
        await page.locator('#memory').press('Enter');
        await page.waitForFunction(() => document.querySelector('#toast')!.textContent!.includes('Shown at 8³ of 64³'));
        await rest(page);
        expect(difference(flat, await saved(page)).mean).toBeGreaterThan(0.3);
        await page.locator('#memory').fill('-1');
        await page.locator('#memory').press('Enter');
        expect(await page.locator('#memory').inputValue(), 'what cannot be is not taken').toBe('0.003');
    });

    it('go to the cameras of the file and choose its lights', async () => {
        const { page } = await shown(quick);
        const info = JSON.parse(execFileSync(command, ['info', courtyard(), '--json']).toString());
        expect(await page.locator('#cameras option').allInnerTexts()).toEqual(['Free', ...info.cameras]);
        expect(await page.locator('#cameras').inputValue()).toBe('0');
        const [first, before] = [await stand(page), await saved(page)];
        await page.locator('#cameras').selectOption('above');
        const above = await stand(page);
        expect(above.forward[1], 'from above').toBeLessThan(-0.5);
        expect(above.eye[1]).toBeGreaterThan(first.eye[1] + 5);
        await page.locator('#picture').press('ArrowLeft');
        expect(await page.locator('#cameras').inputValue(), 'moved away').toBe('-1');
        await page.locator('#cameras').selectOption('court');
        await rest(page);
        expect((await stand(page)).eye).toEqual(first.eye);
        expect(difference(before, await saved(page)).mean).toBeLessThan(0.05);

        expect(await page.locator('#lights option').allInnerTexts()).toEqual(['Sun of the viewer', `All ${info.lights.length}`, ...info.lights]);
        expect(await page.locator('#row-sunAzimuth').isVisible(), 'all at once cannot be turned').toBe(false);
        await page.locator('#lights').selectOption('sun');
        await rest(page);
        expect((await stand(page)).link.get('light')).toBe('0');
        const sun = await saved(page);
        await page.locator('#lights').selectOption('Sun of the viewer');
        await rest(page);
        await set(page, 'sunAzimuth', 170);
        await rest(page);
        expect(difference(sun, await saved(page)).mean).toBeGreaterThan(0.3);
    });

    it('frame all of it, and nothing else', async () => {
        const { page } = await open(`${await view(courtyard())}#${kPlace}&mode=normals&smooth=0&samples=1`, 800, 440);
        await ready(page);
        await page.keyboard.press('f');
        const framed = await stand(page);
        await rest(page);
        const { data, width, height } = await saved(page);
        const clear = (await page.locator('#panel').boundingBox())!.x;
        // Behind the scene this view is a dark grey.
        const [low, high] = [[width, height], [0, 0]];
        for (let y = 0; y < height; y += 1)
            for (let x = 0; x < width; x += 1) {
                if (Math.max(...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3)) < 64) continue;
                low[0] = Math.min(low[0]!, x);
                low[1] = Math.min(low[1]!, y);
                high[0] = Math.max(high[0]!, x);
                high[1] = Math.max(high[1]!, y);
            }
        expect(low[0]).toBeGreaterThan(0);
        expect(low[1]).toBeGreaterThan(0);
        expect(high[0]).toBeLessThan(clear);
        expect(high[1]).toBeLessThan(height - 1);
        expect(Math.max((high[0]! - low[0]!) / clear, (high[1]! - low[1]!) / height)).toBeGreaterThan(0.6);
        const [azimuth, elevation] = framed.link.get('look')!.split(',').map(Number);
        expect([azimuth, elevation], 'from the side that was seen').toEqual([100.2, 2]);
    });

    it('put a link on the clipboard and a picture in the downloads, and ask for a file', async () => {
        const { page } = await shown(`${kLook}&${quick}`);
        // From the beginning: Chromium takes some time to ask us and not a person.
        const asked: FileChooser[] = [];
        page.on('filechooser', (chooser) => asked.push(chooser));
        const clipboard = (): Promise<string> => page.evaluate(() => navigator.clipboard.readText());
        await page.locator('#copy-link').click();
        await expect.poll(clipboard).toBe(page.url());
        expect(page.url()).toContain('sun=-30');
        await page.evaluate(() => navigator.clipboard.writeText('something else'));
        await page.keyboard.press('c');
        await expect.poll(clipboard).toBe(page.url());

        // What is saved is what is seen.
        const coming = page.waitForEvent('download');
        await page.keyboard.press('p');
        const download = await coming;
        expect(download.suggestedFilename()).toBe('courtyard.png');
        const picture = PNG.sync.read(readFileSync((await download.path())!));
        await page.evaluate(() => {
            for (const id of ['bar', 'panel', 'toast', 'loading']) document.getElementById(id)!.style.display = 'none';
        });
        const seen = PNG.sync.read(await page.screenshot());
        expect(difference(picture, seen).mean).toBeLessThan(0.5);

        await page.keyboard.press('o');
        await expect.poll(() => asked.length).toBe(1);
        expect(asked[0]!.isMultiple()).toBe(false);
    });

    it('open help, change the theme, close the panel', async () => {
        const { page } = await shown();
        await page.keyboard.press('h');
        expect(await page.locator('#help-dialog').isVisible()).toBe(true);
        expect(await page.locator('#help-dialog').evaluate((dialog) => dialog.scrollTop), 'from its beginning').toBe(0);
        const listed = await page.locator('#help-dialog kbd').allInnerTexts();
        expect(listed.join(' '), 'all keys that are tested, and no others').toBe('+ − W A S D Q E Shift Enter Shift Enter F 1 4 P C O H');
        await page.keyboard.press('Escape');
        expect(await page.locator('#help-dialog').isVisible()).toBe(false);
        await page.keyboard.press('h');
        await page.keyboard.press('h');
        expect(await page.locator('#help-dialog').isVisible()).toBe(false);
        const before = await page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue('--ink'));
        await page.locator('#theme').click();
        expect(await page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue('--ink'))).not.toBe(before);
        await page.locator('#toggle-panel').click();
        expect(await page.locator('#panel').isVisible()).toBe(false);
    });
});
