// Bundles the page into dist/: index.html and assets/, nothing fetched from elsewhere.
import { build, context } from "esbuild";
import { cp, mkdir, readdir, rm, stat } from "node:fs/promises";

const watch = process.argv.includes("--watch");
const options = {
  entryPoints: { nacre: "src/main.tsx" },
  outdir: "dist/assets",
  bundle: true,
  format: "esm",
  target: "es2020",
  minify: !watch,
  sourcemap: watch ? "inline" : false,
  jsx: "automatic",
  jsxImportSource: "preact",
  legalComments: "none",
  logLevel: "warning",
};

await rm("dist", { recursive: true, force: true });
await mkdir("dist/assets", { recursive: true });
await cp("index.html", "dist/index.html");
await cp("licences.txt", "dist/assets/licences.txt");
if (watch) {
  await (await context(options)).watch();
} else {
  await build(options);
  for (const name of await readdir("dist/assets"))
    console.log(`dist/assets/${name}  ${Math.round((await stat(`dist/assets/${name}`)).size / 1024)} kB`);
}
