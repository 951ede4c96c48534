// What is written over the picture: the contacts' labels, and the electrodes' numbers in shapes that tell their state.
// They are elements of the page, so they are sharp at any size; they move only when the picture is drawn.

import { Vector3 } from "three";

import { ringRadius } from "./contact_markers.js";
import { element, setText, svg } from "./element.js";
import { STATES } from "./electrode_states.js";
import { contactLabel, shortLabel } from "./words.js";

const LABEL_HEIGHT = 22;
const GAP = 6;
const EDGE = 4;

const SHAPES = {
  circle: () => svg("circle", { r: 9 }),
  square: () => svg("rect", { x: -9, y: -9, width: 18, height: 18 }),
  diamond: () => svg("path", { d: "M0,-13 L13,0 L0,13 L-13,0 Z" }),
  triangle: () => svg("path", { d: "M0,-14 L13,9 L-13,9 Z" }),
};

export class Labels {
  constructor(layer, scene) {
    this.scene = scene;
    this.contactLayer = element("div");
    this.electrodeLayer = svg("svg");
    layer.append(this.electrodeLayer, this.contactLayer);
    this.contacts = [];
    this.electrodes = [];
    this.outward = [];
  }

  setElectrodes(positions, frame) {
    const count = positions.length / 3;
    this.electrodes = Array.from({ length: count }, (_, i) => new Vector3().fromArray(positions, 3 * i));
    this.outward = this.electrodes.map((place) => outwardAt(place, frame));
    this.electrodeLayer.replaceChildren();
    this.states = "";
  }

  /** Shapes and colours of the electrodes; made anew only where they differ. */
  showElectrodes(states) {
    const key = JSON.stringify(states.map(({ state, colour }) => [state, colour]));
    if (key === this.states) return;
    this.states = key;
    this.electrodeLayer.replaceChildren(...states.map(electrodeMark));
    this.placeElectrodes();
  }

  showContacts(contacts) {
    this.contacts = contacts;
    while (this.contactLayer.children.length < contacts.length) this.contactLayer.append(element("span", { className: "contact" }));
    [...this.contactLayer.children].forEach((label, i) => {
      label.hidden = i >= contacts.length;
      if (!label.hidden) setText(label, (contacts[i].space ? shortLabel : contactLabel)(contacts[i]));
    });
  }

  setShown({ contacts, electrodes }) {
    this.contactLayer.hidden = !contacts;
    this.electrodeLayer.style.display = electrodes ? "" : "none";
  }

  /** Brings all to where the scene is. */
  place(isViewNew) {
    if (isViewNew) this.placeElectrodes();
    this.placeContacts();
  }

  placeElectrodes() {
    [...this.electrodeLayer.children].forEach((mark, i) => {
      const [x, y] = this.scene.project(this.electrodes[i]);
      mark.setAttribute("transform", `translate(${x.toFixed(1)},${y.toFixed(1)})`);
      const isAway = this.outward[i] !== undefined && !this.scene.faces(this.electrodes[i], this.outward[i]);
      mark.classList.toggle("is-away", isAway);
    });
  }

  // Above its ring, inside the picture; higher ones first, lower ones give way downwards.
  placeContacts() {
    const [width, height] = this.scene.size;
    const placed = [];
    const wanted = this.contacts.map((contact, i) => this.wantedPlace(contact, this.contactLayer.children[i]));
    for (const label of wanted.sort((a, b) => a.y - b.y)) {
      label.x = clamp(label.x, EDGE, width - label.width - EDGE);
      label.y = clamp(label.y, EDGE, height - LABEL_HEIGHT - EDGE);
      for (const other of placed) if (overlap(label, other)) label.y = other.y + LABEL_HEIGHT + 2;
      placed.push(label);
      label.node.style.transform = `translate(${label.x.toFixed(1)}px,${label.y.toFixed(1)}px)`;
    }
  }

  wantedPlace(contact, node) {
    const { scene } = this;
    const [x, y] = scene.project(contact.position);
    const ring = ringRadius(contact, scene.frame?.radius ?? 1) * scene.pointsPerMetre();
    const width = node.textContent.length * 7 + 14;
    node.classList.toggle("is-away", !scene.faces(contact.position, new Vector3().copy(contact.normal)));
    return { node, width, x: x - width / 2, y: y - ring - LABEL_HEIGHT - GAP };
  }
}

// Away from the middle of a curved skin; a flat one has no side of its electrodes that is hidden.
function outwardAt(place, { isFlat, centre, normal, radius }) {
  if (isFlat) return undefined;
  return place.clone().sub(centre).addScaledVector(normal, radius * 0.5).normalize();
}

function electrodeMark({ number, state, colour }) {
  const { shape, sign, word } = STATES[state];
  const mark = svg("g", { class: `electrode is-${state}` }, SHAPES[shape]());
  const isFilled = colour && state !== "open" && state !== "shorted";
  if (isFilled) mark.firstChild.style.fill = colour;
  const isDark = isFilled && luminance(colour) < 0.45;
  const text = svg("text", { class: isDark ? "on-dark" : "on-light" });
  text.textContent = number;
  const title = svg("title");
  title.textContent = `Electrode ${number}: ${word}`;
  mark.append(text, title);
  if (sign) {
    const extra = svg("text", { class: "sign", x: 15, y: -9 });
    extra.textContent = sign;
    mark.append(extra);
  }
  return mark;
}

function luminance(colour) {
  const [red, green, blue] = colour.match(/\d+/g).map(Number);
  return (0.299 * red + 0.587 * green + 0.114 * blue) / 255;
}

function overlap(a, b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && Math.abs(a.y - b.y) < LABEL_HEIGHT;
}

function clamp(value, low, high) {
  return Math.max(low, Math.min(high, value));
}
