// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { FrameSplitter } from '../../src/painters/frame_splitter';
import { type Camera, anglesOf, axesOf, cameraUniforms, defaultCamera, directionAt, dollied, forwardOf, framing, orbited, targetOf } from '../../src/view/camera';
import { linkOf, readLink } from '../../src/view/link';
import { kDefaults } from '../../src/view/settings';
import { type Vec3, length, sub } from '../../src/view/vec';

const y = axesOf('y');
const camera: Camera = { eye: [4.25, -2.5, 1e3 / 3], azimuth: 2.1, elevation: -0.4, distance: 12.5, verticalFov: 0.8 };

describe('links', () => {
    it('bring back camera and settings', () => {
        const settings = { ...kDefaults, mode: 'levels' as const, shadows: 'hard' as const, ambient: false, smooth: false, up: 'z' as const, sunAzimuth: -33, exposure: -1.5, finestLevel: 7 };
        const view = readLink(`#${linkOf(camera, settings)}`);
        expect({ ...kDefaults, ...view.settings }).toEqual(settings);
        expect(length(sub(view.camera!.eye, camera.eye))).toBeLessThan(1e-6);
        expect(view.camera!.azimuth).toBeCloseTo(camera.azimuth, 6);
        expect(view.camera!.elevation).toBeCloseTo(camera.elevation, 6);
        expect(view.camera!.verticalFov).toBeCloseTo(camera.verticalFov, 6);
    });
    it('say nothing about defaults', () => {
        expect(linkOf(undefined, kDefaults)).toBe('');
    });
    it.each(['', '#', '#%', '#eye=1,2&look=0,0,1', '#eye=1,2,x&look=0,0,1', '#eye=1,2,3&look=0,0,-1', '#mode=no&exposure=&sun=NaN', '#eye=1,2,3&look=0,0,Infinity'])(
        'take nothing from %s',
        (fragment) => {
            expect(readLink(fragment)).toEqual({ settings: {} });
        },
    );
    it('keep settings in their ranges', () => {
        expect(readLink('#exposure=99&detail=-5&level=3.4').settings).toEqual({ exposure: 4, detail: 0, finestLevel: 3 });
    });
});

describe('cameras', () => {
    it('turn about their target at the same distance', () => {
        const turned = orbited(camera, y, 0.7, 0.2);
        expect(length(sub(targetOf(turned, y), targetOf(camera, y)))).toBeLessThan(1e-9);
        expect(length(sub(turned.eye, targetOf(camera, y)))).toBeCloseTo(camera.distance, 9);
    });
    it('come no nearer than a voxel', () => {
        expect(dollied(camera, y, 1e-9, 0.1).distance).toBe(0.1);
    });
    it('have the angles of their direction, whichever way is up', () => {
        for (const axes of [y, axesOf('z')]) {
            const { azimuth, elevation } = anglesOf(axes, directionAt(axes, 2.1, -0.4));
            expect([azimuth, elevation]).toEqual([expect.closeTo(2.1, 9), expect.closeTo(-0.4, 9)]);
        }
    });
    it.each([1, 0.7, 0.5])('see the whole box from every side in the %d of the width that is clear', (clear) => {
        const box = { low: [0, 0, 0] as Vec3, high: [10, 4, 6] as Vec3 };
        const grid = { origin: [0, 0, 0] as Vec3, voxelSize: 1, depth: 4 };
        const frame = { aspect: 1.5, clear };
        const sides: Vec3[] = [[1, 0, 0], [-1, 0.1, 0.2], [0, 0.2, 1], [0.3, -0.4, -1], [0.1, 1, 0]];
        for (const seen of [defaultCamera(box, y, frame), ...sides.map((side) => framing(box, y, frame, side, 0.9))]) {
            const view = cameraUniforms(seen, y, grid, 300, 200);
            let [widest, highest] = [0, 0];
            for (let i = 0; i < 8; i += 1) {
                const corner = [0, 1, 2].map((axis) => ((i >> axis) & 1 ? box.high : box.low)[axis]!);
                const way = corner.map((value, axis) => value - view.cell[axis]! - view.frac[axis]!);
                const along = (v: number[]): number => way.reduce((sum, value, axis) => sum + value * v[axis]!, 0);
                const depth = along(view.forward);
                const [x, down] = [view.right, view.down].map((v) => along(v) / view.pitch ** 2 / depth) as [number, number];
                expect(depth).toBeGreaterThan(0);
                expect(x).toBeGreaterThan(-150);
                expect(x).toBeLessThan(300 * clear - 150);
                expect(Math.abs(down)).toBeLessThan(100);
                widest = Math.max(widest, x + 150, 300 * clear - x - 150);
                highest = Math.max(highest, Math.abs(down));
            }
            // No farther away than need be: some corner is near the frame.
            expect(Math.max(widest / (300 * clear), highest / 100)).toBeGreaterThan(0.9);
        }
    });
    it('stay exact far from the grid', () => {
        const grid = { origin: [1e6, 0, 0] as [number, number, number], voxelSize: 0.001, depth: 17 };
        const view = cameraUniforms({ ...camera, eye: [1e6 + 3.0005, 1, 1] }, y, grid, 300, 200);
        expect(view.cell[0]).toBe(3000);
        expect(view.frac[0]).toBeCloseTo(0.5, 3);
        const far = cameraUniforms({ ...camera, eye: [-1e9, 0, 0], azimuth: Math.PI / 2, elevation: 0 }, y, grid, 300, 200);
        expect(far.before).toBeGreaterThan(0);
        expect(far.cell.every((value) => Math.abs(value) < 2 ** 30)).toBe(true);
    });
    it('look along their forward direction', () => {
        expect(forwardOf({ ...camera, azimuth: 0, elevation: 0 }, y)).toEqual([0, 0, 1]);
    });
});

describe('frames of another machine', () => {
    it('are found however the bytes are cut', () => {
        const stream = new Uint8Array([3, 0, 0, 0, 7, 8, 9, 0, 0, 0, 0, 1, 0, 0, 0, 5]);
        for (let cut = 1; cut < stream.length; cut += 1) {
            const splitter = new FrameSplitter();
            const frames = [];
            for (let at = 0; at < stream.length; at += cut) frames.push(...splitter.add(stream.subarray(at, at + cut)));
            expect(frames.map((frame) => [...frame])).toEqual([[7, 8, 9], [], [5]]);
        }
    });
});
