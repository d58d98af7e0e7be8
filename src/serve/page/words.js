// Commands as words, and the same for a shell and for Python.

/** Options whose value may be left out: it must stand behind an equals sign. */
const JOINED = ["heal"];

/** Words of options that have a value, in their order; what has none is left out. */
export function options(named) {
  return Object.entries(named).flatMap(([name, value]) => {
    const text = (value || "").trim();
    if (!text) return [];
    return JOINED.includes(name) || text.startsWith("-") ? [`--${name}=${text}`] : [`--${name}`, text];
  });
}

/** The words of a line that was typed, as a shell splits it: quotes hold together. */
export function split(line) {
  const words = line.match(/(?:[^\s"']|"[^"]*"|'[^']*')+/g) || [];
  return words.map((word) => word.replace(/"([^"]*)"|'([^']*)'/g, "$1$2"));
}

const quoted = (word) => (/^[\w.,:=+\-/]+$/.test(word) ? word : "'" + word.replaceAll("'", "'\\''") + "'");

/** For a shell: one command a line. */
export function shell(steps) {
  return steps.map(({ command, words }) => ["geo-adapt", command, ...words.map(quoted)].join(" ")).join("\n");
}

/** For Python, with this service. */
export function python(steps, address) {
  const text = JSON.stringify, last = steps.at(-1);
  const line = ({ command, words, files, wants = [] }, i) => {
    const of = (name) => (wants.includes(name) ? `job.result(${text(name)})` : text(name));
    const read = words.filter((word) => wants.includes(word) || Object.hasOwn(files, word)).map((word) => `${text(word)}: ${of(word)}`);
    return `job = server.run(${text(command)}, [${words.map((word) => text(word)).join(", ")}], files={${read.join(", ")}})${i < steps.length - 1 ? ".wait()" : ""}`;
  };
  return ["import geo_adapt", "", `server = geo_adapt.connect(${text(address)})`, ...steps.map(line), ...(last ? [`job.wait().result(${text(last.output)}).save(".")`] : [])].join("\n");
}
