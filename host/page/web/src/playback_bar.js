// The bar under the picture while a recording is shown: position, play, speed, frame by frame; and how a file is opened.

import { byId, element, setText } from "./element.js";
import { SPEEDS } from "./player.js";
import { colour } from "./plots.js";
import { openRecording } from "./recording.js";
import { clock } from "./words.js";

export class PlaybackBar {
  constructor(session) {
    this.session = session;
    byId("speed").append(...SPEEDS.map((speed) => element("option", { value: speed }, `${speed} ×`)));
    this.connectControls();
    setUpDrop((file) => this.open(file));
    session.listen((changes) => {
      if (changes.has("player") || changes.has("new")) this.show();
      if (changes.has("look") || changes.has("recorded")) this.drawOverview();
    });
    new ResizeObserver(() => this.drawOverview()).observe(byId("overview"));
  }

  connectControls() {
    const withPlayer = (act) => () => this.session.player && act(this.session.player);
    byId("play").addEventListener("click", withPlayer((player) => player.toggle()));
    byId("step-back").addEventListener("click", withPlayer((player) => player.step(false)));
    byId("step-on").addEventListener("click", withPlayer((player) => player.step(true)));
    byId("speed").addEventListener("change", withPlayer((player) => player.setSpeed(Number(byId("speed").value))));
    byId("position").addEventListener("input", withPlayer((player) => player.seekSeconds(Number(byId("position").value))));
    byId("close-recording").addEventListener("click", () => this.close());
    byId("open").addEventListener("click", () => byId("file").click());
    byId("file").addEventListener("change", (event) => {
      const [file] = event.target.files;
      event.target.value = "";
      if (file) this.open(file);
    });
  }

  async open(file) {
    const said = byId("said-actions");
    const say = (text, kind) => {
      said.dataset.kind = kind;
      setText(said, text);
    };
    say(`Opening ${file.name}.`, "progress");
    try {
      const onProgress = (share) => say(`${file.name} was cut; reading what is there: ${Math.round(share * 100)} %.`, "progress");
      const recording = await openRecording(file, file.name, onProgress);
      this.session.openPlayer(recording);
      say("", "progress");
    } catch (error) {
      say(`${file.name} cannot be shown. ${error.message}`, "error");
    }
  }

  close() {
    this.session.closePlayer();
    byId("open").focus();
  }

  show() {
    const { player } = this.session;
    byId("playback").hidden = !player;
    if (!player) return;
    const { recording } = player;
    setText(byId("play"), player.isPlaying ? "Pause" : "Play");
    setText(byId("playback-name"), recording.name);
    byId("position").max = String(recording.duration);
    byId("position").value = String(player.seconds);
    byId("position").setAttribute("aria-valuetext", clock(player.seconds));
    byId("speed").value = String(player.speed);
    setText(byId("time"), `${clock(player.seconds)} / ${clock(recording.duration)}`);
  }

  // How strongly the skin, or of a robot's the one that was pressed most, was pressed over the whole recording, behind the
  // slider.
  drawOverview() {
    const canvas = byId("overview");
    const { player, recorded } = this.session;
    if (!player || canvas.clientWidth === 0) return;
    canvas.width = canvas.clientWidth * devicePixelRatio;
    canvas.height = canvas.clientHeight * devicePixelRatio;
    const { start, duration } = player.recording;
    const ofSkins = recorded.strengths.map((strength) => extremes(strength, Number(start) / 1e9, duration, canvas.width));
    const columns = ofSkins.reduce((a, b) => a.map((load, x) => Math.max(load, b[x])), new Float32Array(canvas.width));
    const greatest = Math.max(...columns) || 1;
    const context = canvas.getContext("2d");
    context.fillStyle = colour("--overview");
    columns.forEach((load, x) => context.fillRect(x, canvas.height, 1, (-load / greatest) * canvas.height));
  }
}

// The greatest value in each of `count` columns; one without a value repeats the one before it, up to the last value.
function extremes({ times, values }, start, duration, count) {
  const columns = new Float32Array(count).fill(-1);
  const columnOf = (time) => Math.max(0, Math.min(count - 1, Math.floor(((time - start) / duration) * count)));
  times.forEach((time, i) => (columns[columnOf(time)] = Math.max(columns[columnOf(time)], values[i] ?? 0)));
  const end = times.length > 0 ? columnOf(times.at(-1)) : 0;
  return columns.map((value, x) => {
    if (value < 0) columns[x] = x > 0 && x <= end ? columns[x - 1] : 0;
    return columns[x];
  });
}

// A file may be dropped anywhere on the page.
function setUpDrop(open) {
  const hasFile = (event) => event.dataTransfer?.types.includes("Files");
  const show = (isShown) => (byId("drop").hidden = !isShown);
  addEventListener("dragover", (event) => {
    if (!hasFile(event)) return;
    event.preventDefault();
    show(true);
  });
  addEventListener("dragleave", (event) => event.relatedTarget === null && show(false));
  addEventListener("drop", (event) => {
    if (!hasFile(event)) return;
    event.preventDefault();
    show(false);
    const [file] = event.dataTransfer.files;
    if (file) open(file);
  });
}
