// Elements of the page. Text is set as text, never as markup.

/** The element with this id. */
export function byId(id) {
  return document.getElementById(id);
}

/** A new element: `properties` are set on it, those with a dash or of `data`, `aria` and `role` as attributes. */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-") || name === "role" || name === "for") made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children.map((child) => (child instanceof Node ? child : document.createTextNode(String(child)))));
  return made;
}

export function svg(tag, attributes = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** Sets the text where it has changed, so that screen readers and the layout rest. */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** As many children of `parent` as `items`, made by `make` and brought up to date by `update(child, item)`. */
export function eachChild(parent, items, make, update) {
  while (parent.children.length > items.length) parent.lastElementChild.remove();
  while (parent.children.length < items.length) parent.append(make());
  items.forEach((item, i) => update(parent.children[i], item, i));
}
