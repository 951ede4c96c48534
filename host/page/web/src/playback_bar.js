// The bar under the picture while a recording is shown: position, play, speed, frame by frame; and how a file is opened.

import { byId, element, setText } from "./element.js";
import { TOPIC, decode } from "./messages.js";
import { SPEEDS } from "./player.js";
import { colour, totalLoad } from "./plots.js";
import { openRecording } from "./recording.js";
import { clock } from "./words.js";

const MOST_BINS = 400;
const BINS_A_SECOND = 20;
// The overview is read in steps of this length, between which the page draws.
const READ_MS = 12;

export class PlaybackBar {
  constructor(session) {
    this.session = session;
    this.overview = undefined;
    byId("speed").append(...SPEEDS.map((speed) => element("option", { value: speed }, `${speed} ×`)));
    this.connectControls();
    setUpDrop((file) => this.open(file));
    session.listen((changes) => {
      if (changes.has("player") || changes.has("new")) this.show();
      if (changes.has("look")) this.drawOverview();
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
    setText(byId("said-actions"), `Opening ${file.name}`);
    try {
      const recording = await openRecording(file, file.name);
      this.overview = new Float32Array(Math.max(1, Math.min(MOST_BINS, Math.round(recording.duration * BINS_A_SECOND))));
      this.session.openPlayer(recording);
      setText(byId("said-actions"), "");
      this.readOverview(recording);
    } catch (error) {
      setText(byId("said-actions"), `${file.name} cannot be shown. ${error.message}`);
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

  // How strongly the skin was pressed over the whole recording, behind the slider.
  async readOverview(recording) {
    const isShown = () => this.session.player?.recording === recording;
    let began = performance.now();
    try {
      for await (const messages of recording.walk([TOPIC.contacts])) {
        for (const { schema, bytes, logTime } of messages) {
          if (!isShown()) return;
          this.addToOverview(recording, logTime, decode(schema, bytes).contacts);
          if (performance.now() - began < READ_MS) continue;
          this.drawOverview();
          await new Promise((resolve) => setTimeout(resolve));
          began = performance.now();
        }
      }
    } catch (error) {
      console.warn("the overview of the recording is not complete:", error.message);
    }
    this.drawOverview();
  }

  addToOverview({ start, duration }, time, contacts) {
    const share = duration > 0 ? Number(time - start) / 1e9 / duration : 0;
    const bin = Math.min(this.overview.length - 1, Math.floor(share * this.overview.length));
    this.overview[bin] = Math.max(this.overview[bin], totalLoad(contacts, false));
  }

  drawOverview() {
    const canvas = byId("overview");
    if (!this.overview || !this.session.player || canvas.clientWidth === 0) return;
    canvas.width = canvas.clientWidth * devicePixelRatio;
    canvas.height = canvas.clientHeight * devicePixelRatio;
    const greatest = Math.max(...this.overview) || 1;
    const context = canvas.getContext("2d");
    context.fillStyle = colour("--overview");
    const width = canvas.width / this.overview.length;
    this.overview.forEach((load, bin) => {
      const height = (load / greatest) * canvas.height;
      context.fillRect(bin * width, canvas.height - height, width + 0.5, height);
    });
  }
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
