// SPDX-License-Identifier: MIT
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { type Opened, closePages, colouredCourtyard, courtyard, courtyardWithLamps, difference, folder, litCourtyard, octavo, open, quick, rest, saved, serveFolder, startBrowser, stopBrowser, view } from './harness';

beforeAll(startBrowser);
afterEach(closePages);
afterAll(stopBrowser);

const kCamera = { eye: [-14.1, 2.7, 1.8], azimuth: 100.2, elevation: 2, distance: 20 }; // in the court
const kPlace = `eye=${kCamera.eye.join()}&look=${kCamera.azimuth},${kCamera.elevation},${kCamera.distance}&fov=45`;
const kLook = `${kPlace}&light=-1&sun=-30&height=50`;

async function shown(fragment = quick, height = 240): Promise<Opened> {
    const opened = await open(`${await view(courtyard())}#${fragment}`, 800, height);
    await rest(opened.page);
    return opened;
}

const text = (page: Page, selector: string): Promise<string> => page.locator(selector).innerText();
const set = (page: Page, id: string, value: number): Promise<void> =>
    page.locator(`#${id}`).evaluate((input: HTMLInputElement, to) => {
        input.value = String(to);
        input.dispatchEvent(new Event('input', { bubbles: true }));
    }, value);
/** The view in the address, when all that has happened to it is there. */
const link = async (page: Page): Promise<string> => {
    // Pointer moves wait for a frame; the address follows 300 ms behind the last change.
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve, 350))));
    return page.evaluate(() => location.hash);
};

describe('the picture', () => {
    // The same rays with the same random numbers: only sin, cos and pow may round differently.
    const kSun = ['--sun=-30,50'];
    it.each([
        ['faces', courtyard, `${kLook}&samples=8&smooth=0`, [...kSun, '--flat', '--ao', '32', '--samples', '8', '--shadow-samples', '8'], [160, 100]],
        ['smoothed', courtyard, `${kLook}&smooth=1&samples=2`, [...kSun, '--ao', '8', '--samples', '2', '--shadow-samples', '2'], [32, 20]],
        ['hard shadows, no ambient occlusion', courtyard, `${kLook}&samples=8&smooth=0&shadows=hard&ambient=0`, [...kSun, '--flat', '--shadows', 'hard', '--ao', '0', '--samples', '8'], [160, 100]],
        ['colours', colouredCourtyard, `${kLook}&samples=4&smooth=0`, [...kSun, '--flat', '--ao', '16', '--samples', '4', '--shadow-samples', '4'], [160, 100]],
        ['lamps of every kind', courtyardWithLamps, `${kPlace}&samples=4&smooth=0`, ['--flat', '--ao', '16', '--samples', '4', '--shadow-samples', '4'], [160, 100]],
        ['stored light', litCourtyard, `${kPlace}&samples=4&smooth=0&detail=0`, ['--gi', 'cached', '--flat', '--samples', '4'], [160, 100]],
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
        const { page } = await open(`${await serveFolder(site, 20)}#${quick}`);
        await page.waitForFunction(() => /level [3-6] of 7/.test(document.querySelector('#loading-levels')!.textContent!));
        await page.waitForFunction(() => Number(document.querySelector<HTMLElement>('#picture')!.dataset.samples) > 0);
        expect(await page.locator('#loading').isVisible()).toBe(true);
        expect(await text(page, '#loading-text')).toMatch(/of .* MB/);
        await rest(page);
        expect(await page.locator('#loading').isVisible()).toBe(false);
    });
});

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

    it('move the camera by mouse, wheel, keys and fingers', async () => {
        const { page, faults } = await shown(`${kLook}&${quick}`, 440);
        let before = await link(page);
        const moves = async (what: string, act: () => Promise<unknown>): Promise<URLSearchParams> => {
            await act();
            const changed = page.waitForFunction((old) => location.hash !== old, before, { timeout: 20000 });
            await changed.catch(() => expect.fail(`${what}: the address is still ${before}`));
            const after = await link(page);
            before = after;
            return new URLSearchParams(after.slice(1));
        };
        const drag = async (button: 'left' | 'right'): Promise<void> => {
            await page.mouse.move(200, 200);
            await page.mouse.down({ button });
            await page.mouse.move(240, 220, { steps: 4 });
            await page.mouse.up({ button });
        };
        const start = new URLSearchParams(before.slice(1));
        const turned = await moves('left drag', () => drag('left'));
        expect(turned.get('look')!.split(',')[2], 'at the same distance').toBe(start.get('look')!.split(',')[2]);
        const panned = await moves('right drag', () => drag('right'));
        expect(panned.get('look'), 'in the same direction').toBe(turned.get('look'));
        const nearer = await moves('wheel', () => page.mouse.wheel(0, -300));
        expect(Number(nearer.get('look')!.split(',')[2])).toBeLessThan(Number(panned.get('look')!.split(',')[2]));
        await page.locator('#picture').focus();
        await moves('arrow', () => page.keyboard.press('ArrowLeft'));
        await moves('plus', () => page.keyboard.press('+'));
        for (const key of ['w', 'a', 's', 'd', 'q', 'e']) await moves(key, () => page.keyboard.press(key, { delay: 150 }));
        await moves('wheel sets the speed', async () => {
            await page.keyboard.down('w');
            await page.mouse.wheel(0, -200);
            await page.waitForFunction(() => document.querySelector('#toast')!.textContent!.includes('Speed'));
            await page.keyboard.up('w');
        });
        expect(await text(page, '#toast')).toMatch(/Speed/);
        await moves('frame all', () => page.keyboard.press('f'));
        await moves('double click', () => page.mouse.dblclick(250, 260));
        await moves('two fingers', () =>
            page.locator('#picture').evaluate((canvas) => {
                const touch = (type: string, pointerId: number, clientX: number): void => {
                    canvas.dispatchEvent(new PointerEvent(type, { pointerId, clientX, clientY: 200, pointerType: 'touch', bubbles: true, button: 0 }));
                };
                canvas.setPointerCapture = () => {};
                touch('pointerdown', 11, 200);
                touch('pointerdown', 12, 300);
                touch('pointermove', 12, 380);
                touch('pointerup', 12, 380);
                touch('pointerup', 11, 200);
            }),
        );
        expect(faults).toEqual([]);
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

    it('open help, change the theme, copy the link', async () => {
        const { page } = await shown();
        await page.keyboard.press('h');
        expect(await page.locator('#help-dialog').isVisible()).toBe(true);
        await page.keyboard.press('Escape');
        expect(await page.locator('#help-dialog').isVisible()).toBe(false);
        const before = await page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue('--ink'));
        await page.locator('#theme').click();
        expect(await page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue('--ink'))).not.toBe(before);
        await page.locator('#copy-link').click();
        await page.waitForFunction(() => location.hash.includes('eye='));
        await page.locator('#toggle-panel').click();
        expect(await page.locator('#panel').isVisible()).toBe(false);
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

describe('files', () => {
    const page = async (name: string, damage: (bytes: Buffer) => Buffer): Promise<Opened> => {
        const site = join(folder, name);
        octavo('export', courtyard(), '--html', site);
        const file = join(site, 'scene.octv');
        writeFileSync(file, damage(readFileSync(file)));
        return open(`${await serveFolder(site)}#${quick}`);
    };

    it('that are damaged give a message', async () => {
        const damages: [string, (bytes: Buffer) => Buffer][] = [
            ['cut', (bytes) => bytes.subarray(0, 9000)],
            ['flipped', (bytes) => ((bytes[bytes.length - 9]! ^= 4), bytes)],
            ['empty', () => Buffer.alloc(0)],
            ['text', () => Buffer.from('not a scene')],
        ];
        for (const [name, damage] of damages) {
            const { page: opened, faults } = await page(name, damage);
            await opened.locator('#notice').waitFor();
            expect(await text(opened, '#notice-title'), name).toBe('This file is damaged');
            expect(faults, name).toEqual([]);
        }
    });

    it('that do not fit are shown at a coarser level', async () => {
        const { page: opened } = await open(`${await view(courtyard())}#${quick}&memory=0.003`);
        await rest(opened);
        expect(await text(opened, '#toast')).toMatch(/Shown at (8|16|32)³ of 64³: all of it takes/);
    });

    it('can be dropped on the page', async () => {
        const other = join(folder, 'other.octv');
        octavo('build', 'sample:scan', '-o', other, '-r', '32', '--quiet');
        const { page: opened } = await shown();
        await opened.locator('#file').setInputFiles(other);
        await opened.waitForFunction(() => document.title.startsWith('other.octv'));
        await rest(opened);
        expect(await text(opened, '#statistics')).toMatch(/32 × 32 × 32/);
        const bytes = [...readFileSync(courtyard())];
        await opened.evaluate((content) => {
            const data = new DataTransfer();
            data.items.add(new File([new Uint8Array(content)], 'dropped.octv'));
            window.dispatchEvent(new DragEvent('drop', { dataTransfer: data, cancelable: true }));
        }, bytes);
        await opened.waitForFunction(() => document.title.startsWith('dropped.octv'));
        await rest(opened);
        expect(await text(opened, '#statistics')).toMatch(/64 × 64 × 64/);
    });

    it('work when compressed', async () => {
        const small = join(folder, 'compressed.octv');
        octavo('build', 'sample:courtyard', '-o', small, '-r', '64', '--quiet', '--compress');
        const { page: opened, faults } = await open(`${await view(small)}#${quick}`);
        await rest(opened);
        expect(faults).toEqual([]);
    });
});

describe('the machine', () => {
    it('may lose its WebGL context, and the picture comes back', async () => {
        const { page } = await shown(`${kLook}&${quick}`);
        const before = await saved(page);
        await page.evaluate(() => {
            const gl = document.querySelector<HTMLCanvasElement>('#picture')!.getContext('webgl2')!;
            const losing = gl.getExtension('WEBGL_lose_context')!;
            losing.loseContext();
            setTimeout(() => losing.restoreContext(), 200);
        });
        await page.waitForFunction(() => document.querySelector('#toast')!.textContent!.includes('reset'));
        await rest(page);
        expect(difference(before, await saved(page)).mean).toBeLessThan(0.05);
    });

    it('may have a compiler that refuses a program, which is said', async () => {
        const refuse = 'const { shaderSource } = WebGL2RenderingContext.prototype; WebGL2RenderingContext.prototype.shaderSource = function (shader, text) { return shaderSource.call(this, shader, text.includes("sky_samples_seen") ? `${text} ?` : text); };';
        const { page, faults } = await open(`${await view(courtyard())}#${quick}`, 800, 240, refuse);
        await page.locator('#notice').waitFor();
        expect(await text(page, '#notice-text')).toMatch(/compiler refuses/);
        expect(faults).toEqual([]);
    });

    it('may lack WebGL 2, which is said', async () => {
        const none = 'const get = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext = function (kind, ...more) { return kind === "webgl2" ? null : get.call(this, kind, ...more); };';
        const { page, faults } = await open(await view(courtyard()), 800, 240, none);
        const said = async (): Promise<void> => {
            expect(await page.locator('#notice').isVisible()).toBe(true);
            expect(await text(page, '#notice-title')).toMatch(/no WebGL 2/);
        };
        await said();
        await page.locator('#notice-close').click();
        await page.locator('#file').setInputFiles(courtyard());
        await said();
        expect(faults).toEqual([]);
    });
});

describe('serving', () => {
    it('takes the token', async () => {
        const url = await view(courtyard());
        const { page } = await open('about:blank');
        expect((await page.goto(new URL('/', url).href))!.status()).toBe(404);
        expect((await page.goto(`${url.slice(0, -3)}00/`))!.status()).toBe(404);
    });

    it('works from a plain file server', async () => {
        const site = join(folder, 'site');
        octavo('export', courtyard(), '--html', site);
        const { page, faults } = await open(`${await serveFolder(site)}#${quick}`);
        await rest(page);
        expect(faults).toEqual([]);
    });

    it('works as one file from a disk', async () => {
        const file = join(folder, 'single.html');
        octavo('export', courtyard(), '--html', file);
        const { page, faults } = await open(`file://${file}#${quick}`);
        await rest(page);
        expect(faults).toEqual([]);
    });

    it('says what to do where a folder is opened from a disk', async () => {
        const site = join(folder, 'disk');
        octavo('export', courtyard(), '--html', site);
        copyFileSync(join(site, 'index.html'), join(folder, 'disk.html'));
        const { page } = await open(`file://${join(folder, 'disk.html')}`);
        expect(await text(page, '#notice-title')).toMatch(/opened from a disk/);
    });
});

describe('a machine that draws', () => {
    it('sends the picture of octavo render, and finds voxels', async () => {
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
        expect(await page.locator('#row-memory').isVisible(), 'what it cannot do is not offered').toBe(false);
        expect(faults).toEqual([]);
    });
});
