// Elements of a page, numbers and times as text, and what is told to who cannot see.

export const byId = (id) => document.getElementById(id);

/** An element with properties and children. Text is text, never markup. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (name.startsWith("aria-") || name.startsWith("data-") || ["for", "role", "list"].includes(name)) element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/** A button that does something; what goes wrong with it is told. */
export function button(text, act, properties = {}) {
  return make("button", { type: "button", textContent: text, onclick: () => attempt(act), ...properties });
}

/** A button for what cannot be undone: it wants to be pressed twice. */
export function carefulButton(text, what, act, properties = {}) {
  const label = `${text} ${what}`;
  const name = (short, long) => {
    one.textContent = short;
    one.setAttribute("aria-label", long);
  };
  const one = button(text, () => {
    if (one.textContent !== text) return act();
    name("Really?", `Really? ${label}`);
    say(`Press again: ${label}`);
    setTimeout(() => name(text, label), 5000);
    return undefined;
  }, { ...properties, "aria-label": label });
  return one;
}

/** Does something that may fail, and tells why. */
export async function attempt(act) {
  byId("wrong").hidden = true;
  try {
    return await act();
  } catch (error) {
    complain(error.message);
  }
}

/** Says something in the line at the foot of the page, and to screen readers. */
export function say(text) {
  byId("said").textContent = text;
}

/** Says what went wrong; it stays until it is put away. */
export function complain(text) {
  byId("said").textContent = "";
  byId("wrong-text").textContent = text;
  byId("wrong").hidden = false;
}

/** Gives a list new lines, where they have changed: the focus stays where it is on a line that has not. `lines` are [key, state, make()]. */
export function update(list, lines) {
  const known = new Map([...list.children].map((line) => [line.dataset.key, line]));
  const wanted = lines.map(([key, state, build]) => {
    const old = known.get(key);
    if (old?.dataset.state === state) return old;
    const line = build();
    Object.assign(line.dataset, { key, state });
    if (old) takeOver(old, line);
    return line;
  });
  const isSame = wanted.length === list.childElementCount && wanted.every((line, i) => list.children[i] === line);
  if (isSame) return;
  const focused = document.activeElement, of = focused?.closest("[data-key]"), at = [...list.children].indexOf(of);
  list.replaceChildren(...wanted);
  // Whoever was on a line that has changed is on the new one; on one that has gone, on the next.
  if (at < 0) return;
  const line = wanted.find((one) => one.dataset.key === of.dataset.key) || wanted[Math.min(at, wanted.length - 1)];
  const part = line === of ? focused : line?.querySelector(`[data-part="${CSS.escape(focused.dataset.part || "")}"]`) || line?.querySelector("button, summary");
  (part || list).focus({ preventScroll: true });
}

/** What was open in a line stays open. */
function takeOver(old, line) {
  for (const open of old.querySelectorAll("details[open][data-part]")) {
    line.querySelector(`details[data-part="${CSS.escape(open.dataset.part)}"]`)?.setAttribute("open", "");
  }
}

/** Four figures, without zeros at the end. */
export function short(x) {
  if (typeof x !== "number" || !Number.isFinite(x)) return "–";
  const size = Math.abs(x);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return x.toExponential(2).replace(/\.?0+e/, "e").replace("e+", "e");
  return String(Number(x.toPrecision(4)));
}

export const grouped = (count) => Math.round(count).toLocaleString("en").replaceAll(",", "\u202f");

export const percent = (share) => (typeof share === "number" ? (100 * share).toFixed(share > 0.1 ? 1 : 2) + " %" : "–");

export function bytes(count) {
  const units = ["bytes", "kB", "MB", "GB", "TB"];
  let at = 0;
  while (count >= 1000 && at < units.length - 1) {
    count /= 1000;
    at++;
  }
  return `${at ? Number(count.toPrecision(3)) : count} ${units[at]}`;
}

export function seconds(count) {
  if (!Number.isFinite(count)) return "–";
  if (count < 10) return count.toFixed(1) + " s";
  if (count < 100) return Math.round(count) + " s";
  return count < 6000 ? Math.round(count / 60) + " min" : (count / 3600).toFixed(1) + " h";
}
