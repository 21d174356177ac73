// Elements of the page. Text is inserted as text nodes, so that no name in a report becomes markup.

/** Creates an HTML element: h("a", {href: "#x", onclick: f, class: "y"}, "words", otherElement). */
export function h(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** Creates an SVG element; same arguments as h(). */
export function s(tag, attributes = {}, ...children) {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  for (const child of children.flat()) {
    if (child === undefined || child === null || child === false) continue;
    element.append(child instanceof Node ? child : document.createTextNode(String(child)));
  }
  return element;
}

let ids = 0;
export const newId = (prefix) => `${prefix}-${++ids}`;

/** A select box with its label: choices are {value, name}, or groups {name, choices}. */
export function choice(label, choices, value, change) {
  const id = newId("choice");
  const option = (c) => (c.choices ? h("optgroup", { label: c.name }, c.choices.map(option)) : h("option", { value: c.value }, c.name));
  const select = h("select", { id, onchange: () => change(select.value) }, choices.map(option));
  const element = h("span", { class: "choice" }, h("label", { for: id }, label), select);
  element.show = (to) => (select.value = to);
  element.show(value);
  return element;
}

/** Buttons, one of them pressed: choices are {value, name}. A click calls `change`; `press(value)` shows the pressed one. */
export function switches(label, choices, value, change) {
  const buttons = choices.map((c) => h("button", { type: "button", onclick: () => change(c.value) }, c.name));
  const group = h("span", { class: "switches", role: "group", "aria-label": label }, buttons);
  group.press = (to) => buttons.forEach((b, i) => b.setAttribute("aria-pressed", String(choices[i].value === to)));
  group.press(value);
  return group;
}
