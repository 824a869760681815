// SPDX-License-Identifier: MIT
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { PNG } from 'pngjs';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { closePages, colouredCourtyard, courtyard, courtyardWithLamps, difference, folder, kCamera, kLook, kPlace, litCourtyard, octavo, open, quick, rest, saved, serveFolder, set, shown, startBrowser, stopBrowser, text, view } from './harness';

beforeAll(startBrowser);
afterEach(closePages);
afterAll(stopBrowser);

describe('the picture', () => {
    // The same rays with the same random numbers: only sin, cos and pow may round differently.
    const kSun = ['--sun=-30,50'];
    it.each([
        ['faces', courtyard, `${kLook}&samples=8&smooth=0`, [...kSun, '--flat', '--ao', '32', '--samples', '8', '--shadow-samples', '8'], [160, 100]],
        ['smoothed', courtyard, `${kLook}&smooth=1&samples=2`, [...kSun, '--ao', '8', '--samples', '2', '--shadow-samples', '2'], [32, 20]],
        ['hard shadows, no ambient occlusion', courtyard, `${kLook}&samples=8&smooth=0&shadows=hard&ambient=0`, [...kSun, '--flat', '--shadows', 'hard', '--ao', '0', '--samples', '8'], [160, 100]],
        ['colours', colouredCourtyard, `${kLook}&samples=4&smooth=0`, [...kSun, '--flat', '--ao', '16', '--samples', '4', '--shadow-samples', '4'], [160, 100]],
        ['lamps of every kind', courtyardWithLamps, `${kPlace}&samples=4&smooth=0`, ['--flat', '--ao', '16', '--samples', '4', '--shadow-samples', '4'], [160, 100]],
        ['stored light', litCourtyard, `${kPlace}&samples=4&smooth=0`, ['--gi', 'cached', '--flat', '--samples', '4'], [160, 100]],
    ] as [string, () => string | Promise<string>, string, string[], [number, number]][])('is that of octavo render: %s', async (name, scene, fragment, options, [width, height]) => {
        const file = await scene();
        const expected = join(folder, 'expected.png');
        const radians = Math.PI / 180;
        const [azimuth, elevation] = [kCamera.azimuth * radians, kCamera.elevation * radians];
        const forward = [Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation), Math.cos(elevation) * Math.cos(azimuth)];
        const at = kCamera.eye.map((value, axis) => value + 10 * forward[axis]!);
        // Behind the file, as --gi may take a word of its own.
        octavo('render', file, '-o', expected, '--force', '--quiet', '--size', `${width}x${height}`, '--fov', '45',
            `--eye=${kCamera.eye.join()}`, `--at=${at.join()}`, ...options);
        const { page, faults } = await open(`${await view(file)}#${fragment}`, width, height);
        await rest(page);
        const picture = await saved(page);
        const { pixels, mean } = difference(picture, PNG.sync.read(readFileSync(expected)));
        if (process.env.OCTAVO_PICTURES) {
            writeFileSync(join(process.env.OCTAVO_PICTURES, `${name.slice(0, 8)}.png`), PNG.sync.write(picture));
            copyFileSync(expected, join(process.env.OCTAVO_PICTURES, `${name.slice(0, 8)}-expected.png`));
        }
        console.log(`${name}: ${(100 * pixels).toFixed(3)} % of the pixels differ, by ${mean.toFixed(3)} of 255 on average`);
        expect({ pixels: pixels < 0.01, mean: mean < 1 }, `${pixels} of the pixels differ, by ${mean} on average`).toEqual({ pixels: true, mean: true });
        expect(faults).toEqual([]);
    });

    it('is there as a preview before the programs that shade are compiled', async () => {
        const watch = `
            const p = WebGL2RenderingContext.prototype;
            const { linkProgram, bindFramebuffer, drawArrays } = p;
            let linked = 0;
            let toScreen = true;
            p.linkProgram = function (program) { linked += 1; return linkProgram.call(this, program); };
            p.bindFramebuffer = function (which, frame) { toScreen = frame === null; return bindFramebuffer.call(this, which, frame); };
            p.drawArrays = function (...what) { if (toScreen) window.linkedAtFirst ??= linked; return drawArrays.apply(this, what); };`;
        const { page, faults } = await open(`${await view(courtyard())}#${quick}`, 800, 240, watch);
        await rest(page);
        expect(await page.evaluate('window.linkedAtFirst')).toBe(2);
        expect(faults).toEqual([]);
    });

    it('shows coarse levels while fine ones are on their way', async () => {
        const site = join(folder, 'slow');
        const large = join(folder, 'large.octv');
        octavo('build', 'sample:courtyard', '-o', large, '-r', '256', '--quiet');
        octavo('export', large, '--html', site);
        const { page } = await open(`${await serveFolder(site, 60)}#${quick}`);
        await page.waitForFunction(() => /level [3-6] of 7/.test(document.querySelector('#loading-levels')!.textContent!));
        await page.waitForFunction(() => Number(document.querySelector<HTMLElement>('#picture')!.dataset.samples) > 0);
        expect(await page.locator('#loading').isVisible()).toBe(true);
        expect(await text(page, '#loading-text')).toMatch(/of .* MB/);
        await page.locator('#loading').waitFor({ state: 'hidden' });
    });

    it('is not dark where the eye is inside a cell of the finest level shown', async () => {
        const { page } = await open(`${await view(courtyard())}#${kLook}&smooth=0&samples=1`, 160, 100);
        for (const level of [1, 2, 3, 4, 5]) {
            await set(page, 'finestLevel', level);
            await rest(page);
            const { data } = await saved(page);
            let dark = 0;
            for (let i = 0; i < data.length; i += 4) dark += Math.max(data[i]!, data[i + 1]!, data[i + 2]!) < 16 ? 1 : 0;
            expect(dark / (data.length / 4), `level ${level}`).toBeLessThan(0.2);
        }
    });
});

describe('a link', () => {
    it('brings back the picture', async () => {
        const { page } = await shown(quick);
        await page.mouse.move(300, 120);
        await page.mouse.wheel(0, -400);
        await set(page, 'sunAzimuth', 120);
        await page.locator('#copy-link').click();
        await rest(page);
        const picture = await saved(page);
        const again = await open(page.url());
        await rest(again.page);
        expect(difference(picture, await saved(again.page)).mean).toBeLessThan(0.05);
    });
});
