// SPDX-License-Identifier: MIT
import { toast } from './messages';

const kDelay = 300; // milliseconds behind the last change

/** Keeps the fragment of the page's address that of what is shown. */
export class Address {
    private timer = 0;

    constructor(private readonly fragment: () => string) {}

    follow(): void {
        clearTimeout(this.timer);
        this.timer = window.setTimeout(() => this.set(), kDelay);
    }

    async copy(): Promise<void> {
        try {
            await navigator.clipboard.writeText(this.set());
            toast('The link is on the clipboard');
        } catch {
            toast("The link is in the browser's address bar");
        }
    }

    private set(): string {
        const link = `${location.href.split('#')[0]}#${this.fragment()}`;
        history.replaceState(null, '', link);
        return link;
    }
}
