// The page against the program itself, with a simulated board. DERMATOME is the path of the program; without it the
// tests are not run.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { isAbsolute, join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import { after, before, describe, test } from "node:test";

import { launch, missing, openPage, screenshot, until, untilDrawn } from "./browser.mjs";

const PROGRAM = process.env.DERMATOME;
const SKIN = fileURLToPath(new URL("../../../../models/disc-210mm/skin.toml", import.meta.url));
const skip = PROGRAM ? missing : "not run: DERMATOME does not name the program";
const START_MS = 60000;

/** Starts the program in `folder`, and tells its address. `end` ends it. */
async function start(folder, listen = "127.0.0.1:0") {
  const child = spawn(PROGRAM, ["view", "--port", `sim:${SKIN}`, "--listen", listen, "--no-browser"], { cwd: folder });
  const said = [];
  child.stderr.on("data", (data) => said.push(data));
  const lines = createInterface({ input: child.stdout })[Symbol.asyncIterator]();
  const late = new Promise((_, reject) => setTimeout(reject, START_MS, new Error("no address")).unref());
  const { value } = await Promise.race([lines.next(), late]);
  assert.match(String(value), /^http:\/\/127\.0\.0\.1:\d+\/(\?token=.*)?$/, Buffer.concat(said).toString());
  const end = () => new Promise((resolve) => child.once("exit", resolve) && child.kill("SIGINT"));
  return { url: value, port: new URL(value).port, end };
}

const text = (page, id) => page.textContent(`#${id}`);
const stateIs = (page, word) => until(page, (expected) => document.getElementById("state").textContent === expected, word, START_MS);


function hasChecked() {
  const said = document.getElementById("said-check");
  return document.querySelector("#check-result > *") || (said.dataset.kind === "error" && said.textContent !== "");
}

describe("the program", () => {
  let browser, folder, program;
  before(async () => {
    if (skip) return;
    browser = await launch();
    folder = mkdtempSync(join(tmpdir(), "dermatome-page-"));
    program = await start(folder);
  });
  after(async () => {
    await program?.end();
    await browser?.close();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  test("the page shows the simulated skin, without an error", { skip }, async () => {
    const { page, errors, close } = await openPage(browser, program.url);
    await stateIs(page, "Live");
    await untilDrawn(page);
    const state = await page.evaluate(() => window.dermatome.state());
    assert.equal(state.skin, "disc-210mm");
    assert.equal(state.isFlat, true);
    assert.equal(await page.locator(".electrode").count(), 16);
    await page.waitForTimeout(2000);
    await screenshot(page, "live");
    assert.deepEqual(errors, []);
    await close();
  });

  test("tare by key: it is live again, with new images", { skip }, async () => {
    const { page, errors, close } = await openPage(browser, program.url);
    await stateIs(page, "Live");
    await page.keyboard.press("t");
    await page.waitForTimeout(500);
    await stateIs(page, "Live");
    assert.equal(await text(page, "said-actions"), "");
    const { sequence } = await page.evaluate(() => window.dermatome.state());
    await until(page, (before) => window.dermatome.state().sequence > before, sequence);
    assert.deepEqual(errors, []);
    await close();
  });

  test("what it records opens in the page and has the same frames", { skip }, async () => {
    const { page, errors, close } = await openPage(browser, program.url);
    await stateIs(page, "Live");
    await untilDrawn(page);
    await page.keyboard.press("r");
    await until(page, () => !document.getElementById("recording-line").hidden);
    const [, name] = (await text(page, "recording-line")).match(/^Recording to (.*\.mcap): /);
    await page.waitForTimeout(2000);
    await page.keyboard.press("r");
    await until(page, () => document.getElementById("recording-line").hidden);
    const file = isAbsolute(name) ? name : join(folder, name);
    assert.ok(statSync(file).size > 1000);
    await page.setInputFiles("#file", { name: "live.mcap", mimeType: "", buffer: readFileSync(file) });
    await until(page, () => window.dermatome.state().recording && window.dermatome.state().sequence !== undefined);
    const { recording, sequence } = await page.evaluate(() => window.dermatome.state());
    assert.equal(recording.isCut, false);
    assert.ok(recording.duration > 1, `${recording.duration} s`);
    await page.keyboard.press("ArrowRight");
    await until(page, (before) => window.dermatome.state().sequence > before, sequence);
    await screenshot(page, "live-recording");
    assert.deepEqual(errors, []);
    await close();
  });

  test("scope: samples of the slot", { skip }, async () => {
    const { page, errors, close } = await openPage(browser, program.url);
    await stateIs(page, "Live");
    await untilDrawn(page);
    await page.keyboard.press("6");
    await page.selectOption("#slot", "2");
    await until(page, () => document.getElementById("scope-text").textContent.startsWith("Slot 2"));
    await screenshot(page, "live-scope");
    assert.deepEqual(errors, []);
    await close();
  });

  test("check says what it found, or why it cannot check", { skip }, async () => {
    const { page, errors, close } = await openPage(browser, program.url);
    await stateIs(page, "Live");
    await page.keyboard.press("4");
    await page.click("#check");
    await until(page, hasChecked, undefined, START_MS);
    await screenshot(page, "live-check");
    assert.deepEqual(errors, []);
    await close();
  });

  test("it ends and is started again: the page comes back by itself", { skip }, async () => {
    const { page, errors, close } = await openPage(browser, program.url);
    await stateIs(page, "Live");
    await program.end();
    await stateIs(page, "No program");
    program = await start(folder, `127.0.0.1:${program.port}`);
    await stateIs(page, "Live");
    assert.deepEqual(errors, []);
    await close();
  });
});
