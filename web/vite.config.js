import { defineConfig } from "vite";

// For `vite` and `vite preview`: where a service runs.
// It is asked under the page's own host, or it would take the page for a foreign one.
const service = {
  target: process.env.TRIVET_SERVICE ?? "http://127.0.0.1:8080",
  changeOrigin: false,
};

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
  worker: { format: "es", rollupOptions: { output: { entryFileNames: "assets/[name].js" } } },
  server: { proxy: { "/v1": service, "/v2": service } },
});
