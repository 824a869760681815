// SPDX-License-Identifier: MIT
import type { Offers } from '../ui/panel';
import { diagonalOf } from '../view/camera';
import { kAllLights, usableLights } from '../view/lights';
import { type Settings, kModes } from '../view/settings';
import { type Scene, hasColors, hasStoredLight } from './scene';

/**
 * What there is to choose from.
 *
 * @param drawnHere  by this machine's GPU, which shows colours and light once they are there
 */
export function offersFor(scene: Scene | undefined, settings: Settings, drawnHere: boolean): Offers {
    const metadata = scene?.metadata;
    const usable = metadata ? usableLights(metadata) : [];
    const chosen = usable.includes(settings.light) ? metadata!.lights[settings.light] : undefined;
    return {
        modes: kModes.filter((mode) => mode !== 'color' || (scene !== undefined && hasColors(scene, drawnHere))),
        cameras: metadata?.cameras.map((camera, i) => camera.name || `Camera ${i + 1}`) ?? [],
        lights: usable.map((number) => ({ number, name: metadata!.lights[number]!.name || `Light ${number + 1}` })),
        depth: metadata?.grid.depth ?? 17,
        sceneDiagonal: scene?.box ? diagonalOf(scene.box) : 0,
        storedLight: scene !== undefined && hasStoredLight(scene, drawnHere),
        sunLight: settings.light !== kAllLights && (!chosen || chosen.kind === 'sun'),
        drawnHere,
    };
}
