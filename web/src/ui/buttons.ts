// SPDX-License-Identifier: MIT
//
// The bar's buttons, their keys, and files that are chosen or dropped.
import { byId } from './dom';
import { hideNotice } from './messages';
import { otherTheme } from './theme';

export interface Actions {
    frameAll(): void;
    savePicture(): void;
    copyLink(): void;
    open(name: string, file: Blob): void;
    /** The n-th of what the picture can show. @returns whether there is one */
    chooseMode(index: number): boolean;
}

const kKeys: Record<string, string> = { f: 'frame-all', p: 'screenshot', c: 'copy-link', o: 'open-file', h: 'help' };

export function bindButtons(actions: Actions): void {
    const chooseFile = (): void => byId<HTMLInputElement>('file').click();
    const buttons: Record<string, () => void> = {
        'frame-all': () => actions.frameAll(),
        screenshot: () => actions.savePicture(),
        'copy-link': () => actions.copyLink(),
        'open-file': chooseFile,
        theme: otherTheme,
        help: showHelp,
        'toggle-panel': () => togglePanel(),
        'notice-open': chooseFile,
        'notice-close': hideNotice,
    };
    for (const [id, action] of Object.entries(buttons)) byId(id).addEventListener('click', action);
    byId<HTMLInputElement>('file').addEventListener('change', (event) => {
        const input = event.target as HTMLInputElement;
        const file = input.files?.[0];
        input.value = '';
        if (file) actions.open(file.name, file);
    });
    window.addEventListener('keydown', (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
        if (event.target instanceof HTMLElement && event.target.matches('input[type=number], select')) return;
        const dialog = byId<HTMLDialogElement>('help-dialog');
        if (dialog.open) {
            if (event.key.toLowerCase() === 'h') dialog.close();
            return;
        }
        const button = kKeys[event.key.toLowerCase()];
        if (button) buttons[button]!();
        else if (!actions.chooseMode(Number(event.key) - 1)) return;
        event.preventDefault();
    });
}

/** From its beginning, though its button at the end has the focus. */
function showHelp(): void {
    const dialog = byId<HTMLDialogElement>('help-dialog');
    dialog.showModal();
    dialog.scrollTop = 0;
}

export function bindDropping(open: Actions['open']): void {
    const drop = byId('drop');
    const show = (event: DragEvent, shown: boolean): void => {
        event.preventDefault();
        drop.hidden = !shown;
    };
    window.addEventListener('dragover', (event) => show(event, true));
    window.addEventListener('dragleave', (event) => show(event, event.relatedTarget !== null));
    window.addEventListener('drop', (event) => {
        show(event, false);
        const file = event.dataTransfer?.files[0];
        if (file) open(file.name, file);
    });
}

export function togglePanel(open = byId('panel').classList.contains('closed')): void {
    byId('panel').classList.toggle('closed', !open);
    byId('toggle-panel').setAttribute('aria-expanded', String(open));
}

/** Gives a picture to the user. */
export function download(blob: Blob, name: string): void {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
