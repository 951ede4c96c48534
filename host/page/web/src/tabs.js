// The panels and their tabs, as in https://www.w3.org/WAI/ARIA/apg/patterns/tabs/: one is seen at a time.

import { byId, element } from "./element.js";

export const PANELS = [
  { name: "contacts", title: "Contacts" },
  { name: "plots", title: "Plots" },
  { name: "settings", title: "Settings" },
  { name: "electrodes", title: "Electrodes" },
  { name: "calibrate", title: "Calibrate" },
  { name: "scope", title: "Scope" },
];

export class Tabs {
  /** `onSelect(name)` is called when a panel is brought up. */
  constructor(onSelect) {
    this.onSelect = onSelect;
    this.selected = undefined;
    byId("tabs").append(...PANELS.map((panel, i) => this.makeTab(panel, i)));
    byId("tabs").addEventListener("keydown", (event) => this.move(event));
    for (const { name } of PANELS) {
      byId(`panel-${name}`).setAttribute("role", "tabpanel");
      byId(`panel-${name}`).setAttribute("aria-labelledby", `tab-${name}`);
    }
  }

  makeTab({ name, title }, i) {
    const tab = element("button", {
      type: "button",
      id: `tab-${name}`,
      role: "tab",
      "aria-controls": `panel-${name}`,
      title: `${title} (${i + 1})`,
    }, title);
    tab.addEventListener("click", () => this.select(name));
    return tab;
  }

  select(selected) {
    this.selected = selected;
    for (const { name } of PANELS) {
      const tab = byId(`tab-${name}`);
      tab.setAttribute("aria-selected", String(name === selected));
      tab.tabIndex = name === selected ? 0 : -1;
      byId(`panel-${name}`).hidden = name !== selected;
    }
    this.onSelect(selected);
  }

  move(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const index = PANELS.findIndex(({ name }) => name === this.selected);
    const next = PANELS[(index + step + PANELS.length) % PANELS.length].name;
    this.select(next);
    byId(`tab-${next}`).focus();
  }
}
