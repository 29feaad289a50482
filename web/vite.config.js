import { defineConfig } from "vite";

// Names without hashes, since the program embeds the files by name; nothing inlined, since the
// service's content security policy forbids it.
export default defineConfig({
  build: {
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 900,
    modulePreload: { polyfill: false },
    rollupOptions: {
      output: { entryFileNames: "assets/page.js", assetFileNames: "assets/page[extname]" },
    },
  },
  server: { proxy: { "/v1": "http://127.0.0.1:8080", "/v2": "http://127.0.0.1:8080" } },
});
