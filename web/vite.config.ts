import { createHash } from 'node:crypto';
import { resolve } from 'node:path';
import type { Plugin } from 'vite';
import { defineConfig } from 'vitest/config';

/**
 * Makes the page one file, so that it can be embedded, mailed and opened from a disk: script and
 * style go inside, and a policy that admits these and nothing else.
 */
function oneFile(): Plugin {
    const hash = (text: string): string => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
    return {
        name: 'one-file',
        enforce: 'post',
        apply: 'build',
        generateBundle(_, bundle) {
            let html = '';
            let script = '';
            let style = '';
            for (const [name, output] of Object.entries(bundle)) {
                if (name.endsWith('.html') && output.type === 'asset') html = String(output.source);
                if (output.type === 'chunk') script += output.code;
                if (name.endsWith('.css') && output.type === 'asset') style += String(output.source);
                delete bundle[name];
            }
            script = script.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');
            const policy = [
                "default-src 'none'",
                `script-src ${hash(script)} 'wasm-unsafe-eval'`,
                `style-src ${hash(style)}`,
                "connect-src 'self' data: blob:",
                "img-src 'self' blob: data:",
                'worker-src blob: data:',
                "base-uri 'none'",
                "form-action 'none'",
            ].join('; ');
            html = html
                .replace(/\s*<script type="module"[^>]*><\/script>/, '')
                .replace(/\s*<link rel="stylesheet"[^>]*>/, '')
                .replace('<meta charset="utf-8" />', () => `<meta charset="utf-8" />\n    <meta http-equiv="Content-Security-Policy" content="${policy}" />`)
                .replace('</head>', () => `<style>${style}</style>\n  </head>`)
                .replace('</body>', () => `<script type="module">${script}</script>\n  </body>`);
            this.emitFile({ type: 'asset', fileName: 'index.html', source: html });
        },
    };
}

export default defineConfig({
    base: './',
    plugins: [oneFile()],
    server: { fs: { allow: [resolve(__dirname, '..')] } },
    worker: { format: 'iife' },
    build: {
        target: 'es2022',
        modulePreload: false,
        cssCodeSplit: false,
        assetsInlineLimit: Infinity,
        chunkSizeWarningLimit: 4096,
    },
    test: { testTimeout: 120000, hookTimeout: 120000, expect: { poll: { timeout: 10000 } } },
});
