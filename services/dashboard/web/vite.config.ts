import { defineConfig } from "vite";

export default defineConfig({
  build: {
    outDir: "../wayline_dashboard/static",
    emptyOutDir: true,
    target: "es2022",
    // an inlined file would be a data: address, which the Content-Security-Policy forbids
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1500,
  },
  server: {
    proxy: {
      "/v1": { target: "http://127.0.0.1:8000", ws: true },
    },
  },
});
