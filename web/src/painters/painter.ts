// SPDX-License-Identifier: MIT
import type { Scene } from '../app/scene';
import type { FoundCell } from '../ui/voxel_facts';
import type { Axes, Camera } from '../view/camera';
import type { Settings } from '../view/settings';

/** One picture that is asked for: of what, from where, and how. */
export interface View {
    scene: Scene;
    camera: Camera;
    settings: Settings;
    axes: Axes;
}

/** Draws one view after the other: this machine's GPU does, or another machine. */
export interface Painter {
    /** The newest view counts. */
    show(view: View): void;
    /** The view that is shown, with another exposure. */
    showAgain(view: View): void;
    /** The canvas has another size: what is there is shown in it until there is better. */
    fill(): void;
    /** What is behind a point of the canvas, in its pixels. */
    pick(view: View, x: number, y: number): Promise<FoundCell | undefined>;
    picture(): Promise<Blob | undefined>;
    /** Has everything been drawn that will be? */
    readonly finished: boolean;
    /** How often the picture has been made better. */
    readonly samples: number;
    facts(): [string, string][];
}
