// SPDX-License-Identifier: MIT
// What the engine measured: bars of stage times, tests per ray, tests by level, as SVG and tables.

const COLOURS = ["#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#b07aa1", "#76b7b2", "#edc948", "#9c755f", "#ff9da7", "#bab0ac"];
const KINDS = ["primary", "shadow", "reflection", "refraction"];

function svg(name, attributes = {}, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

function brief(value) {
  if (value === undefined || value === null || !Number.isFinite(value)) return "–";
  for (const [limit, letter] of [[1e9, "G"], [1e6, "M"], [1e3, "k"]]) if (value >= limit) return `${(value / limit).toPrecision(3)} ${letter}`;
  return value >= 100 || Number.isInteger(value) ? value.toFixed(0) : value.toPrecision(3);
}

function legend(entries) {
  return element("ul", { className: "legend" }, ...entries.map(([name, colour]) => {
    const mark = element("i");
    mark.style.background = colour;
    return element("li", {}, mark, name);
  }));
}

function milliseconds(value) { return value >= 10000 ? `${(value / 1000).toPrecision(3)} s` : `${brief(value)} ms`; }

/** Horizontal stacked bars: rows of { label, parts: [[name, value, colour]] }; `say` puts a value in words. */
function bars(rows, say, words) {
  // As wide as there is room for, so that text keeps its size on a phone.
  const width = Math.max(300, Math.min(900, $("job-body").clientWidth));
  const [left, right, high] = [12 + 6.6 * Math.max(0, ...rows.map((row) => row.label.length)), 64, 20];
  const most = Math.max(1e-9, ...rows.map((row) => row.parts.reduce((sum, [, value]) => sum + value, 0)));
  const chart = svg("svg", { class: "chart", viewBox: `0 0 ${width} ${rows.length * (high + 4) + 4}`, role: "img", "aria-label": words });
  rows.forEach((row, index) => {
    const y = index * (high + 4) + 2;
    chart.append(svg("text", { x: left - 6, y: y + 14, "text-anchor": "end" }, row.label));
    let x = left;
    for (const [name, value, colour] of row.parts) {
      const wide = (value / most) * (width - left - right);
      chart.append(svg("rect", { x, y, width: Math.max(0, wide), height: high, fill: colour },
        svg("title", {}, `${name}: ${say(value)}`)));
      x += wide;
    }
    const sum = row.parts.reduce((total, [, value]) => total + value, 0);
    chart.append(svg("text", { x: x + 6, y: y + 14, class: "quiet" }, say(sum)));
  });
  return chart;
}

function stageChart(stats) {
  const frames = stats.frames.filter((frame) => !frame.repeated);
  const total = {};
  for (const frame of frames) for (const [name, ms] of Object.entries(frame.stages ?? {})) total[name] = (total[name] ?? 0) + ms;
  const names = Object.keys(total);
  const main = [...names].sort((a, b) => total[b] - total[a]).slice(0, 9);
  const colour = (name) => COLOURS[main.includes(name) ? main.indexOf(name) : 9];
  const shown = frames.length > 24 ? frames.filter((_, i) => i % Math.ceil(frames.length / 24) === 0) : frames;
  const rows = shown.map((frame) => ({
    label: `frame ${frame.frame}`,
    parts: names.filter((name) => frame.stages?.[name]).map((name) => [name, frame.stages[name], colour(name)]),
  }));
  const entries = names.length > 9 ? [...main.map((name) => [name, colour(name)]), ["others", COLOURS[9]]] : main.map((name) => [name, colour(name)]);
  $("stages").replaceChildren(legend(entries), bars(rows, milliseconds, "Device time of each frame by stage"));
}

/** Tests a ray of each kind, of one job or two; and how many rays were sorted. */
function testChart(jobs) {
  const sorts = [["node_object", "nodes against objects"], ["ray_box", "rays against boxes"], ["ray_triangle", "rays against triangles"]];
  const rows = [];
  for (const kind of KINDS) {
    for (const { label, stats } of jobs) {
      const { rays = {}, tests = {} } = stats.totals;
      if (!rays[kind]) continue;
      rows.push({
        label: jobs.length > 1 ? `${kind}, ${label}` : kind,
        parts: sorts.map(([name, words], i) => [words, (tests[name]?.[kind] ?? 0) / rays[kind], COLOURS[i]]),
      });
    }
  }
  const body = jobs.flatMap(({ label, stats }) => KINDS.filter((kind) => stats.totals.rays?.[kind]).map((kind) => {
    const lists = stats.frames.flatMap((frame) => frame.generations ?? []).filter((list) => list.kind === kind);
    const sorted = lists.filter((list) => list.sorted).reduce((sum, list) => sum + list.rays, 0);
    const all = lists.reduce((sum, list) => sum + list.rays, 0);
    const saved = stats.totals.reduction_vs_brute_force_by_kind?.[kind];
    return [jobs.length > 1 ? `${kind}, ${label}` : kind, brief(stats.totals.rays[kind]), all ? `${((100 * sorted) / all).toFixed(0)} %` : "–",
      brief(stats.totals.tests_per_ray_by_kind?.[kind]), saved === undefined || saved === null ? "–" : `${(100 * saved).toFixed(2)} %`];
  }));
  $("tests").replaceChildren(legend(sorts.map(([, words], i) => [words, COLOURS[i]])), bars(rows, brief, "Intersection tests per ray by kind of ray"),
    table("Tests per ray", ["rays", "how many", "sorted", "tests per ray", "saved of brute force"], body));
}

/** A table in a box that scrolls by itself, by keyboard too. */
function table(words, head, body) {
  return element("div", { className: "wide", tabIndex: 0, role: "region", "aria-label": words }, element("table", {},
    element("thead", {}, element("tr", {}, ...head.map((text) => element("th", { scope: "col", textContent: text })))),
    element("tbody", {}, ...body.map((row) => element("tr", {}, ...row.map((text) => element("td", { textContent: text })))))));
}

function levelTable(jobs) {
  const sums = jobs.map(({ label, stats }) => {
    const levels = {};
    for (const frame of stats.frames) {
      for (const [kind, counts] of Object.entries(frame.tests?.node_object_by_level ?? {})) {
        levels[kind] ??= [];
        counts.forEach((count, level) => { levels[kind][level] = (levels[kind][level] ?? 0) + count; });
      }
    }
    return { label, levels };
  });
  const rows = sums.flatMap(({ label, levels }) => KINDS.filter((kind) => levels[kind]?.some(Boolean))
    .map((kind) => [jobs.length > 1 ? `${kind}, ${label}` : kind, ...levels[kind].map(brief)]));
  const most = Math.max(0, ...rows.map((row) => row.length - 1));
  const full = rows.map((row) => [...row, ...Array(most - row.length + 1).fill("")]);
  $("levels").replaceChildren(rows.length ? table("Tests by level", ["rays", ...Array.from({ length: most }, (_, i) => (i ? `level ${i}` : "roots"))], full)
    : element("p", { className: "facts", textContent: "No rays’ hierarchy was used." }));
}

function leftOut(stats) {
  const entries = (stats.left_out ?? []).map(({ stage, reason }) => element("li", {}, element("strong", { textContent: stage }), `: ${reason}`));
  $("left-out").replaceChildren(...(entries.length ? entries : [element("li", { textContent: "nothing" })]));
}
