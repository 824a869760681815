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
    readMiddle(): void;
    focusMiddle(): void;
    speedChanged(unitsPerSecond: number): void;
}

const kTurn = 0.0055; // radians a pixel
const kKeyTurn = 0.06;
const kClickSlop = 4; // pixels
const kFast = 5;
const kFlyKeys = ['KeyW', 'KeyA', 'KeyS', 'KeyD', 'KeyQ', 'KeyE'];

interface Place {
    x: number;
    y: number;
}
/** How two fingers lie. */
interface Spread {
    middle: Place;
    distance: number;
}
const spreadOf = ([a, b]: [Place, Place]): Spread => ({
    middle: { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 },
    distance: Math.max(1, Math.hypot(a.x - b.x, a.y - b.y)),
});

export class Controls {
    private readonly pointers = new Map<number, Place>();
    /** Two fingers and what they began with: the camera goes with them from there, so that no error adds up. */
    private pinch: { camera: Camera; fingers: [Place, Place]; from: Spread } | undefined;
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
            this.beginPinch();
        }
        this.element.classList.add('turning');
    };

    private readonly onPointerMove = (event: PointerEvent): void => {
        const at = this.pointers.get(event.pointerId);
        const camera = this.host.camera();
        if (!at || !camera) return;
        const x = event.clientX - at.x;
        const y = event.clientY - at.y;
        at.x = event.clientX;
        at.y = event.clientY;
        this.travelled += Math.hypot(x, y);
        if (this.pinch) return this.goWithFingers(this.pinch);
        if (this.travelled < kClickSlop) return;
        if (this.button === 2 || this.button === 1 || event.ctrlKey) this.pan(camera, x, y);
        else if (this.held.size > 0) this.look(camera, x, y);
        else this.host.moveTo(orbited(camera, this.host.axes(), -kTurn * x, -kTurn * y));
    };

    private beginPinch(): void {
        const camera = this.host.camera();
        const [first, second] = [...this.pointers.values()];
        this.pinch = camera && first && second ? { camera, fingers: [first, second], from: spreadOf([first, second]) } : undefined;
    }

    private goWithFingers({ camera, fingers, from }: NonNullable<typeof this.pinch>): void {
        const to = spreadOf(fingers);
        const nearer = dollied(camera, this.host.axes(), from.distance / to.distance, this.host.voxelSize());
        this.pan(nearer, to.middle.x - from.middle.x, to.middle.y - from.middle.y);
    }

    private readonly onPointerEnd = (event: PointerEvent): void => {
        if (!this.pointers.delete(event.pointerId)) return;
        this.beginPinch();
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
        else if (event.key === 'Enter' && event.shiftKey) this.host.focusMiddle();
        else if (event.key === 'Enter') this.host.readMiddle();
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
