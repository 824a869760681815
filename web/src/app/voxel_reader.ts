// SPDX-License-Identifier: MIT
//
// Reads the voxel at a point of the picture, and turns the camera about it: where the pointer is, or
// in the middle, which a cross marks for those who use keys. What is found is shown and spoken.
import type { Painter, View } from '../painters/painter';
import { byId, fillFacts } from '../ui/dom';
import { say, toast } from '../ui/messages';
import { type FoundCell, centreOf, shortFacts, spokenFacts, voxelFacts } from '../ui/voxel_facts';
import { type Camera, anglesOf, clampElevation } from '../view/camera';
import { length, sub } from '../view/vec';

export interface VoxelHost {
    canvas: HTMLCanvasElement;
    view(): View | undefined;
    painter(): Painter | undefined;
    moveTo(camera: Camera): void;
}

export class VoxelReader {
    constructor(private readonly host: VoxelHost) {
        const hide = (): void => this.showCross(false);
        host.canvas.addEventListener('pointerdown', hide);
        host.canvas.addEventListener('blur', hide);
    }

    /** Shows what is there. @param x  CSS pixels of the canvas, as `y` */
    async read(x: number, y: number): Promise<void> {
        this.show(await this.find(x, y));
    }

    /** Turns about what is there from now on. */
    async focus(x: number, y: number): Promise<void> {
        const found = await this.find(x, y);
        const view = this.host.view();
        if (found && view) {
            // The eye stays, so that nothing comes between.
            const { camera, axes, scene } = view;
            const way = sub(centreOf(found, scene.metadata.grid), camera.eye);
            const { azimuth, elevation } = anglesOf(axes, way);
            this.host.moveTo({ ...camera, azimuth, elevation: clampElevation(elevation), distance: length(way) });
        }
        this.show(found);
    }

    readMiddle(): void {
        this.showCross(true);
        void this.read(...this.middle);
    }

    focusMiddle(): void {
        this.showCross(true);
        void this.focus(...this.middle);
    }

    private get middle(): [number, number] {
        return [this.host.canvas.clientWidth / 2, this.host.canvas.clientHeight / 2];
    }

    private async find(x: number, y: number): Promise<FoundCell | undefined> {
        const { canvas } = this.host;
        const toPixels = canvas.width / canvas.clientWidth;
        const view = this.host.view();
        return view && this.host.painter()?.pick(view, x * toPixels, y * toPixels);
    }

    private show(found: FoundCell | undefined): void {
        byId('voxel').hidden = !found;
        const view = this.host.view();
        if (!found || !view) return say('No voxel there');
        const facts = voxelFacts(found, view.scene.metadata.grid, view.camera.eye);
        fillFacts(byId('voxel-facts'), facts);
        byId('voxel').scrollIntoView({ block: 'nearest' });
        say(spokenFacts(facts));
        // The panel may be closed, as it is on a phone.
        if (byId('panel').classList.contains('closed')) toast(shortFacts(facts), 5000);
    }

    private showCross(shown: boolean): void {
        byId('cross').hidden = !shown;
    }
}
