// The browser of the tests: Debian's Chromium without a window, and what they ask of a page.

import { existsSync, mkdirSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const PROGRAM = process.env.CHROMIUM ?? "/usr/bin/chromium";
// WebGL on the CPU; no sandbox, as tests may run as root in a container.
const FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const SCREENSHOTS = fileURLToPath(new URL("../../../../target/page-screenshots/", import.meta.url));

/** Why tests that need the browser are not run; false where it is there. */
export const missing = existsSync(PROGRAM) ? false : `not run: there is no ${PROGRAM} (apt-get install chromium)`;

export function launch() {
  return chromium.launch({ executablePath: PROGRAM, args: FLAGS });
}

/** A page at `url` (with `?test`), and in `errors` all that went wrong in it. */
export async function openPage(browser, url, { width = 1440, height = 900, colorScheme = "light", test = true } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme, reducedMotion: "reduce" });
  const page = await context.newPage();
  const errors = [];
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => isWrong(message) && errors.push(message.text()));
  await page.goto(test ? `${url}?test` : url);
  return { page, errors, close: () => context.close() };
}

// That the server is away is what some tests want; that software draws is the machine's matter.
function isWrong(message) {
  const isExpected = /WebSocket connection|GPU stall|ERR_CONNECTION|GroupMarkerNotSet|software/i.test(message.text());
  return ["error", "warning"].includes(message.type()) && !isExpected;
}

/** Waits until `condition`, run in the page, is true. */
export function until(page, condition, argument, timeout = 15000) {
  return page.waitForFunction(condition, argument, { timeout });
}

/** Waits until images are drawn. */
export function untilDrawn(page) {
  return until(page, () => window.dermatome?.state().sequence !== undefined && window.dermatome.framesDrawn > 3);
}

export async function screenshot(page, name) {
  mkdirSync(SCREENSHOTS, { recursive: true });
  await page.screenshot({ path: `${SCREENSHOTS}${name}.png` });
}

/** Red, green and blue of the canvas where `place` (m) is drawn. */
export function colourAtPlace(page, place) {
  return page.evaluate(([x, y, z]) => {
    const canvas = document.getElementById("canvas");
    const [px, py] = window.dermatome.project(x, y, z);
    const gl = canvas.getContext("webgl2");
    const scale = canvas.width / canvas.clientWidth;
    const pixel = new Uint8Array(4);
    gl.readPixels(Math.round(px * scale), canvas.height - 1 - Math.round(py * scale), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    return [...pixel.slice(0, 3)];
  }, place);
}
