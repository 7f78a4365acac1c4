// SPDX-License-Identifier: MIT
// The frames of a job, one after the other, as far as they are rendered.

const player = { job: null, at: 0, timer: 0, pictures: new Map(), following: true, asked: 0 };
const PICTURES_KEPT = 240;

const rendered = () => (player.job?.frames ?? []).filter((frame) => frame.state === "done" && frame.png);

/** Takes over a job's state; shows the newest frame as long as nobody has chosen one. */
function feedPlayer(job) {
  if (player.job?.id !== job.id) {
    stop();
    for (const picture of player.pictures.values()) picture.then((bitmap) => bitmap.close(), () => {});
    player.pictures.clear();
    Object.assign(player, { at: 0, following: true });
  }
  const before = player.job?.id === job.id ? rendered().length : 0;
  player.job = job;
  const frames = rendered();
  $("player").hidden = !frames.length;
  $("scrub").max = Math.max(0, frames.length - 1);
  strip(job);
  if (frames.length && (frames.length !== before)) seek(player.following ? frames.length - 1 : player.at, false);
}

function strip(job) {
  const frames = rendered();
  $("strip").replaceChildren(...job.frames.map((frame) => {
    const index = frames.indexOf(frame);
    const button = element("button", { type: "button", textContent: String(frame.frame), disabled: index < 0, onclick: () => seek(index) });
    button.title = frame.wall_ms ? `${frame.wall_ms.toFixed(0)} ms` : frame.state;
    if (index === player.at) button.setAttribute("aria-current", "true");
    return element("li", { className: frame.state }, button);
  }));
}

function picture(frame) {
  const kept = player.pictures;
  if (!kept.has(frame.png)) {
    kept.set(frame.png, ask(relative(frame.png)).then((answer) => answer.blob()).then((blob) => createImageBitmap(blob)));
    kept.get(frame.png).catch(() => kept.delete(frame.png));
    if (kept.size > PICTURES_KEPT) {
      const [oldest, bitmap] = kept.entries().next().value;
      kept.delete(oldest);
      bitmap.then((each) => each.close(), () => {});
    }
  }
  return kept.get(frame.png);
}

async function seek(index, byHand = true) {
  const frames = rendered();
  if (!frames.length) return;
  if (byHand) player.following = false;
  player.at = Math.min(frames.length - 1, Math.max(0, index));
  const frame = frames[player.at];
  $("scrub").value = player.at;
  $("scrub").setAttribute("aria-valuetext", `frame ${frame.frame}`);
  $("frame-number").value = String(frame.frame);
  for (const [i, item] of [...$("strip").children].entries()) {
    item.firstChild.toggleAttribute("aria-current", false);
    if (player.job.frames[i] === frame) item.firstChild.setAttribute("aria-current", "true");
  }
  const asked = (player.asked += 1);
  const bitmap = await picture(frame).catch(() => null);
  if (!bitmap || asked !== player.asked) return;  // a later one was asked for meanwhile
  const screen = $("screen");
  if (screen.width !== bitmap.width || screen.height !== bitmap.height) Object.assign(screen, { width: bitmap.width, height: bitmap.height });
  screen.getContext("2d").drawImage(bitmap, 0, 0);
  screen.setAttribute("aria-label", `Frame ${frame.frame} of ${player.job.scene.name}`);
  screen.dataset.frame = frame.frame;
}

function play() {
  const fps = Number(player.job.settings.fps) || 24;
  $("play").textContent = "Pause";
  $("play").setAttribute("aria-pressed", "true");
  const begun = { at: player.at === rendered().length - 1 ? 0 : player.at, time: performance.now() };
  for (const frame of rendered().slice(0, PICTURES_KEPT)) picture(frame);
  const step = async (now) => {
    const index = begun.at + Math.floor(((now - begun.time) / 1000) * fps);
    await seek(index % rendered().length);
    if (player.timer) player.timer = requestAnimationFrame(step);
  };
  player.timer = requestAnimationFrame(step);
}

function stop() {
  cancelAnimationFrame(player.timer);
  player.timer = 0;
  $("play").textContent = "Play";
  $("play").setAttribute("aria-pressed", "false");
}

$("play").addEventListener("click", () => (player.timer ? stop() : play()));
$("back").addEventListener("click", () => { stop(); seek(player.at - 1); });
$("forth").addEventListener("click", () => { stop(); seek(player.at + 1); });
$("scrub").addEventListener("input", () => { stop(); seek(Number($("scrub").value)); });
$("open").addEventListener("click", () => { stop(); openFrame(player.job, rendered()[player.at]); });
document.addEventListener("keydown", (event) => {
  if ($("player").hidden || document.querySelector("dialog[open]") || event.target.closest("input, select, button, a, summary")) return;
  const act = { " ": () => $("play").click(), ArrowLeft: () => $("back").click(), ArrowRight: () => $("forth").click(), Enter: () => $("open").click() };
  if (!act[event.key]) return;
  event.preventDefault();
  act[event.key]();
});
