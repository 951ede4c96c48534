// Bundles the page into ../assets: index.html, app.js, app.css, and licences.txt of what is in app.js and app.css.
// The same sources and packages give the same bytes.

import { copyFile, mkdir, readFile, readdir, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const assets = join(here, "..", "assets");
// What a package has bundled into itself already.
const EMBEDDED = { "@foxglove/rosmsg": ["md5-typescript", "moo", "nearley"] };
const LICENCES = "The licences of the libraries in this file are in licences.txt beside it.";

const options = {
  absWorkingDir: here,
  bundle: true,
  minify: true,
  charset: "utf8",
  legalComments: "eof",
  metafile: true,
  target: ["chrome111", "firefox115", "safari16.4"],
};

// `import text from "worker:FILE"`: the bundle of src/FILE as text, for a worker made of a blob.
const workers = {
  name: "workers",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^worker:/ }, ({ path }) => ({ path: path.slice("worker:".length), namespace: "worker" }));
    onLoad({ filter: /.*/, namespace: "worker" }, async ({ path }) => {
      const { outputFiles } = await build({ ...options, entryPoints: [join("src", path)], format: "iife", write: false });
      return { contents: outputFiles[0].text, loader: "text" };
    });
  },
};

await mkdir(assets, { recursive: true });
const script = await build({
  ...options,
  entryPoints: ["src/main.js"],
  outfile: join(assets, "app.js"),
  format: "esm",
  plugins: [workers],
  banner: { js: `/* ${LICENCES} */` },
});
const style = await build({
  ...options,
  entryPoints: ["src/style.css"],
  outfile: join(assets, "app.css"),
  banner: { css: `/* ${LICENCES} */` },
});
await copyFile(join(here, "src", "index.html"), join(assets, "index.html"));
await writeFile(join(assets, "licences.txt"), await licences([script, style]));

// The licence of each package of which the bundles hold something.
async function licences(results) {
  const direct = results.flatMap(({ metafile }) => Object.values(metafile.outputs).flatMap(packagesOf));
  const packages = new Set(direct.flatMap((name) => [name, ...(EMBEDDED[name] ?? [])]));
  const texts = await Promise.all([...packages].sort().map(licenceOf));
  return `app.js and app.css contain parts of these packages.\n\n${texts.join("\n")}`;
}

function packagesOf({ inputs }) {
  const used = Object.entries(inputs).filter(([, { bytesInOutput }]) => bytesInOutput > 0);
  return used.map(([path]) => path.match(/node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1]).filter(Boolean);
}

async function licenceOf(name) {
  const folder = join(here, "node_modules", name);
  const { version, license } = JSON.parse(await readFile(join(folder, "package.json"), "utf8"));
  const file = (await readdir(folder)).find((entry) => /^licen[cs]e/i.test(entry));
  if (!file) throw new Error(`${name} has no licence text`);
  const text = (await readFile(join(folder, file), "utf8")).replace(/\r\n/g, "\n").trim();
  const title = `${name} ${version} (${license})`;
  return `${title}\n${"=".repeat(title.length)}\n\n${text}\n`;
}
