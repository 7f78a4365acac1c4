// SPDX-License-Identifier: MIT
// The form for a new job: the files, what can be told about the scene before it is sent, and sending it.

let chosen = { scene: null, camera: null, beside: [] };

/** Sorts files into the scene, a camera path, and what lies beside the scene; a report is shown. */
async function choose(files) {
  const given = [...files];
  const reports = await Promise.all(given.map(readReport));
  reports.filter(Boolean).forEach(showReport);
  const list = given.filter((_, i) => !reports[i]);
  if (given.length && !list.length) return $("report").scrollIntoView();
  const ending = (file) => file.name.toLowerCase().split(".").pop();
  const scene = list.find((file) => ["glb", "gltf", "zip"].includes(ending(file)));
  const camera = list.find((file) => ending(file) === "json");
  chosen = { scene, camera, beside: list.filter((file) => file !== scene && file !== camera) };
  if (camera && !scene && window.lastScene) chosen = { ...window.lastScene, camera };
  window.lastScene = chosen;
  $("submit").disabled = !chosen.scene;
  showError("new-error", chosen.scene || !list.length ? "" : "None of these is a scene: .glb, .gltf or .zip.");
  $("drop-text").textContent = chosen.scene ? [chosen.scene, chosen.camera, ...chosen.beside].filter(Boolean).map((file) => file.name).join(", ")
    : "Drop a scene here, or choose: .glb, .zip, or .gltf with the files beside it.";
  describe();
}

/** A file's report; null where it is something else. */
async function readReport(file) {
  if (!file.name.toLowerCase().endsWith(".json")) return null;
  const found = await file.text().then(JSON.parse).catch(() => null);
  return isReport(found) ? found : null;
}

function showError(id, text) { $(id).textContent = text; $(id).hidden = !text; }

/** The scene's JSON; null where it is packed or broken: the service will say what is wrong with it. */
async function sceneDocument(file) {
  try {
    if (file.name.toLowerCase().endsWith(".gltf")) return JSON.parse(await file.text());
    const head = new DataView(await file.slice(0, 20).arrayBuffer());
    if (head.getUint32(0, true) !== 0x46546c67) return null;
    return JSON.parse(await file.slice(20, 20 + head.getUint32(12, true)).text());
  } catch {
    return null;
  }
}

/** Fills in what the scene offers: animations and how long they are, cameras. */
async function describe() {
  const scene = chosen.scene;
  const document_ = scene ? await sceneDocument(scene) : null;
  if (scene !== chosen.scene) return;
  const animations = document_?.animations ?? [];
  const cameras = (document_?.nodes ?? []).filter((node) => node.camera !== undefined);
  fill("animation", [["", "The first"], ["all", "All"], ...animations.map((each, i) => [String(i), each.name || `Number ${i}`])]);
  fill("camera-node", [["", chosen.camera ? "The camera path" : "The scene’s first"],
    ...cameras.map((node, i) => [node.name || String(i), node.name || `Number ${i}`])]);
  $("new").elements["camera-node"].disabled = Boolean(chosen.camera);
  const seconds = Math.max(0, ...animations.slice(0, 1).flatMap((each) => each.samplers ?? [])
    .map((sampler) => document_.accessors?.[sampler.input]?.max?.[0] ?? 0));
  const form = $("new").elements;
  if (document_) form.frames.value = seconds > 0 ? `0-${Math.max(0, Math.round(seconds * Number(form.fps.value)) - 1)}` : "0";
  const facts = document_ ? [`${document_.meshes?.length ?? 0} meshes`, `${animations.length} animations`, `${cameras.length} cameras`,
    seconds ? `${seconds.toFixed(1)} s` : "stands still"] : [];
  if (scene) facts.unshift(bytes(scene.size));
  $("scene-facts").textContent = facts.join(" · ");
  $("scene-facts").hidden = !facts.length;
}

function fill(name, entries) {
  $("new").elements[name].replaceChildren(...entries.map(([value, text]) => element("option", { value, textContent: text })));
}

function bytes(count) {
  const units = ["B", "KiB", "MiB", "GiB"];
  const power = Math.min(3, Math.floor(Math.log2(Math.max(1, count)) / 10));
  return `${(count / 1024 ** power).toFixed(power ? 1 : 0)} ${units[power]}`;
}

/** The settings that were chosen: what happens anyway is not sent, so that a job tells what somebody chose. */
function settings() {
  const form = new FormData($("new"));
  const wanted = { frames: form.get("frames").replace(/\s/g, ""), size: form.get("size"), quality: form.get("quality") };
  const others = Object.entries(SETTINGS).filter(([name, schema]) => !(name in wanted) && schema["x-visitors"]);
  for (const [name, schema] of others) wanted[name] = valueOf(form, name, schema);
  return Object.fromEntries(Object.entries(wanted).filter(([, value]) => value !== undefined));
}

async function submit(event) {
  event.preventDefault();
  const body = new FormData();
  body.append("settings", new Blob([JSON.stringify(settings())], { type: "application/json" }), "settings.json");
  if (chosen.camera) body.append("camera", chosen.camera, chosen.camera.name);
  body.append("scene", chosen.scene, chosen.scene.name);
  for (const file of chosen.beside) body.append("file", file, file.webkitRelativePath.split("/").slice(1).join("/") || file.name);
  showError("new-error", "");
  $("submit").disabled = true;
  $("upload").hidden = false;
  try {
    const job = await upload("v1/jobs", body, (share) => { $("upload").value = share; });
    await refreshJobs();
    select(job.id, true);
  } catch (error) {
    showError("new-error", error.message);
  } finally {
    $("submit").disabled = !chosen.scene;
    $("upload").hidden = true;
  }
}

$("files").addEventListener("change", () => choose($("files").files));
$("new").addEventListener("submit", submit);
for (const type of ["dragover", "dragleave", "drop"]) {
  document.addEventListener(type, (event) => {
    event.preventDefault();
    $("drop").classList.toggle("over", type === "dragover");
    if (type === "drop" && event.dataTransfer.files.length) choose(event.dataTransfer.files);
  });
}
