// SPDX-License-Identifier: MIT
// One frame, every layer: colour with exposure, depth, normals, ids, and the heat map of tests.

let opened = null;  // the EXR, its job and frame

const LAYERS = [
  ["colour", ["R", "G", "B"]], ["depth", ["Z"]], ["normal", ["N.X", "N.Y", "N.Z"]], ["object id", ["id.object"]],
  ["material id", ["id.material"]], ["albedo", ["albedo.R", "albedo.G", "albedo.B"]], ["position", ["P.X", "P.Y", "P.Z"]],
  ["texture coordinates", ["UV.X", "UV.Y"]], ["tests", ["tests"]],
];

async function openFrame(job, frame) {
  $("viewer-title").textContent = `Frame ${frame.frame}`;
  $("pixel").textContent = "Loading…";
  $("viewer-save").onclick = () => save(frame.exr, frame.exr.split("/").pop());
  $("viewer").showModal();
  try {
    const exr = await readExr(await (await ask(relative(frame.exr))).arrayBuffer());
    opened = { exr, job, frame };
    const before = $("layer").value;
    const there = LAYERS.filter(([, names]) => names.every((name) => name in exr.channels));
    $("layer").replaceChildren(...there.map(([name]) => element("option", { textContent: name })));
    if (there.some(([name]) => name === before)) $("layer").value = before;
    show();
    $("pixel").textContent = `${exr.width} × ${exr.height}. Point at a pixel for its value.`;
  } catch (error) {
    $("pixel").textContent = error.message;
    $("layer").replaceChildren();
    showPreview(await picture(frame));
  }
}

/** What can be shown of a frame whose layers cannot. */
function showPreview(bitmap) {
  const canvas = $("canvas");
  Object.assign(canvas, { width: bitmap.width, height: bitmap.height });
  canvas.getContext("2d").drawImage(bitmap, 0, 0);
}

function show() {
  if (!opened) return;
  const { exr } = opened;
  const layer = LAYERS.find(([name]) => name === $("layer").value);
  const canvas = $("canvas");
  Object.assign(canvas, { width: exr.width, height: exr.height });
  canvas.setAttribute("aria-label", `Frame ${opened.frame.frame}, ${layer[0]}`);
  const picture = new ImageData(exr.width, exr.height);
  const planes = layer[1].map((name) => exr.channels[name]);
  const gain = 2 ** Number($("exposure").value);
  painter(layer[0], planes, gain)(picture.data);
  canvas.getContext("2d").putImageData(picture, 0, 0);
}

/** What fills pixels from a layer's planes. */
function painter(name, planes, gain) {
  const paint = (colour) => (data) => {
    for (let i = 0; i < planes[0].length; i += 1) {
      const [red, green, blue] = colour(i);
      data[4 * i] = red; data[4 * i + 1] = green; data[4 * i + 2] = blue; data[4 * i + 3] = 255;
    }
  };
  if (name === "colour" || name === "albedo") return paint((i) => planes.map((plane) => curve(plane[i] * gain)));
  if (name === "normal") return paint((i) => planes.map((plane) => 127.5 * (1 + plane[i])));
  if (name.endsWith(" id")) return paint((i) => distinct(planes[0][i]));
  if (name === "position" || name === "texture coordinates") {
    const fraction = (value) => 255 * (value * gain - Math.floor(value * gain));
    return paint((i) => [0, 1, 2].map((axis) => (planes[axis] ? fraction(planes[axis][i]) : 0)));
  }
  const [least, most] = range(planes[0]);
  const scale = (value) => (most > least ? (value - least) / (most - least) : 0);
  if (name === "tests") return paint((i) => heat(scale(planes[0][i]) * gain));
  return paint((i) => (Number.isFinite(planes[0][i]) ? Array(3).fill(255 * Math.min(1, (1 - scale(planes[0][i])) * gain)) : [0, 0, 40]));
}

/** Least and greatest of what is finite, the outermost half percent apart. */
function range(plane) {
  const sample = Array.from(plane).filter(Number.isFinite).sort((a, b) => a - b);
  if (!sample.length) return [0, 1];
  return [sample[Math.floor(sample.length * 0.005)], sample[Math.min(sample.length - 1, Math.floor(sample.length * 0.995))]];
}

function curve(light) {
  const value = Math.min(1, Math.max(0, light));
  return 255 * (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055);
}

/** Neighbouring numbers far apart in hue. */
function distinct(number) {
  if (!Number.isFinite(number)) return [0, 0, 0];
  const hue = (number * 0.618033988749895) % 1;
  return [0, 1 / 3, 2 / 3].map((shift) => 90 + 75 * (1 + Math.cos(2 * Math.PI * (hue + shift))));
}

const HEAT = [[0, 0, 4], [66, 10, 104], [147, 38, 103], [221, 81, 58], [252, 165, 10], [252, 255, 164]];  // inferno, in steps

function heat(share) {
  const place = Math.min(1, Math.max(0, share || 0)) * (HEAT.length - 1);
  const [low, high] = [HEAT[Math.floor(place)], HEAT[Math.ceil(place)]];
  return low.map((value, i) => value + (high[i] - value) * (place % 1));
}

function probe(event) {
  if (!opened) return;
  const { exr } = opened;
  const box = $("canvas").getBoundingClientRect();
  const scale = Math.min(box.width / exr.width, box.height / exr.height);  // the picture may be letter-boxed
  const x = Math.floor((event.clientX - box.left - (box.width - exr.width * scale) / 2) / scale);
  const y = Math.floor((event.clientY - box.top - (box.height - exr.height * scale) / 2) / scale);
  if (x < 0 || y < 0 || x >= exr.width || y >= exr.height) return;
  const names = LAYERS.find(([name]) => name === $("layer").value)[1];
  const values = names.map((name) => `${name} ${Number(exr.channels[name][y * exr.width + x].toPrecision(5))}`);
  $("pixel").textContent = `(${x}, ${y}): ${values.join(", ")}`;
}

$("layer").addEventListener("change", show);
$("exposure").addEventListener("input", () => {
  $("exposure-value").value = Number($("exposure").value).toFixed(1);
  show();
});
$("canvas").addEventListener("pointermove", probe);
$("canvas").addEventListener("click", probe);
$("viewer-close").addEventListener("click", () => $("viewer").close());
$("viewer").addEventListener("close", () => { opened = null; });
$("viewer").addEventListener("keydown", (event) => {
  if (event.target.matches("input, select")) return;
  const step = { "+": 0.5, "=": 0.5, "-": -0.5 }[event.key];
  if (!step) return;
  $("exposure").value = Number($("exposure").value) + step;
  $("exposure").dispatchEvent(new Event("input"));
});
