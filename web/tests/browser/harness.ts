// SPDX-License-Identifier: MIT
//
// The page in headless Chromium, on scenes that the octavo command makes. Needs OCTAVO_COMMAND, the
// path of that command, and Chromium.
import { type ChildProcess, execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import http from 'node:http';
import type { AddressInfo } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import pixelmatch from 'pixelmatch';
import { type Browser, type BrowserContext, type Page, chromium } from 'playwright-core';
import { PNG } from 'pngjs';
import { resealed } from '../unit/octv_file';

export const command = process.env.OCTAVO_COMMAND ?? '';
const chromiumPath = [process.env.CHROMIUM ?? '', '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(
    (path) => path !== '' && existsSync(path),
);
export const folder = mkdtempSync(join(tmpdir(), 'octavo-web-'));

export function octavo(...words: string[]): void {
    execFileSync(command, words, { stdio: ['ignore', 'ignore', 'inherit'] });
}

/** The built-in courtyard, small enough for a processor to draw. */
export function courtyard(): string {
    const file = join(folder, 'courtyard.octv');
    if (!existsSync(file)) octavo('build', 'sample:courtyard', '-o', file, '-r', '64', '--quiet');
    return file;
}

/** The same with colours, emission and the lanterns' light. */
export function colouredCourtyard(): string {
    const file = join(folder, 'coloured.octv');
    if (!existsSync(file)) octavo('build', 'sample:courtyard', '-o', file, '-r', '64', '--attributes', 'color,emission', '--quiet');
    return file;
}

/** And with light stored in its cells. */
export function litCourtyard(): string {
    const file = join(folder, 'lit.octv');
    if (!existsSync(file)) octavo('light', colouredCourtyard(), '-o', file, '--rays', '4', '--shadow-samples', '2', '--bounces', '1', '--quiet');
    return file;
}

/** The courtyard with a disc, a rectangle and a spot beside its mesh of lanterns and its sun. */
export async function courtyardWithLamps(): Promise<string> {
    const bytes = new Uint8Array(readFileSync(courtyard()));
    const view = new DataView(bytes.buffer);
    const size = Number(view.getBigUint64(64 + 16, true));
    const room = Number(view.getBigUint64(112 + 8, true)) - 0x1000;
    const metadata = JSON.parse(new TextDecoder().decode(bytes.slice(0x1000, 0x1000 + size)));
    const lamp = { inner_angle: 0, outer_angle: 0.6, direction: [0.2, -1, 0.1], size: 0.6 };
    metadata.lights = [
        ...metadata.lights.map((light: { kind: string; intensity: number[] }) => (light.kind === 'sun' ? { ...light, intensity: [0.6, 0.4, 0.3] } : light)),
        { ...lamp, name: 'disc', kind: 'disc', position: [-8, 5, 1], intensity: [30, 20, 10] },
        { ...lamp, name: 'window', kind: 'rectangle', position: [-4, 4, 2], intensity: [5, 20, 9], half_u: [0.7, 0, 0], half_v: [0, 0.1, 0.9] },
        { ...lamp, name: 'spot', kind: 'spot', position: [-10, 6, 2], intensity: [4, 4, 40], size: 0.1 },
    ];
    // Fewer lanterns, so that the text fits in the place of the old one.
    for (const light of metadata.lights) if (light.kind === 'mesh') light.triangles = light.triangles.slice(0, 9 * 40);
    const text = new TextEncoder().encode(JSON.stringify(metadata));
    if (text.length > room) throw new Error('The lamps do not fit');
    bytes.fill(0, 0x1000, 0x1000 + room);
    bytes.set(text, 0x1000);
    view.setBigUint64(64 + 16, BigInt(text.length), true);
    view.setBigUint64(64 + 24, BigInt(text.length), true);
    const file = join(folder, 'lamps.octv');
    writeFileSync(file, await resealed(bytes));
    return file;
}

let browser: Browser | undefined;
const servers: (() => void)[] = [];
const contexts: BrowserContext[] = [];

export async function startBrowser(): Promise<void> {
    if (!chromiumPath) throw new Error('There is no Chromium');
    browser = await chromium.launch({
        executablePath: chromiumPath,
        args: [
            '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
            '--disable-component-update', '--disable-sync', '--enable-unsafe-swiftshader',
        ],
    });
}

export async function closePages(): Promise<void> {
    for (const context of contexts.splice(0)) await context.close();
    for (const stop of servers.splice(0)) stop();
}

export async function stopBrowser(): Promise<void> {
    await browser?.close();
    rmSync(folder, { recursive: true });
}

/** Runs `octavo view` until the end of the test. @returns its address */
export async function view(file: string, ...more: string[]): Promise<string> {
    const child: ChildProcess = spawn(command, ['view', file, '--no-open', ...more], { stdio: ['ignore', 'pipe', 'inherit'] });
    servers.push(() => child.kill('SIGINT'));
    return new Promise((resolve, reject) => {
        let text = '';
        child.stdout!.on('data', (piece: Buffer) => {
            text += piece.toString();
            if (text.includes('\n')) resolve(text.trim());
        });
        child.on('exit', () => reject(new Error('octavo view has ended')));
    });
}

/** A file server that knows nothing of ranges. @param slow  bytes a millisecond */
export async function serveFolder(root: string, slow?: number): Promise<string> {
    const server = http.createServer(async (request, response) => {
        const path = join(root, request.url === '/' ? 'index.html' : request.url!);
        if (!existsSync(path)) return response.writeHead(404).end();
        const bytes = readFileSync(path);
        response.writeHead(200, {
            'Content-Type': path.endsWith('.html') ? 'text/html' : 'application/octet-stream',
            'Content-Length': bytes.length,
        });
        const piece = path.endsWith('.octv') && slow ? slow * 50 : bytes.length;
        for (let at = 0; at < bytes.length; at += piece) {
            response.write(bytes.subarray(at, at + piece));
            if (piece < bytes.length) await new Promise((resolve) => setTimeout(resolve, 50));
        }
        return response.end();
    });
    await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
    servers.push(() => server.close());
    return `http://127.0.0.1:${(server.address() as AddressInfo).port}/`;
}

export interface Opened {
    page: Page;
    faults: string[]; // errors that the page did not handle
}

/** Settings that a processor can draw. */
export const quick = 'smooth=0&samples=2&scale=25';

/** @param stopped  its clock goes only where the test lets it: page.clock */
export async function open(url: string, width = 800, height = 240, script?: string, stopped = false): Promise<Opened> {
    const context = await browser!.newContext({
        viewport: { width, height }, acceptDownloads: true, hasTouch: true, permissions: ['clipboard-read', 'clipboard-write'],
    });
    contexts.push(context);
    const page = await context.newPage();
    if (stopped) await page.clock.install();
    const faults: string[] = [];
    page.on('pageerror', (error) => faults.push(error.message));
    page.on('console', (message) => {
        if (message.type() === 'error') faults.push(message.text());
    });
    if (script) await page.addInitScript(script);
    await page.goto(url);
    return { page, faults };
}

/** Waits until the scene is there, and can be asked what is where. */
export async function ready(page: Page): Promise<void> {
    await page.waitForFunction(() => document.querySelector('#statistics')!.childElementCount > 0 && document.querySelector<HTMLElement>('#loading')!.hidden);
}

/** Waits until the picture is as good as it gets. Whatever changes it makes it `drawing` at once. */
export async function rest(page: Page): Promise<void> {
    await page.waitForFunction(() => document.querySelector<HTMLElement>('#picture')!.dataset.state === 'finished', undefined, { timeout: 110000 });
}

/** What the Picture button saves. */
export async function saved(page: Page): Promise<PNG> {
    const coming = page.waitForEvent('download');
    await page.evaluate(() => document.querySelector<HTMLElement>('#screenshot')!.click());
    return PNG.sync.read(readFileSync((await (await coming).path())!));
}

/** In the court of the courtyard. */
export const kCamera = { eye: [-14.1, 2.7, 1.8], azimuth: 100.2, elevation: 2, distance: 20 };
export const kPlace = `eye=${kCamera.eye.join()}&look=${kCamera.azimuth},${kCamera.elevation},${kCamera.distance}&fov=45`;
export const kLook = `${kPlace}&light=-1&sun=-30&height=50`;

/** The courtyard at rest. */
export async function shown(fragment = quick, height = 240): Promise<Opened> {
    const opened = await open(`${await view(courtyard())}#${fragment}`, 800, height);
    await rest(opened.page);
    return opened;
}

export const text = (page: Page, selector: string): Promise<string> => page.locator(selector).innerText();
/** Moves a slider. */
export const set = (page: Page, id: string, value: number): Promise<void> =>
    page.locator(`#${id}`).evaluate((input: HTMLInputElement, to) => {
        input.value = String(to);
        input.dispatchEvent(new Event('input', { bubbles: true }));
    }, value);

export interface Difference {
    pixels: number; // part of them that differ by more than the eye forgives
    mean: number; // of the colours, 0 to 255
}

export function difference(a: PNG, b: PNG): Difference {
    if (a.width !== b.width || a.height !== b.height) throw new Error(`${a.width}x${a.height} against ${b.width}x${b.height}`);
    const pixels = pixelmatch(a.data, b.data, undefined, a.width, a.height, { threshold: 0.1, includeAA: true });
    let sum = 0;
    for (let i = 0; i < a.data.length; i += 1) sum += Math.abs(a.data[i]! - b.data[i]!);
    return { pixels: pixels / (a.width * a.height), mean: sum / (3 * a.width * a.height) };
}
