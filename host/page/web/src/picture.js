// The picture: the scene with all that is laid over it. It is drawn only where something of it has changed.

import { gradientOf, MAPS, tableOf } from "./colour.js";
import { byId, eachChild, element, setText, svg } from "./element.js";
import { electrodeStates } from "./electrode_states.js";
import { Labels } from "./labels.js";
import { pixelValues } from "./messages.js";
import { RobotFigure } from "./robot_figure.js";
import { Scale, nextStep } from "./scale.js";
import { Scene } from "./scene.js";

const DRAWN_CHANGES = ["skin", "image", "contacts", "health", "view", "look", "new", "robot"];
const MOST_TICKS = 6;
const RULER_POINTS = 110;

export class Picture {
  constructor(session, { keepsPixels }) {
    this.session = session;
    this.scale = new Scale();
    this.map = "viridis";
    this.shows = { contacts: true, electrodes: true, link: true };
    this.values = undefined;
    this.framesDrawn = 0;
    this.lastDrawnDeviceTime = 0;
    this.canvas = byId("canvas");
    this.scene = this.openScene(keepsPixels);
    if (!this.scene) return;
    this.labels = new Labels(byId("labels"), this.scene);
    this.canvas.addEventListener("webglcontextlost", () => session.lacks("The browser has lost the graphics card. The picture comes back by itself, or when the page is reloaded."));
    this.canvas.addEventListener("webglcontextrestored", () => session.lacks(""));
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    session.listen((changes) => this.update(changes));
  }

  openScene(keepsPixels) {
    try {
      return new Scene(this.canvas, { keepsPixels, onView: () => this.session.changed("view") });
    } catch {
      this.session.lacks("The picture needs WebGL, which this browser does not offer. Numbers and plots work without it.");
      return undefined;
    }
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.scene.resize(clientWidth, clientHeight, window.devicePixelRatio);
    this.session.changed("view");
  }

  setMap(map) {
    this.map = map;
    this.table = undefined;
    this.session.changed("look");
  }

  setShown(shows) {
    Object.assign(this.shows, shows);
    this.session.changed("look");
  }

  /** The values of the colour map's ends. */
  get range() {
    const { maximum } = this.scale;
    return [MAPS[this.map].isDiverging ? -maximum : 0, maximum];
  }

  update(changes) {
    if (!DRAWN_CHANGES.some((name) => changes.has(name))) return;
    const { shown, isWhole } = this.session;
    if (changes.has("new") || isWhole !== Boolean(this.scene.figure)) this.showWhole(isWhole);
    if (isWhole && changes.has("robot")) this.showRobot();
    if (changes.has("skin") || changes.has("new")) this.showSkin(shown.skin);
    if (changes.has("image")) this.showImage(shown.image);
    if (changes.has("contacts")) this.showContacts(shown.contacts?.contacts ?? []);
    if (changes.has("health") || changes.has("skin")) this.showHealth(shown);
    if (changes.has("look") || changes.has("skin")) this.showLook();
    this.draw(changes);
  }

  showSkin(skin) {
    this.values = undefined;
    if (!skin) {
      this.showContacts([]);
      this.labels.setElectrodes([], {});
      return this.scene.removeSkin();
    }
    this.scale.threshold = skin.contact_threshold;
    this.scene.setSkin(skin);
    this.labels.setElectrodes(skin.electrodes, this.scene.frame);
    if (this.session.shown.image) this.showImage(this.session.shown.image);
  }

  showImage(image) {
    if (!image) return this.scene.surface?.show(undefined);
    this.values = pixelValues(image, this.values);
    this.scale.follow(this.values, Number(image.device_time_us) / 1e6);
    this.scene.surface?.show(this.values);
  }

  showContacts(contacts) {
    this.scene.showContacts(this.shows.contacts ? contacts : []);
    this.labels.showContacts(contacts);
  }

  showWhole(isWhole) {
    this.scene.setFigure(isWhole ? new RobotFigure() : undefined);
    this.scene.isFitted = true;
  }

  showRobot() {
    const { robot } = this.session;
    const { figure } = this.scene;
    const isOther = figure.follow(robot);
    const skins = [...robot.skins.values()].map(({ skin }) => skin).filter(Boolean);
    this.scale.threshold = Math.max(...skins.map(({ contact_threshold: threshold }) => threshold));
    for (const { values } of figure.skins.values()) if (values) this.scale.follow(values, performance.now() / 1000);
    robot.news.clear();
    if (isOther) {
      this.scene.fitFigure();
      this.showLook();
    }
    this.showContacts(robot.contacts);
  }

  /** The contacts that are seen. */
  get contacts() {
    const { isWhole, robot, shown } = this.session;
    return isWhole ? robot.contacts : (shown.contacts?.contacts ?? []);
  }

  showHealth({ skin, health }) {
    if (skin) this.labels.showElectrodes(electrodeStates(skin.electrodes.length / 3, health));
  }

  showLook() {
    this.labels.setShown(this.shows);
    this.scene.showLink(this.shows.link);
    this.scene.setTheme(themeOfScene());
    this.showContacts(this.contacts);
  }

  draw(changes) {
    this.table ??= tableOf(this.map);
    const [low, high] = this.range;
    for (const surface of this.scene.surfaces) surface.setColours(this.table, low, high);
    this.scene.draw();
    const isViewNew = ["view", "skin", "robot"].some((name) => changes.has(name));
    this.labels.place(isViewNew);
    byId("view-foot").hidden = !this.scene.frame;
    if (isViewNew && this.scene.frame) this.showRuler();
    this.showColourBar(low, high);
    this.framesDrawn++;
    if (changes.has("image") && this.session.shown.image) {
      this.lastDrawnDeviceTime = Number(this.session.shown.image.device_time_us);
    }
  }

  showColourBar(low, high) {
    const key = [this.map, low, high, this.scale.isAutomatic].join();
    if (key === this.barKey) return;
    this.barKey = key;
    byId("bar-colours").style.background = gradientOf(this.map);
    setText(byId("bar-mode"), this.scale.isAutomatic ? "auto" : "fixed");
    eachChild(byId("bar-ticks"), ticksOf(low, high), () => element("li"), (item, { text, value }) => {
      setText(item, text);
      item.style.bottom = `${(100 * (value - low)) / (high - low)}%`;
    });
  }

  showRuler() {
    const pointsPerMetre = this.scene.pointsPerMetre();
    const length = nextStep(RULER_POINTS / pointsPerMetre, false);
    byId("ruler").style.width = `${length * pointsPerMetre}px`;
    setText(byId("ruler-text"), length < 1 ? `${round(length * 1000)} mm` : `${round(length)} m`);
    byId("axes").replaceChildren(...axisLines(this.scene.axes()));
  }
}

/** Round values from low to high, with as many decimals as their step has. */
export function ticksOf(low, high) {
  const step = nextStep((high - low) / MOST_TICKS, true);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: count }, (_, i) => ({ value: (first + i) * step, text: ((first + i) * step).toFixed(decimals) }));
}

function round(value) {
  return Number(value.toPrecision(2));
}

// Those that point away are drawn first.
function axisLines(axes) {
  const named = axes.map(([right, up, towards], i) => ({ right, up, towards, name: "xyz"[i] }));
  return named
    .sort((a, b) => a.towards - b.towards)
    .map(({ right, up, name }) => {
      const label = svg("text", { x: right * 25, y: -up * 25 });
      label.textContent = name;
      return svg("g", {}, svg("line", { x2: right * 17, y2: -up * 17 }), label);
    });
}

function themeOfScene() {
  const style = getComputedStyle(document.documentElement);
  const parts = (name) => style.getPropertyValue(name).trim().split(/\s+/).map((part) => Number(part) / 255);
  return { blank: parts("--skin-blank"), line: parts("--skin-line") };
}
