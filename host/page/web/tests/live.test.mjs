// The page against the program itself, with a simulated board. DERMATOME is the path of the program; without it the
// tests are not run.

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { isAbsolute, join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import { after, before, describe, test } from "node:test";

import { colourAtPlace, launch, missing, openPage, screenshot, until, untilDrawn } from "./browser.mjs";
import { record } from "./recordings.mjs";

const PROGRAM = process.env.DERMATOME;
const SKIN = fileURLToPath(new URL("../../../../models/disc-210mm/skin.toml", import.meta.url));
const skip = PROGRAM ? missing : "not run: DERMATOME does not name the program";
const START_MS = 60000;

// A test that fails does not end what it has started, and for that these tests would wait.
const started = [];
after(() => started.forEach((child) => child.kill("SIGKILL")));

/** Starts the program in `folder`, and tells its address, which it says on `out`. `end` ends it. */
async function start(folder, listen = "127.0.0.1:0", command = ["view", "--port", `sim:${SKIN}`], out = "stdout") {
  const child = spawn(PROGRAM, [...command, "--listen", listen, "--no-browser"], { cwd: folder });
  started.push(child);
  const said = [];
  child.stderr.on("data", (data) => said.push(data));
  if (out !== "stdout") child.stdout.resume();
  const lines = createInterface({ input: child[out] })[Symbol.asyncIterator]();
  const late = new Promise((_, reject) => setTimeout(reject, START_MS, new Error("no address")).unref());
  const { value } = await Promise.race([lines.next(), late]);
  assert.match(String(value), /^http:\/\/127\.0\.0\.1:\d+\/(\?token=.*)?$/, Buffer.concat(said).toString());
  const hasEnded = () => child.exitCode !== null || child.signalCode !== null;
  const end = () => new Promise((resolve) => (hasEnded() ? resolve() : child.once("exit", resolve) && child.kill("SIGINT")));
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
    await until(page, () => window.dermatome.state().sequence !== undefined);
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

const TINY = readFileSync(new URL("../../../tests/data/tiny.toml", import.meta.url), "utf8");

const patch = (name) => `[[patches]]
name = "${name}"
skin = "${name}.toml"
port = "sim:${name}.toml"
link = "${name}_link"
position = ["0 mm", "0 mm", "40 mm"]
orientation = [0, 0, 0, 1]
`;

describe("a robot's skins", () => {
  let browser, folder, program;
  before(async () => {
    if (skip) return;
    browser = await launch();
    folder = mkdtempSync(join(tmpdir(), "dermatome-robot-"));
    for (const name of ["palm", "elbow"]) {
      writeFileSync(join(folder, `${name}.toml`), TINY.replace('name = "tiny"', `name = "${name}-skin"`));
    }
    writeFileSync(join(folder, "robot.toml"), `name = "arm"\n${patch("palm")}${patch("elbow")}`);
    program = await start(folder, "127.0.0.1:0", ["serve", "robot.toml"], "stderr");
  });
  after(async () => {
    await program?.end();
    await browser?.close();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  test("are shown one at a time, and tared each for itself", { skip }, async () => {
    const { page, errors, close } = await openPage(browser, program.url);
    const skin = () => page.evaluate(() => window.dermatome.state().skin);
    await stateIs(page, "Live");
    await untilDrawn(page);
    assert.equal(await skin(), "palm-skin");
    assert.deepEqual(await page.locator("#skin-choice option").allTextContents(), ["arm/palm", "arm/elbow"]);
    await page.selectOption("#skin-choice", "arm/elbow");
    await until(page, () => window.dermatome.state().skin === "elbow-skin", undefined, START_MS);
    await stateIs(page, "Live");
    await untilDrawn(page);
    assert.ok(await page.isEnabled("#tare"));
    assert.ok(await page.isDisabled("#record"), "not offered for a robot");
    await screenshot(page, "robot");
    assert.deepEqual(errors, []);
    await close();
  });
});

const ARM = fileURLToPath(new URL("../../../../models/arm/robot.toml", import.meta.url));
const SPACES = ["arm/upper_arm", "arm/forearm", "arm/hand"];

describe("a whole robot", () => {
  let browser, folder, program;
  before(async () => {
    if (skip) return;
    browser = await launch();
    folder = mkdtempSync(join(tmpdir(), "dermatome-arm-"));
    program = await start(folder, "127.0.0.1:0", ["serve", ARM], "stderr");
  });
  after(async () => {
    await program?.end();
    await browser?.close();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  function areAllTouched(count) {
    return new Set((window.dermatome.state().robot?.contacts ?? []).map(({ space }) => space)).size === count;
  }

  /** Waits until all skins are touched, and stops the picture. */
  async function holdTouched(page) {
    await until(page, areAllTouched, SPACES.length, START_MS);
    await page.keyboard.press(" ");
    await until(page, () => window.dermatome.state().isHeld);
    await page.waitForTimeout(300);
    return page.evaluate(() => window.dermatome.state().robot);
  }

  /** That each contact lies on a skin which is coloured there. */
  async function assertColoured(page, { contacts }) {
    await page.evaluate(() => document.getElementById("show-contacts").click());
    await page.waitForTimeout(300);
    for (const { space, position } of contacts) {
      const [red, green, blue] = await colourAtPlace(page, [position.x, position.y, position.z]);
      // Of viridis, where nothing is a dark violet; the link is grey.
      assert.ok(green > 90 && green - Math.min(red, blue) > 40, `${space}: ${red}, ${green}, ${blue}`);
    }
  }

  for (const [name, options] of Object.entries({ light: {}, dark: { colorScheme: "dark" }, phone: { width: 390, height: 844 } })) {
    test(`shows all skins where their links are, and in each where it is touched: ${name}`, { skip }, async () => {
      const { page, errors, close } = await openPage(browser, program.url, options);
      const robot = await holdTouched(page);
      assert.deepEqual(robot.skins.toSorted(), SPACES.toSorted());
      assert.deepEqual(robot.links, ["base", "upper_arm", "forearm", "hand"]);
      await page.waitForTimeout(300);
      await screenshot(page, `whole-robot-${name}`);
      await assertColoured(page, robot);
      await page.keyboard.press("2");
      await until(page, () => Number(document.querySelectorAll(".plot:not([hidden]) output")[1].textContent) > 0);
      assert.deepEqual((await page.locator("#plot-skins li").allTextContents()).map((name) => `arm/${name}`).toSorted(), SPACES.toSorted());
      await screenshot(page, `whole-robot-plots-${name}`);
      assert.deepEqual(errors, []);
      await close();
    });
  }

  // Each finger lifts after a round, and a busy computer begins with each skin when it can, and then with many frames at once.
  async function recordUntilAllTouched(file) {
    const serve = spawn(PROGRAM, ["serve", ARM, "--record", file], { stdio: ["ignore", "pipe", "ignore"] });
    const late = setTimeout(() => serve.kill(), 2 * START_MS);
    const touchedSince = new Map();
    for await (const line of createInterface({ input: serve.stdout })) {
      const { patch, contacts } = JSON.parse(line);
      if (!contacts) continue;
      if (contacts.length === 0) touchedSince.delete(patch);
      else if (!touchedSince.has(patch)) touchedSince.set(patch, performance.now());
      const isEnough = touchedSince.size === SPACES.length && performance.now() - Math.max(...touchedSince.values()) > 1000;
      if (isEnough && !serve.killed) serve.kill("SIGINT");
    }
    clearTimeout(late);
    assert.equal(serve.exitCode ?? (await new Promise((resolve) => serve.once("exit", resolve))), 0);
  }

  /** Seeks the last moment at which all skins are touched, and gives its place: while the recording ended, a finger may have lifted. */
  async function seekTouched(page) {
    const { duration } = (await page.evaluate(() => window.dermatome.state())).recording;
    for (let seconds = duration; seconds > 0; seconds -= 0.1) {
      // A slider takes whole steps only.
      const place = String(Math.floor(1000 * seconds) / 1000);
      await page.locator("#position").fill(place);
      const isFound = await until(page, areAllTouched, SPACES.length, 500).then(() => true, () => false);
      if (isFound) return place;
    }
    assert.fail("nowhere in the recording are all skins touched");
  }

  test("that was recorded is shown as it was live, wherever one scrubs", { skip }, async () => {
    const file = join(folder, "run.mcap");
    await recordUntilAllTouched(file);
    const { page, errors, close } = await openPage(browser, program.url);
    await until(page, () => window.dermatome.state().robot?.links.length === 4, undefined, START_MS);
    await page.setInputFiles("#file", file);
    await until(page, () => document.getElementById("playback-name").textContent === "run.mcap" && window.dermatome.state().robot?.links.length === 4, undefined, START_MS);
    const begin = await page.evaluate(() => window.dermatome.state());
    assert.ok(begin.recording.seconds < 1, `the first frame is at ${begin.recording.seconds} s`);
    assert.deepEqual(begin.robot.links, ["base", "upper_arm", "forearm", "hand"]);
    const choices = await page.locator("#skin-choice option").allTextContents();
    assert.deepEqual([choices[0], ...choices.slice(1).toSorted()], ["Whole robot", ...SPACES.toSorted()]);
    const touched = await seekTouched(page);
    await page.waitForTimeout(300);
    const { robot } = await page.evaluate(() => window.dermatome.state());
    assert.deepEqual(robot.skins.toSorted(), SPACES.toSorted());
    await screenshot(page, "whole-robot-recorded");
    await page.locator("#position").fill("0");
    await until(page, (length) => window.dermatome.state().robot.contacts.length !== length, robot.contacts.length);
    await page.locator("#position").fill(touched);
    await until(page, (length) => window.dermatome.state().robot.contacts.length === length, robot.contacts.length);
    await assertColoured(page, await page.evaluate(() => window.dermatome.state().robot));
    await page.keyboard.press("2");
    await until(page, (count) => Number(document.querySelectorAll(".plot:not([hidden]) output")[1].textContent) === count, robot.contacts.length);
    await screenshot(page, "whole-robot-plots-recorded");
    assert.deepEqual(errors, []);
    await close();
  });

  test("a skin that is chosen shows its details, and the whole robot comes back", { skip }, async () => {
    const { page, errors, close } = await openPage(browser, program.url);
    await until(page, () => document.querySelectorAll("#skin-choice option").length > 1);
    assert.deepEqual(await page.locator("#skin-choice option").allTextContents(), ["Whole robot", ...SPACES]);
    await page.selectOption("#skin-choice", "arm/forearm");
    await until(page, () => window.dermatome.state().skin === "forearm-skin", undefined, START_MS);
    await untilDrawn(page);
    assert.equal(await page.locator(".electrode").count(), 16);
    assert.ok(await page.isEnabled("#tare"));
    await page.selectOption("#skin-choice", "*");
    await until(page, (count) => window.dermatome.state().robot?.skins.length === count, SPACES.length, START_MS);
    assert.equal(await page.locator(".electrode").count(), 0);
    assert.ok(await page.isDisabled("#tare"), "asks one skin, not all");
    await page.setInputFiles("#file", { name: "press.mcap", mimeType: "", buffer: await record({ seconds: 1 }) });
    await until(page, () => window.dermatome.state().recording);
    await page.click("#close-recording");
    await until(page, (count) => window.dermatome.state().robot?.skins.length === count, SPACES.length, START_MS);
    await until(page, () => window.dermatome.state().robot.links.length === 4, undefined, START_MS);
    assert.deepEqual(errors, []);
    await close();
  });
});

describe("reflexes", () => {
  const RULE = '\n[[reflexes]]\nname = "bumper"\npin = 2\nstrength = 1.0\ncentre = ["25 mm", "0 mm"]\nradius = "20 mm"\n';
  const TRIPPED = "reflex `bumper` is tripped: pin 2 is low";
  const told = (words) => [...document.querySelectorAll("#banners li")].some((item) => item.textContent === words);
  const gone = (words) => [...document.querySelectorAll("#banners li")].every((item) => item.textContent !== words);
  const says = (page, words) => until(page, told, words, START_MS);
  let browser, folder, board, port;
  before(async () => {
    if (skip) return;
    browser = await launch();
    folder = mkdtempSync(join(tmpdir(), "dermatome-reflexes-"));
    writeFileSync(join(folder, "palm.toml"), TINY + RULE);
    // A finger that presses the region, and lifts: elsewhere it would read as nearly the limit.
    const at = (time, depth) => `${time},1,0.025,0,0.012,${depth}\n`;
    const round = (start) => [[0, 0.9], [3.9, 0.9], [4, 0], [11.9, 0]].map(([time, depth]) => at(start + time, depth)).join("");
    const rows = Array.from({ length: 20 }, (_, i) => round(12 * i));
    writeFileSync(join(folder, "path.csv"), `time_s,finger,x_m,y_m,radius_m,depth\n${rows.join("")}`);
    board = spawn(PROGRAM, ["simulate", "palm.toml", "--listen", "tcp:127.0.0.1:0", "--path", "path.csv"], { cwd: folder });
    const { value } = await createInterface({ input: board.stdout })[Symbol.asyncIterator]().next();
    port = value.split(" listens at ")[1];
    execFileSync(PROGRAM, ["build", "palm.toml", "-o", "palm.dermatome"], { cwd: folder, stdio: "ignore" });
    execFileSync(PROGRAM, ["flash", "palm.dermatome", "--port", port], { cwd: folder, stdio: "ignore" });
    writeFileSync(join(folder, "robot.urdf"), '<robot name="r"><link name="palm_link"/></robot>');
    writeFileSync(join(folder, "robot.toml"), `name = "arm"\nurdf = "robot.urdf"\n${patch("palm").replace("sim:palm.toml", port)}`);
  });
  after(async () => {
    board?.kill();
    await browser?.close();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  test("that trip are said of the whole robot, until they are released, and of one skin", { skip }, async () => {
    const program = await start(folder, "127.0.0.1:0", ["serve", "robot.toml"], "stderr");
    const { page, errors, close } = await openPage(browser, program.url);
    await says(page, `arm/palm: ${TRIPPED}`);
    await screenshot(page, "reflex-robot");
    await until(page, gone, `arm/palm: ${TRIPPED}`, START_MS);
    await page.selectOption("#skin-choice", "arm/palm");
    await says(page, TRIPPED);
    await screenshot(page, "reflex");
    assert.deepEqual(errors, []);
    await close();
    await program.end();
  });

  test("are said by `view` too", { skip }, async () => {
    const program = await start(folder, "127.0.0.1:0", ["view", "--port", port]);
    const { page, errors, close } = await openPage(browser, program.url);
    await says(page, TRIPPED);
    assert.deepEqual(errors, []);
    await close();
    await program.end();
  });
});

describe("a board that is lost", () => {
  const hasContacts = () => window.dermatome.state().robot?.contacts.length > 0;
  const hasNone = () => window.dermatome.state().robot?.contacts.length === 0;
  let browser, folder, board, port, program;

  async function startBoard(listen) {
    board = spawn(PROGRAM, ["simulate", "palm.toml", "--listen", listen, "--path", "path.csv", "--store", "board.dermatome"], { cwd: folder });
    const { value } = await createInterface({ input: board.stdout })[Symbol.asyncIterator]().next();
    port = value.split(" listens at ")[1];
  }

  function endBoard() {
    return new Promise((resolve) => board.once("exit", resolve) && board.kill("SIGKILL"));
  }

  before(async () => {
    if (skip) return;
    browser = await launch();
    folder = mkdtempSync(join(tmpdir(), "dermatome-lost-"));
    writeFileSync(join(folder, "palm.toml"), TINY);
    // A finger that never goes.
    writeFileSync(join(folder, "path.csv"), "time_s,finger,x_m,y_m,radius_m,depth\n0,1,0.02,0,0.012,0\n3,1,0.02,0,0.012,0\n4,1,0.02,0,0.012,0.9\n900,1,0.02,0,0.012,0.9\n");
    execFileSync(PROGRAM, ["build", "palm.toml", "-o", "board.dermatome"], { cwd: folder, stdio: "ignore" });
    await startBoard("tcp:127.0.0.1:0");
    writeFileSync(join(folder, "robot.urdf"), '<robot name="r"><link name="palm_link"/></robot>');
    writeFileSync(join(folder, "robot.toml"), `name = "arm"\nurdf = "robot.urdf"\n${patch("palm").replace("sim:palm.toml", port)}`);
  });
  after(async () => {
    await program?.end();
    board?.kill();
    await browser?.close();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  test("takes its contacts and colours along, live and where it was recorded", { skip }, async () => {
    program = await start(folder, "127.0.0.1:0", ["serve", "robot.toml", "--record", "run.mcap"], "stderr");
    const { page, errors, close } = await openPage(browser, program.url);
    await until(page, hasContacts, undefined, START_MS);
    await page.evaluate(() => document.getElementById("show-contacts").click());
    let position;
    // Until the finger has come down, and the skin has its colour there.
    const untilColoured = async (name, isSo) => {
      for (const begun = performance.now(); ; await page.waitForTimeout(200)) {
        const colour = position && (await colourAtPlace(page, [position.x, position.y, position.z]));
        if (colour && isSo(colour)) break;
        assert.ok(performance.now() - begun < START_MS, `${name}: ${colour}`);
        position = (await page.evaluate(() => window.dermatome.state())).robot.contacts[0]?.position ?? position;
      }
      await screenshot(page, `lost-board-${name}`);
    };
    await untilColoured("yellow", ([, green, blue]) => green - blue > 100);
    await endBoard();
    await until(page, hasNone, undefined, START_MS);
    await untilColoured("grey", (colour) => Math.max(...colour) - Math.min(...colour) < 30);
    assert.equal(await text(page, "no-contacts"), "No contacts are known.");
    await startBoard(port);
    await until(page, hasContacts, undefined, START_MS);
    await page.waitForTimeout(1500);
    await program.end();
    program = await start(folder, "127.0.0.1:0", ["view"]);
    await page.goto(program.url);
    await stateIs(page, "Ended");
    await page.setInputFiles("#file", join(folder, "run.mcap"));
    await until(page, () => window.dermatome.state().robot?.skins.length === 1, undefined, START_MS);
    await page.keyboard.press(" ");
    for (const [name, isSo] of [["pressed", hasContacts], ["lost", hasNone], ["pressed", hasContacts]]) {
      await until(page, isSo, undefined, START_MS);
      await page.waitForTimeout(100);
      await screenshot(page, `lost-board-recorded-${name}`);
    }
    // What the page says of the program that was ended.
    assert.deepEqual(errors.filter((error) => !error.includes("WebSocket")), []);
    await close();
  });
});
