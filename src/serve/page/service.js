// Requests to the service. Where it wants a token, who looks after that is asked, and the request goes again.

/** What the service says is wrong. */
export class Problem extends Error {
  constructor(status, message) {
    super(message);
    this.status = status;
  }
}

/** Asks for a token; set by the session. */
let wantsToken = async () => false;
export const onToken = (ask) => { wantsToken = ask; };

function problemOf(status, text) {
  try {
    return new Problem(status, JSON.parse(text).detail || text);
  } catch {
    return new Problem(status, text || `the service answers ${status}`);
  }
}

async function send(method, path, body) {
  const options = { method, credentials: "same-origin", cache: "no-store" };
  if (body !== undefined) Object.assign(options, { body: JSON.stringify(body), headers: { "Content-Type": "application/json" } });
  try {
    return await fetch(path, options);
  } catch {
    throw new Problem(0, "The service does not answer.");
  }
}

/** The answer to a request, as text. */
export async function textOf(method, path, body) {
  let answer = await send(method, path, body);
  for (let tries = 1; answer.status === 429 && method === "GET" && tries < 9; tries++) {
    await new Promise((resolve) => setTimeout(resolve, 500 * tries));
    answer = await send(method, path, body);
  }
  while (answer.status === 401 && path !== "/v1/session" && await wantsToken()) answer = await send(method, path, body);
  const text = await answer.text();
  if (!answer.ok) throw problemOf(answer.status, text);
  return text;
}

/** The answer to a request, of JSON. */
export async function ask(method, path, body) {
  const text = await textOf(method, path, body);
  return text ? JSON.parse(text) : null;
}

/** A request with bytes as its body; fetch cannot tell how much of them has gone. Returns {status, text, header(name)}. */
export function transmit(method, path, blob, headers, went) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open(method, path);
    for (const [name, value] of Object.entries(headers)) request.setRequestHeader(name, value);
    request.upload.onprogress = (event) => went(event.loaded);
    request.onload = () => {
      if (request.status >= 400) reject(problemOf(request.status, request.responseText));
      else resolve({ status: request.status, text: request.responseText, header: (name) => request.getResponseHeader(name) });
    };
    request.onerror = () => reject(new Problem(0, "The service does not answer."));
    request.send(blob);
  });
}

export const jobPath = (id, ...rest) => ["/v1/jobs", id, ...rest].map((part, i) => (i ? encodeURIComponent(part) : part)).join("/");
export const resultPath = (id, name) => jobPath(id, "results", name);
