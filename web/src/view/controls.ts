// SPDX-License-Identifier: MIT
//
// Mouse, touch and keys over the picture, as changes of a camera.
import { type Axes, type Camera, clampElevation, dollied, moved, orbited } from './camera';

export interface ControlsHost {
    camera(): Camera | undefined;
    axes(): Axes;
    /** World units: of the scene, to scale speeds by, and of a voxel. */
    sceneSize(): number;
    voxelSize(): number;
    moveTo(camera: Camera): void;
    click(x: number, y: number): void; // CSS pixels of the picture
    doubleClick(x: number, y: number): void;
    speedChanged(unitsPerSecond: number): void;
}

const kTurn = 0.0055; // radians a pixel
const kKeyTurn = 0.06;
const kClickSlop = 4; // pixels
const kFast = 5;
const kFlyKeys = ['KeyW', 'KeyA', 'KeyS', 'KeyD', 'KeyQ', 'KeyE'];

export class Controls {
    private readonly pointers = new Map<number, { x: number; y: number }>();
    private readonly held = new Set<string>();
    private fast = false;
    private button = 0;
    private travelled = 0;
    private speed = 0.2; // of the scene's size, a second
    private flying = 0;
    private lastFlight = 0;

    constructor(
        private readonly element: HTMLElement,
        private readonly host: ControlsHost,
    ) {
        element.addEventListener('pointerdown', this.onPointerDown);
        element.addEventListener('pointermove', this.onPointerMove);
        element.addEventListener('pointerup', this.onPointerEnd);
        element.addEventListener('pointercancel', this.onPointerEnd);
        element.addEventListener('wheel', this.onWheel, { passive: false });
        element.addEventListener('contextmenu', (event) => event.preventDefault());
        element.addEventListener('dblclick', (event) => host.doubleClick(event.offsetX, event.offsetY));
        element.addEventListener('keydown', this.onArrows);
        element.addEventListener('blur', () => element.classList.remove('pointed'));
        window.addEventListener('keydown', this.onKeyDown);
        window.addEventListener('keyup', this.onKeyUp);
        window.addEventListener('blur', () => this.held.clear());
    }

    private readonly onPointerDown = (event: PointerEvent): void => {
        this.element.setPointerCapture(event.pointerId);
        this.element.classList.add('pointed'); // the keys go there, and no frame need say so
        this.element.focus({ preventScroll: true });
        this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        if (this.pointers.size === 1) {
            this.button = event.button;
            this.travelled = 0;
        } else {
            this.travelled = Infinity;
        }
        this.element.classList.add('turning');
    };

    private readonly onPointerMove = (event: PointerEvent): void => {
        const before = this.pointers.get(event.pointerId);
        const camera = this.host.camera();
        if (!before || !camera) return;
        const x = event.clientX - before.x;
        const y = event.clientY - before.y;
        this.travelled += Math.hypot(x, y);
        if (this.pointers.size === 1) {
            before.x = event.clientX;
            before.y = event.clientY;
            if (this.travelled < kClickSlop) return;
            if (this.button === 2 || this.button === 1 || event.ctrlKey) this.pan(camera, x, y);
            else if (this.held.size > 0) this.look(camera, x, y);
            else this.host.moveTo(orbited(camera, this.host.axes(), -kTurn * x, -kTurn * y));
            return;
        }
        this.moveFingers(camera, before, event);
    };

    private moveFingers(camera: Camera, before: { x: number; y: number }, event: PointerEvent): void {
        const other = [...this.pointers].find(([id]) => id !== event.pointerId)![1];
        const distance = Math.hypot(before.x - other.x, before.y - other.y);
        const middle = { x: (before.x + other.x) / 2, y: (before.y + other.y) / 2 };
        before.x = event.clientX;
        before.y = event.clientY;
        const next = Math.hypot(before.x - other.x, before.y - other.y);
        const pinched = dollied(camera, this.host.axes(), distance / Math.max(1, next), this.host.voxelSize());
        this.pan(pinched, (before.x + other.x) / 2 - middle.x, (before.y + other.y) / 2 - middle.y);
    }

    private readonly onPointerEnd = (event: PointerEvent): void => {
        if (!this.pointers.delete(event.pointerId)) return;
        if (this.pointers.size === 0) this.element.classList.remove('turning');
        if (event.type === 'pointerup' && this.button === 0 && this.travelled < kClickSlop) {
            this.host.click(event.offsetX, event.offsetY);
        }
    };

    /** The scene follows the pointer, at the depth of the target. */
    private pan(camera: Camera, x: number, y: number): void {
        const unit = (2 * Math.tan(0.5 * camera.verticalFov) * camera.distance) / this.element.clientHeight;
        this.host.moveTo(moved(camera, this.host.axes(), -x * unit, y * unit, 0));
    }

    private look(camera: Camera, x: number, y: number): void {
        this.host.moveTo({
            ...camera,
            azimuth: camera.azimuth - 0.6 * kTurn * x,
            elevation: clampElevation(camera.elevation - 0.6 * kTurn * y),
        });
    }

    private readonly onWheel = (event: WheelEvent): void => {
        event.preventDefault();
        const camera = this.host.camera();
        if (!camera) return;
        const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : event.deltaMode === WheelEvent.DOM_DELTA_PAGE ? 400 : 1;
        const turned = Math.max(-400, Math.min(400, event.deltaY * lines));
        if (this.held.size > 0) {
            this.speed = Math.max(1e-4, Math.min(10, this.speed * Math.exp(-0.002 * turned)));
            this.host.speedChanged(this.speed * this.host.sceneSize());
            return;
        }
        const rate = event.ctrlKey ? 0.01 : 0.0015; // a pinch on a touchpad comes as a wheel with Ctrl
        this.host.moveTo(dollied(camera, this.host.axes(), Math.exp(rate * turned), this.host.voxelSize()));
    };

    private readonly onArrows = (event: KeyboardEvent): void => {
        const camera = this.host.camera();
        if (!camera || event.altKey || event.metaKey) return;
        const ways: Record<string, [number, number]> = {
            ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
        };
        const way = ways[event.key];
        const axes = this.host.axes();
        if (way && event.ctrlKey) this.pan(camera, -40 * way[0], 40 * way[1]);
        else if (way) this.host.moveTo(orbited(camera, axes, kKeyTurn * way[0], -kKeyTurn * way[1]));
        else if (event.key === '+' || event.key === '=') this.host.moveTo(dollied(camera, axes, 0.9, this.host.voxelSize()));
        else if (event.key === '-') this.host.moveTo(dollied(camera, axes, 1 / 0.9, this.host.voxelSize()));
        else if (event.key === 'Enter') this.host.click(this.element.clientWidth / 2, this.element.clientHeight / 2);
        else return;
        event.preventDefault();
    };

    private readonly onKeyDown = (event: KeyboardEvent): void => {
        this.fast = event.shiftKey;
        const typing = event.target instanceof HTMLElement && event.target.matches('input[type=number], select, dialog *');
        if (typing || event.ctrlKey || event.metaKey || event.altKey || !kFlyKeys.includes(event.code)) return;
        this.held.add(event.code);
        if (this.flying === 0) {
            this.lastFlight = performance.now();
            this.flying = requestAnimationFrame(this.fly);
        }
    };

    private readonly onKeyUp = (event: KeyboardEvent): void => {
        this.fast = event.shiftKey;
        this.held.delete(event.code);
    };

    private readonly fly = (): void => {
        this.flying = 0;
        const camera = this.host.camera();
        if (this.held.size === 0 || !camera) return;
        const now = performance.now();
        const seconds = Math.min(0.1, (now - this.lastFlight) / 1000);
        this.lastFlight = now;
        const step = this.speed * this.host.sceneSize() * seconds * (this.fast ? kFast : 1);
        const along = (forwards: string, back: string): number =>
            step * (Number(this.held.has(forwards)) - Number(this.held.has(back)));
        this.host.moveTo(moved(camera, this.host.axes(), along('KeyD', 'KeyA'), along('KeyE', 'KeyQ'), along('KeyW', 'KeyS')));
        this.flying = requestAnimationFrame(this.fly);
    };
}
