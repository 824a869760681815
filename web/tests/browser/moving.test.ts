// SPDX-License-Identifier: MIT
//
// Which way the camera goes, by mouse, keys and fingers: the page's link against geometry.
import { execFileSync } from 'node:child_process';
import type { CDPSession, Page } from 'playwright-core';
import { afterAll, beforeAll, beforeEach, describe, expect, it } from 'vitest';
import { closePages, command, courtyard, open, quick, ready, startBrowser, stopBrowser, view } from './harness';
import { type Stand, type Vec, dot, plus, seenAt, size, stand, standOf, through } from './stand';

const [width, height] = [480, 360]; // narrow, so that nothing covers the picture but the bar
const [x0, y0] = [width / 2, height / 2];
/** Pictures are not what is tested here, and take a processor long: only those of one pixel are drawn. */
const kNoPictures = `
    const { viewport, drawArrays } = WebGL2RenderingContext.prototype;
    let pixels = 0;
    WebGL2RenderingContext.prototype.viewport = function (x, y, w, h) { pixels = w * h; viewport.call(this, x, y, w, h); };
    WebGL2RenderingContext.prototype.drawArrays = function (...what) { if (pixels === 1) drawArrays.apply(this, what); };`;
const kPlace = `eye=-14.1,2.7,1.8&look=100.2,2,20&fov=45&${quick}`;

let page: Page;
let faults: string[];
let touch: CDPSession;
let start: Stand;

beforeAll(async () => {
    await startBrowser();
    ({ page, faults } = await open(`${await view(courtyard())}#${kPlace}`, width, height, kNoPictures, true));
    await ready(page);
    await page.clock.pauseAt((await page.evaluate(() => Date.now())) + 100);
    touch = await page.context().newCDPSession(page);
});
afterAll(async () => {
    expect(faults).toEqual([]);
    await closePages();
    await stopBrowser();
});

/** Lets the page act on what it was given: pointer moves and wheels wait for a frame of the browser. */
const settle = async (): Promise<Stand> => {
    await page.clock.runFor(20);
    return stand(page);
};
/** After what comes without an answer: a wheel. */
const changed = async (from: Stand): Promise<Stand> => {
    for (let i = 0; i < 200; i += 1) {
        const now = await settle();
        if (now.link.toString() !== from.link.toString()) return now;
        await new Promise((resolve) => setTimeout(resolve, 10));
    }
    throw new Error('Nothing has moved');
};

beforeEach(async () => {
    await page.evaluate((place) => {
        location.hash = '';
        location.hash = place;
    }, kPlace);
    await page.locator('#picture').focus();
    start = standOf(kPlace);
    await within(async () => (await settle()).link.get('eye'), /^-14.1,2.7,1.8$/);
});

/** Waits, while the page's clock goes on, until it is so. */
async function within(what: () => Promise<string | null>, wanted: RegExp): Promise<string> {
    for (let i = 0; i < 300; i += 1) {
        const found = (await what()) ?? '';
        if (wanted.test(found)) return found;
        await page.clock.runFor(60);
        await new Promise((resolve) => setTimeout(resolve, 10));
    }
    throw new Error(`${await what()} is not ${wanted}`);
}
/** What the page says of a voxel after this. */
async function spoken(act: () => Promise<void>): Promise<string> {
    await page.evaluate(() => (document.querySelector('#spoken')!.textContent = ''));
    await act();
    return within(() => page.locator('#spoken').textContent(), /Path/);
}
/** What octavo finds behind a point of the picture, pixels from its middle. */
function queried(x: number, y: number): { voxel: number[]; t: number } {
    const ray = [...start.eye, ...through(start, x + 0.5, y + 0.5, height)].join();
    return JSON.parse(execFileSync(command, ['query', courtyard(), '--json', `--ray=${ray}`]).toString());
}

const near = (a: Vec, b: Vec, within = 1e-3): void => expect(size(plus(a, b, -1)), `${a} and ${b}`).toBeLessThan(within);
const moved = (to: Stand): Vec => plus(to.eye, start.eye, -1);
/** Moves the eye along this and nothing else. */
const goes = (to: Stand, way: Vec, what: string): void => {
    const went = moved(to);
    expect(size(went), what).toBeGreaterThan(0.01);
    expect(dot(went, way) / size(went), what).toBeGreaterThan(0.9999);
    near(to.forward, start.forward, 1e-6);
};
const drag = async (x: number, y: number, button: 'left' | 'right' | 'middle'): Promise<Stand> => {
    await page.mouse.move(x0, y0);
    await page.mouse.down({ button });
    await page.mouse.move(x0 + x, y0 + y, { steps: 3 });
    await page.clock.runFor(20);
    await page.mouse.up({ button });
    return settle();
};

/** Turned about the target, with what is before it following a pointer that went right and down. */
const turnedWith = (to: Stand): void => {
    near(to.target, start.target);
    expect(to.distance).toBeCloseTo(start.distance, 4);
    const [x, y] = seenAt(to, plus(start.eye, start.forward, 0.6 * start.distance), height);
    expect(x).toBeGreaterThan(10);
    expect(y).toBeGreaterThan(5);
};
/** Moved so that the target went with the pointer by so many pixels. */
const pannedBy = (to: Stand, right: number, down: number): void => {
    near(to.forward, start.forward, 1e-6);
    const [x, y] = seenAt(to, start.target, height);
    expect(x).toBeCloseTo(right, 0);
    expect(y).toBeCloseTo(down, 0);
};

describe('a mouse', () => {
    it('turns about the target with its left button: what is before it follows', async () => {
        turnedWith(await drag(60, 30, 'left'));
    });
    it('pulls the scene along with its right button, or the middle one', async () => {
        pannedBy(await drag(60, 30, 'right'), 60, 30);
        start = await settle();
        pannedBy(await drag(-60, -30, 'middle'), -60, -30);
    });
    it('goes nearer and farther with its wheel, towards the target', async () => {
        await page.mouse.move(x0, y0);
        await page.mouse.wheel(0, -300);
        const nearer = await changed(start);
        expect(nearer.distance).toBeLessThan(0.8 * start.distance);
        near(nearer.target, start.target);
        goes(nearer, start.forward, 'wheel');
        await page.mouse.wheel(0, 300);
        const back = await changed(nearer);
        near(back.eye, start.eye, 1e-2);
    });
    it('reads the voxel that octavo query finds there', async () => {
        for (const [x, y] of [[60, 70], [-150, 40], [10, -60]] as const) {
            const said = await spoken(() => page.mouse.click(x0 + x, y0 + y));
            expect(said).toContain(`Path ${queried(x, y).voxel.join(', ')}.`);
        }
    });
    it('makes the voxel of a double click the target', async () => {
        const before = await spoken(() => page.mouse.click(x0 + 60, y0 + 70));
        await page.mouse.dblclick(x0 + 60, y0 + 70);
        const to = await changed(start);
        near(to.eye, start.eye, 1e-6);
        near(to.target, /Position ([^a-z]*)\. /.exec(before)![1]!.split(', ').map(Number) as Vec, 0.02);
        const after = await spoken(() => page.mouse.click(x0, y0));
        expect(/Path [\d, ]+/.exec(after), 'it is in the middle now').toEqual(/Path [\d, ]+/.exec(before));
    });
});

describe('keys', () => {
    it.each([
        ['ArrowLeft', [-1, 0]],
        ['ArrowRight', [1, 0]],
        ['ArrowUp', [0, 1]],
        ['ArrowDown', [0, -1]],
    ] as [string, [number, number]][])('%s takes the eye that way about the target, with Ctrl in a straight line', async (key, [right, up]) => {
        await page.keyboard.press(key);
        const turned = await settle();
        near(turned.target, start.target);
        const way = plus(plus([0, 0, 0], start.right, right), start.up, up);
        expect(dot(moved(turned), way)).toBeGreaterThan(0.5);
        start = turned;
        await page.keyboard.press(`Control+${key}`);
        goes(await settle(), plus(plus([0, 0, 0], start.right, right), start.up, up), `Ctrl + ${key}`);
    });
    it('+ and - go nearer and farther', async () => {
        await page.keyboard.press('+');
        const nearer = await settle();
        near(nearer.target, start.target);
        expect(nearer.distance).toBeLessThan(start.distance);
        await page.keyboard.press('-');
        expect((await settle()).distance).toBeCloseTo(start.distance, 3);
    });

    /** Holds a key for a time that the test measures out. */
    const fly = async (keys: string[], milliseconds = 320): Promise<Stand> => {
        await page.clock.runFor(20);
        for (const key of keys) await page.keyboard.down(key);
        await page.clock.runFor(milliseconds);
        for (const key of keys) await page.keyboard.up(key);
        return settle();
    };
    const kWays: [string, (from: Stand) => Vec][] = [
        ['w', ({ forward }) => forward],
        ['s', ({ forward }) => plus([0, 0, 0], forward, -1)],
        ['d', ({ right }) => right],
        ['a', ({ right }) => plus([0, 0, 0], right, -1)],
        ['e', ({ up }) => up],
        ['q', ({ up }) => plus([0, 0, 0], up, -1)],
    ];
    it.each(kWays)('%s flies its way', async (key, way) => {
        goes(await fly([key]), way(start), key);
    });
    it('fly five times as fast with Shift', async () => {
        const slow = size(moved(await fly(['w'])));
        start = await settle();
        const fast = size(moved(await fly(['Shift', 'w'])));
        expect(fast / slow).toBeGreaterThan(4);
        expect(fast / slow).toBeLessThan(6);
    });
    it('fly at the speed that the wheel sets, and leave the distance alone', async () => {
        const slow = size(moved(await fly(['d'])));
        await page.mouse.move(x0, y0);
        await page.keyboard.down('d');
        await page.mouse.wheel(0, -400);
        await within(() => page.locator('#toast').textContent(), /^Speed [\d.]+ units a second$/);
        await page.keyboard.up('d');
        start = await settle();
        const fast = await fly(['d']);
        expect(fast.distance).toBeCloseTo(start.distance, 4);
        expect(size(moved(fast)) / slow).toBeGreaterThan(1.7);
        await page.keyboard.down('d');
        await page.mouse.wheel(0, 400); // as it was, for those who come after
        await page.clock.runFor(20);
        await page.keyboard.up('d');
    });
    it('fly and look around: what is dragged turns the eye where it is', async () => {
        await page.mouse.move(x0, y0);
        await page.mouse.down();
        await page.keyboard.down('w');
        await page.mouse.move(x0 + 60, y0, { steps: 3 });
        const to = await settle();
        await page.keyboard.up('w');
        await page.mouse.up();
        expect(dot(to.forward, start.right)).toBeGreaterThan(0.05);
        expect(size(moved(to)), 'not swung about the target').toBeLessThan(0.5);
    });
    it('Enter reads the voxel in the middle, under a cross, and says it; Shift + Enter turns about it', async () => {
        await page.locator('#picture').evaluate((canvas) => canvas.blur());
        await page.locator('#picture').focus();
        expect(await page.locator('#cross').isVisible()).toBe(false);
        const found = queried(0, 0);
        expect(await spoken(() => page.keyboard.press('Enter'))).toContain(`Path ${found.voxel.join(', ')}.`);
        const cross = (await page.locator('#cross').boundingBox())!;
        expect([cross.x + cross.width / 2, cross.y + cross.height / 2]).toEqual([x0, y0]);
        await page.keyboard.press('Shift+Enter');
        const to = await changed(start);
        expect(Math.abs(to.distance - found.t)).toBeLessThan(1);
        near(to.eye, start.eye, 1e-6);
        await page.mouse.click(x0 + 40, y0 + 40);
        expect(await page.locator('#cross').isVisible(), 'a pointer needs none').toBe(false);
    });
});

describe('fingers', () => {
    type Point = [number, number];
    const put = (type: 'touchStart' | 'touchMove' | 'touchEnd', ...points: Point[]): Promise<unknown> =>
        touch.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x: x0 + x, y: y0 + y, id })) });
    /** From one place to another, in steps, one finger or two. */
    const slide = async (from: Point[], to: Point[]): Promise<Stand> => {
        await put('touchStart', from[0]!);
        if (from.length > 1) await put('touchStart', ...from);
        for (let step = 1; step <= 4; step += 1) {
            await put('touchMove', ...from.map((point, i): Point => point.map((value, axis) => value + (step / 4) * (to[i]![axis]! - value)) as Point));
            await page.clock.runFor(20);
        }
        await put('touchEnd');
        return settle();
    };
    it('turn about the target, where it is one', async () => {
        turnedWith(await slide([[0, 0]], [[60, 30]]));
    });
    it('pull the scene along, where they are two that stay apart', async () => {
        pannedBy(await slide([[-50, 0], [50, 0]], [[-10, 30], [90, 30]]), 40, 30);
    });
    it('go nearer, where two part, by as much', async () => {
        const to = await slide([[-50, 0], [50, 0]], [[-100, 0], [100, 0]]);
        expect(to.distance / start.distance).toBeCloseTo(0.5, 2);
        near(to.target, start.target, 0.1);
        near(to.forward, start.forward, 1e-6);
    });
});
