// SPDX-License-Identifier: MIT
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { type Opened, closePages, courtyard, difference, folder, kLook, octavo, open, quick, rest, saved, serveFolder, shown, startBrowser, stopBrowser, text, view } from './harness';

beforeAll(startBrowser);
afterEach(closePages);
afterAll(stopBrowser);

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
