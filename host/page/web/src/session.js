// What the page knows: the newest message of each topic, from the program or from a recording, and when to draw. All
// messages go one way: `Latest` keeps the newest, one animation frame decodes it, and the views show it.

import { addressOf } from "./connection.js";
import { Latest } from "./latest.js";
import { TOPIC, checkSkin, decode } from "./messages.js";
import { Player } from "./player.js";
import { Program } from "./program.js";
import { RecordedHistory } from "./recorded_history.js";
import { Robot } from "./robot.js";
import { SINGLE_SPACE } from "./spaces.js";
import { standing, taken } from "./standing.js";

const LIVE_TOPICS = [TOPIC.skin, TOPIC.status, TOPIC.image, TOPIC.contacts, TOPIC.health];
const HELD_TOPICS = new Set([TOPIC.image, TOPIC.contacts, TOPIC.health, TOPIC.scope]);
const HELD_OF_ROBOT = /^\d.*\/(image|contacts|tf)$/;
const NAMES = Object.fromEntries(Object.entries(TOPIC).map(([name, topic]) => [topic, name]));
const STALE_MS = 2000;
const LATENCIES_KEPT = 2000;

export class Session {
  constructor(location) {
    this.listeners = [];
    this.changes = new Set();
    this.latest = new Latest();
    this.robot = new Robot();
    // The newest message of each topic, and when it came, and those that are not over.
    this.known = { messages: {}, times: {} };
    this.shown = {};
    this.liveStatus = undefined;
    this.player = undefined;
    this.isHeld = false;
    this.isScopeWanted = false;
    this.fault = "";
    this.lack = "";
    this.imageCame = 0;
    this.latencies = [];
    this.program = new Program(addressOf(location), {
      message: (...message) => this.fromProgram(...message),
      session: () => this.begin(),
      change: () => this.changed("program"),
      failed: (text) => this.failed(text),
    });
    this.subscribe();
    setInterval(() => this.watch(), 500);
  }

  /**
   * Calls `listener(changes)` once for each animation frame in which something changed, with the names of what did.
   * Returns what ends that.
   */
  listen(listener) {
    this.listeners.push(listener);
    return () => (this.listeners = this.listeners.filter((other) => other !== listener));
  }

  changed(name) {
    if (this.changes.size === 0) requestAnimationFrame(() => this.frame());
    this.changes.add(name);
  }

  call(service, request = {}) {
    if (this.player) return Promise.reject(new Error("A recording is shown. Close it to control the skin."));
    return this.program.call(service, request);
  }

  /** Whether the live skin can be controlled with this service. */
  offers(service) {
    return this.program.isOpen && !this.player && this.program.offers(service);
  }

  hold(isHeld) {
    this.isHeld = isHeld;
    this.changed("held");
  }

  /** Whether a live image should have come, and none has for some time. */
  get isStale() {
    const isLive = !this.player && !this.isHeld && this.program.isOpen && this.shown.status?.state === "live";
    return isLive && !document.hidden && performance.now() - this.imageCame > STALE_MS;
  }

  /** Where all that is shown comes from: the recording, or the program. */
  get source() {
    return this.player?.recording ?? this.program;
  }

  /** Whether all skins of a robot are shown at once. */
  get isWhole() {
    return this.source.isWhole;
  }

  /** What is shown of each skin that is looked at, and when it came: `[{ space, shown, times }]`. */
  get skins() {
    if (!this.isWhole) return [{ space: SINGLE_SPACE, shown: this.shown, times: this.known.times }];
    return [...this.robot.known].map(([space, { times }]) => ({ space, shown: this.robot.skins.get(space), times }));
  }

  wantScope(isWanted) {
    this.isScopeWanted = isWanted;
    this.subscribe();
  }

  openPlayer(recording) {
    this.endPlayer();
    this.stopScope();
    this.forget();
    this.isHeld = false;
    this.recorded = new RecordedHistory(recording, () => this.changed("recorded"));
    this.player = new Player(recording, {
      message: (...message) => this.receive(...message),
      change: () => this.changed("player"),
      error: (error) => this.failed(`The recording cannot be read here: ${error.message}.`),
    });
    this.subscribe();
    this.changed("player");
  }

  /** Another skin of the recording that is shown, or all of its robot, at the same time. */
  chooseRecorded(space) {
    const { recording, position, speed, isPlaying } = this.player;
    this.openPlayer(recording.of(space));
    this.player.setSpeed(speed);
    this.player.seek(position);
    if (isPlaying) this.player.play();
  }

  closePlayer() {
    this.endPlayer();
    this.forget();
    this.subscribe();
    this.changed("player");
  }

  // The board need not sample a slot that is not looked at; it does not matter here whether the program can be told.
  stopScope() {
    if (this.isScopeWanted) this.program.call("/dermatome/scope", { slot: null }).catch(() => {});
  }

  endPlayer() {
    this.player?.close();
    this.recorded?.close();
    this.player = this.recorded = undefined;
  }

  // While a recording is shown only the program's status is followed. Subscribing again brings the skin again.
  subscribe() {
    for (const topic of LIVE_TOPICS) this.program.want(topic, !this.player || topic === TOPIC.status);
    this.program.want(TOPIC.scope, this.isScopeWanted && !this.player);
    if (!this.player && this.liveStatus) this.known.messages.status = this.shown.status = this.liveStatus;
  }

  begin() {
    this.liveStatus = undefined;
    if (!this.player) this.forget();
  }

  forget() {
    this.latest.clear();
    this.known = { messages: {}, times: {} };
    this.shown = {};
    this.robot.clear();
    this.fault = "";
    this.imageCame = performance.now();
    for (const name of Object.keys(TOPIC)) this.changed(name);
    this.changed("new");
  }

  fromProgram(topic, schema, bytes, logTime) {
    if (this.player && topic === TOPIC.status) this.followStatus(schema, bytes);
    if (!this.player) this.receive(topic, schema, bytes, logTime);
  }

  followStatus(schema, bytes) {
    this.liveStatus = decode(schema, bytes);
    this.changed("liveStatus");
  }

  receive(topic, schema, bytes, logTime) {
    if (topic === TOPIC.image) this.imageCame = performance.now();
    this.latest.put(topic, schema, bytes, logTime);
    this.changed("messages");
  }

  frame() {
    const isHeld = (topic) => this.isHeld && (HELD_TOPICS.has(topic) || HELD_OF_ROBOT.test(topic));
    for (const message of this.latest.take((topic) => !isHeld(topic))) this.take(message);
    this.settle();
    const { changes } = this;
    this.changes = new Set();
    for (const listener of this.listeners) this.tell(listener, changes);
    if (changes.has("image") && this.shown.image) this.noteLatency();
  }

  // A view that fails does not keep the others from what is new.
  tell(listener, changes) {
    try {
      listener(changes);
    } catch (error) {
      console.error(error);
      this.failed(`A part of the page failed (${error.message}). Reload it.`);
    }
  }

  // Without bytes nothing is known of a topic any more, as before its first message in a recording.
  take({ topic, schema, bytes, logTime }) {
    const name = NAMES[topic];
    try {
      const message = bytes && decode(schema, bytes);
      if (!topic.startsWith("/")) return this.takeOfRobot(topic.slice(topic.indexOf("/")), message, logTime);
      if (message && name === "skin") checkSkin(message);
      this.known = taken(this.known, name, message, logTime);
      if (name === "status" && !this.player) this.liveStatus = message;
    } catch (error) {
      this.failed(`A message of ${topic} cannot be read (${error.message}). Reload the page: the program may be newer.`);
    }
  }

  // Topics of a whole robot come with the numbers of their channels, as several may have one name.
  takeOfRobot(topic, message, logTime) {
    if (message && topic.endsWith("/skin")) checkSkin(message);
    this.robot.take(topic, message, logTime, this.isHeld);
    this.changes.add("robot");
  }

  settle() {
    const before = this.shown;
    this.shown = standing(this.known, this.isHeld && before);
    for (const name of Object.keys(this.shown)) if (this.shown[name] !== before[name]) this.changes.add(name);
  }

  noteLatency() {
    const { image } = this.known.times;
    if (this.player || image === undefined) return;
    this.latencies.push(performance.timeOrigin + performance.now() - Number(image) / 1e6);
    if (this.latencies.length > LATENCIES_KEPT) this.latencies.shift();
  }

  /** What the browser lacks, as long as the page is open. */
  lacks(text) {
    this.lack = text;
    this.changed("program");
  }

  failed(text) {
    if (text === this.fault) return;
    this.fault = text;
    this.changed("program");
  }

  watch() {
    if (this.isStale !== this.wasStale) this.changed("program");
    this.wasStale = this.isStale;
  }
}
