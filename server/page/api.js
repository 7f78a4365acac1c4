// SPDX-License-Identifier: MIT
// What the page asks the service. All scripts of the page share one scope, in the order that page.cmake lists them.
"use strict";

const $ = (id) => document.getElementById(id);

/** An element with properties and children. */
function element(name, properties = {}, ...children) {
  const { dataset, ...rest } = properties;
  const node = Object.assign(document.createElement(name), rest);
  for (const key of ["aria-current", "aria-label", "role"]) if (key in rest) node.setAttribute(key, rest[key]);
  Object.assign(node.dataset, dataset);
  node.append(...children);
  return node;
}

/** What the service refused, in its own words. */
class Refusal extends Error {
  constructor(status, problem) {
    super(problem.detail ? `${problem.title}: ${problem.detail}` : problem.title || `The service answered ${status}.`);
    this.status = status;
  }
}

function token() { return sessionStorage.getItem("sheaf-token") ?? ""; }

function headers(more = {}) { return token() ? { ...more, Authorization: `Bearer ${token()}` } : more; }

async function ask(path, options = {}) {
  const answer = await fetch(path, { ...options, headers: headers(options.headers) });
  if (answer.ok) return answer;
  const problem = await answer.json().catch(() => ({}));
  if (answer.status === 401) askForToken();
  throw new Refusal(answer.status, problem);
}

async function askJson(path, options) { return (await ask(path, options)).json(); }

// Links of the service begin with "/"; behind a proxy the page may be elsewhere.
function relative(link) { return link.replace(/^\//, ""); }

function askForToken() {
  if ($("token-dialog").open) return;
  $("token").value = token();
  $("token-dialog").showModal();
}

$("token-button").addEventListener("click", askForToken);
$("token-dialog").addEventListener("close", () => {
  if ($("token-dialog").returnValue !== "ok") return;
  sessionStorage.setItem("sheaf-token", $("token").value);
  document.dispatchEvent(new Event("token"));
});

/** Sends a form with progress, which fetch cannot tell. */
function upload(path, form, onProgress) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", path);
    for (const [name, value] of Object.entries(headers({ "Idempotency-Key": randomKey() }))) request.setRequestHeader(name, value);
    request.responseType = "json";
    request.upload.addEventListener("progress", (event) => onProgress(event.total ? event.loaded / event.total : 0));
    request.addEventListener("error", () => reject(new Error("The connection was lost.")));
    request.addEventListener("load", () => {
      if (request.status === 202) resolve(request.response);
      else {
        if (request.status === 401) askForToken();
        reject(new Refusal(request.status, request.response ?? {}));
      }
    });
    request.send(form);
  });
}

function randomKey() {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/**
 * Calls `hear` with every event of a job until it is over, `signal` aborts, or the service does not stream; gives whether
 * the job's last event came. Reads the stream itself, for an EventSource can send no token.
 */
async function listen(link, after, hear, signal) {
  const answer = await ask(link, { signal, headers: { Accept: "text/event-stream", ...(after ? { "Last-Event-ID": after } : {}) } });
  if (answer.status === 204) return true;
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return false;
    text += value;
    const parts = text.split(/\r?\n\r?\n/);
    text = parts.pop();
    for (const part of parts) {
      const fields = Object.fromEntries(part.split(/\r?\n/).filter((line) => !line.startsWith(":"))
        .map((line) => [line.slice(0, line.indexOf(":")), line.slice(line.indexOf(":") + 1).trimStart()]));
      if (fields.data) hear({ id: fields.id, event: fields.event, data: JSON.parse(fields.data) });
    }
  }
}

const pause = (ms, signal) => new Promise((resolve) => {
  const timer = setTimeout(resolve, ms);
  signal?.addEventListener("abort", () => { clearTimeout(timer); resolve(); }, { once: true });
});
