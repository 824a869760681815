// SPDX-License-Identifier: MIT
//
// Light or dark: what was chosen last, else what the system says.
const kKey = 'octavo-theme';

function rememberedTheme(): string {
    let stored: string | null = null;
    try {
        stored = localStorage.getItem(kKey);
    } catch {
        // As if it had none.
    }
    if (stored === 'light' || stored === 'dark') return stored;
    return matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
}

export function startTheme(): void {
    document.documentElement.dataset.theme = rememberedTheme();
}

export function otherTheme(): void {
    const theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    document.documentElement.dataset.theme = theme;
    try {
        localStorage.setItem(kKey, theme);
    } catch {
        // A page without storage follows the system next time.
    }
}
