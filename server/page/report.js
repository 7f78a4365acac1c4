// SPDX-License-Identifier: MIT
// The report of `sheaf-client report`, where the service has one or one was dropped: error against time for each scene.

let report = null;

/** Whether a JSON document is a report, and not a camera path. */
function isReport(document_) { return document_?.schema === 1 && Array.isArray(document_.scenes); }

function showReport(document_) {
  report = document_;
  const scenes = report.scenes.filter((scene) => points(scene).length);
  $("report").hidden = !scenes.length;
  const before = $("report-scene").value;
  $("report-scene").replaceChildren(...scenes.map((scene) => element("option", { textContent: scene.scene })));
  if (scenes.some((scene) => scene.scene === before)) $("report-scene").value = before;
  $("report-made").textContent = [report.device?.name, report.options?.size, report.made].filter(Boolean).join(" · ");
  drawReport();
}

/** What was measured with an error above zero: those without stand in the table alone, for the axis is logarithmic. */
function points(scene) {
  return [...(scene.knobs ?? []), ...(scene.strategies ?? [])].flatMap((trial) => {
    const [time, error] = [trial.wall_ms?.median, trial.error?.rmse];
    return time > 0 && Number.isFinite(error) ? [{ ...trial, time, rmse: error }] : [];
  });
}

function drawReport() {
  const scene = report?.scenes.find((each) => each.scene === $("report-scene").value);
  if (!scene) return;
  const all = points(scene);
  const front = all.filter((point) => point.pareto?.time).sort((a, b) => a.time - b.time);
  $("report-plot").replaceChildren(
    legend([["measured", COLOURS[9]], ["best for its time", COLOURS[1]], ["draft, production, exact", COLOURS[0]]]), scatter(all, front),
    table("Best for their time", ["settings", "time", "error (RMSE)"], front.map((point) => [[point.name, point.label].filter(Boolean).join(": "), milliseconds(point.time), point.rmse.toPrecision(3)])));
}

/** Ticks at powers of ten around the values. */
function decades(values) {
  const low = Math.floor(Math.log10(Math.min(...values))), high = Math.ceil(Math.log10(Math.max(...values)));
  return Array.from({ length: Math.max(1, high - low) + 1 }, (_, i) => low + i);
}

function scatter(all, front) {
  const shown = all.filter((point) => point.rmse > 0);
  const width = Math.max(300, Math.min(760, $("report").clientWidth - 32));
  const [high, left, right, top, bottom] = [Math.round(width * 0.6), 56, 26, 12, 40];
  const chart = svg("svg", { class: "chart", viewBox: `0 0 ${width} ${high}`, role: "img", "aria-label": "Error against time, both logarithmic" });
  chart.style.maxWidth = `${width}px`;
  if (!shown.length) return element("p", { className: "facts", textContent: "Every picture equals the reference." });
  const [times, errors] = [decades(shown.map((point) => point.time)), decades(shown.map((point) => point.rmse))];
  const across = (value) => left + ((Math.log10(value) - times[0]) / (times.at(-1) - times[0])) * (width - left - right);
  const down = (value) => high - bottom - ((Math.log10(value) - errors[0]) / (errors.at(-1) - errors[0])) * (high - top - bottom);
  for (const power of times) {
    const x = across(10 ** power);
    chart.append(svg("line", { x1: x, x2: x, y1: top, y2: high - bottom, class: "grid" }),
      svg("text", { x, y: high - bottom + 16, "text-anchor": "middle", class: "quiet" }, power < 3 ? `${10 ** power} ms` : `${10 ** (power - 3)} s`));
  }
  for (const power of errors) {
    const y = down(10 ** power);
    chart.append(svg("line", { x1: left, x2: width - right, y1: y, y2: y, class: "grid" }),
      svg("text", { x: left - 6, y: y + 4, "text-anchor": "end", class: "quiet" }, power < -3 ? `1e${power}` : String(10 ** power)));
  }
  chart.append(svg("text", { x: width - right, y: high - 6, "text-anchor": "end" }, "time of a frame"), svg("text", { x: 4, y: top + 2 }, "error"));
  const line = front.filter((point) => point.rmse > 0).map((point) => `${across(point.time)},${down(point.rmse)}`).join(" ");
  chart.append(svg("polyline", { points: line, fill: "none", stroke: COLOURS[1], "stroke-width": 2 }));
  for (const point of shown) {
    const colour = point.name ? COLOURS[0] : point.pareto?.time ? COLOURS[1] : COLOURS[9];
    chart.append(svg("circle", { cx: across(point.time), cy: down(point.rmse), r: point.name ? 6 : 4, fill: colour },
      svg("title", {}, `${[point.name, point.label].filter(Boolean).join(": ")}: ${milliseconds(point.time)}, error ${point.rmse.toPrecision(3)}`)));
  }
  return chart;
}

$("report-scene").addEventListener("change", drawReport);

/** The service's own; most have none. */
async function findReport() {
  const answer = await fetch("v1/report", { headers: headers() }).catch(() => null);
  const found = answer?.ok ? await answer.json().catch(() => null) : null;
  if (isReport(found)) showReport(found);
}
