// SPDX-License-Identifier: MIT
// The list of jobs, and the one that is looked at: its state, what it measured, what can be done with it.

const page = { jobs: [], next: null, selected: null, watching: null, measured: null };
const OVER = ["done", "failed", "cancelled"];
const LIST_MS = 4000;

async function refreshJobs() {
  try {
    const answer = await askJson("v1/jobs?limit=20");
    const older = page.jobs.slice(20).filter((job) => !answer.jobs.some((each) => each.id === job.id));
    page.jobs = [...answer.jobs, ...older];
    if (!older.length) page.next = answer.next;
    drawJobs();
  } catch (error) {
    $("health").textContent = error instanceof Refusal ? error.message : "The service does not answer.";
  }
}

function drawJobs() {
  document.body.classList.toggle("none", !page.selected);
  const focused = document.activeElement?.dataset?.job;
  $("jobs").replaceChildren(...(page.jobs.length ? page.jobs.map((job) => {
    const button = element("button", { type: "button", dataset: { job: job.id }, onclick: () => select(job.id, true) },
      element("span", { className: "name", textContent: job.scene.name }), stateMark(job),
      element("small", { textContent: `${job.progress.done}/${job.progress.total ?? "?"} frames` }),
      element("small", { textContent: new Date(job.created).toLocaleTimeString() }));
    if (job.id === page.selected) button.setAttribute("aria-current", "true");
    return element("li", {}, button);
  }) : [element("li", { className: "facts", textContent: "None yet." })]));
  if (focused) $("jobs").querySelector(`[data-job="${focused}"]`)?.focus();
  $("more").hidden = !page.next;
  const others = page.jobs.filter((job) => job.id !== page.selected && job.state === "done");
  const before = $("compare").value;
  $("compare").replaceChildren(element("option", { value: "", textContent: "no other job" }), ...others.map((job) =>
    element("option", { value: job.id, textContent: `${job.scene.name}, ${ways(job)}, ${new Date(job.created).toLocaleTimeString()}` })));
  if (others.some((job) => job.id === before)) $("compare").value = before;
}

function stateMark(job) {
  const text = job.cancel_requested && !OVER.includes(job.state) ? "stopping" : job.state;
  return element("span", { className: `state ${job.state}`, textContent: text });
}

function ways(job) {
  const { strategy = "auto", sort, primary } = job.settings;
  return [strategy, sort && `sort ${sort}`, primary === "trace" && "traced"].filter(Boolean).join(" ");
}

/** Looks at a job, and follows it while it goes on. */
async function select(id, byHand = false) {
  page.watching?.abort();
  page.watching = new AbortController();
  page.selected = id;
  page.measured = null;
  if (byHand) history.replaceState(null, "", `#job=${id}`);
  drawJobs();
  if (byHand && matchMedia("(max-width: 52rem)").matches) $("job").scrollIntoView();
  await follow(id, page.watching.signal);
}

async function follow(id, signal) {
  let last = null;
  let stale = null;
  const refresh = async () => {
    const job = await askJson(`v1/jobs/${id}`, { signal });
    if (!signal.aborted) await drawJob(job);
    return job;
  };
  const soon = () => { stale ??= setTimeout(() => { stale = null; if (!signal.aborted) refresh().catch(() => {}); }, 250); };
  while (!signal.aborted) {
    try {
      const job = await refresh();
      if (OVER.includes(job.state)) return;
      await listen(relative(job.links.events), last, (event) => { last = event.id ?? last; soon(); }, signal);
    } catch (error) {
      if (signal.aborted) return;
      if (error.status === 404 || error.status === 410) { gone(error); return; }
    }
    await pause(1500, signal);  // the stream ended, broke, or there are too many: ask again in a while
  }
}

function gone(error) {
  $("job-title").textContent = "No job chosen";
  $("job-hint").textContent = error.message;
  $("job-hint").hidden = false;
  $("job-body").hidden = true;
  refreshJobs();
}

async function drawJob(job) {
  $("job-hint").hidden = true;
  $("job-body").hidden = false;
  $("job-title").textContent = job.scene.name;
  $("job-state").replaceWith(Object.assign(stateMark(job), { id: "job-state" }));
  const { done, total, fraction, eta_s: eta } = job.progress;
  const left = eta && job.state === "running" ? `, ${duration(eta)} left` : "";
  $("job-words").textContent = job.state === "queued" ? "waits for its turn" : `${done} of ${total ?? "?"} frames${left} · ${ways(job)}`;
  $("job-progress").value = OVER.includes(job.state) ? (total ? done / total : 0) : fraction;
  showError("job-error", job.error ? `${job.error.title}: ${job.error.message}` : "");
  $("job-warnings").hidden = !job.warnings.length;
  $("job-warnings").replaceChildren(...job.warnings.map((text) => element("li", { textContent: text })));
  actions(job);
  feedPlayer(job);
  const known = page.jobs.find((each) => each.id === job.id);
  if (known) { Object.assign(known, job); drawJobs(); }
  if (job.progress.done && OVER.includes(job.state)) await drawStats(job);
  else $("stats").hidden = true;
}

function duration(seconds) {
  const whole = Math.max(0, Math.round(seconds));
  return whole < 60 ? `${whole} s` : whole < 3600 ? `${Math.floor(whole / 60)} min ${whole % 60} s` : `${Math.floor(whole / 3600)} h ${Math.floor(whole / 60) % 60} min`;
}

function actions(job) {
  const over = OVER.includes(job.state);
  const act = (text, run, danger = false) => element("button", { type: "button", textContent: text, className: danger ? "danger" : "", onclick: run });
  const buttons = [];
  if (job.progress.done && over) buttons.push(act("All frames (.zip)", () => save(job.links.frames_zip, `${job.scene.name.split("/").pop()}.zip`)));
  if (job.progress.done) buttons.push(act("Stats", () => save(job.links.stats, "stats.json")), act("Table", () => save(job.links.stats_csv, "stats.csv")));
  buttons.push(act("Log", () => save(job.links.log, "log.txt")));
  buttons.push(over ? act("Remove", () => remove(job, `Remove ${job.scene.name} with all its frames?`), true)
    : act("Cancel", () => cancel(job), true));
  $("job-actions").replaceChildren(...buttons);
}

async function save(link, name) {
  try {
    const url = URL.createObjectURL(await (await ask(relative(link))).blob());
    element("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 60000);
  } catch (error) { showError("job-error", error.message); }
}

async function cancel(job) {
  try {
    await ask(`${relative(job.links.self)}/cancel`, { method: "POST" });
    select(job.id);
  } catch (error) { showError("job-error", error.message); }
}

async function remove(job, question) {
  if (!confirm(question)) return;
  try {
    await ask(relative(job.links.self), { method: "DELETE" });
    page.jobs = page.jobs.filter((each) => each.id !== job.id);
    page.watching?.abort();
    page.selected = null;
    gone(new Error("Send a scene, or choose one of the jobs."));
  } catch (error) { showError("job-error", error.message); }
}

async function drawStats(job) {
  if (page.measured?.id !== job.id) {
    const stats = await askJson(relative(job.links.stats)).catch(() => null);
    if (page.selected !== job.id) return;
    page.measured = { id: job.id, job, stats };
  }
  const { stats } = page.measured;
  $("stats").hidden = !stats?.frames?.length;
  if ($("stats").hidden) return;
  stageChart(stats);
  leftOut(stats);
  const shown = [{ label: ways(job), stats }];
  const other = page.jobs.find((each) => each.id === $("compare").value);
  if (other) {
    const more = await askJson(relative(other.links.stats)).catch(() => null);
    if (more?.frames?.length) shown.push({ label: ways(other), stats: more });
  }
  testChart(shown);
  levelTable(shown);
}

async function refreshHealth() {
  const answer = await fetch("readyz").catch(() => null);
  const body = await answer?.json().catch(() => null);
  $("health").textContent = answer?.ok ? "Ready" : body ? `Not ready: ${body.detail ?? body.title}` : "The service does not answer.";
}

$("compare").addEventListener("change", () => page.measured && drawStats(page.measured.job));
$("more").addEventListener("click", async () => {
  const answer = await askJson(`v1/jobs?limit=20&cursor=${encodeURIComponent(page.next)}`);
  page.jobs.push(...answer.jobs);
  page.next = answer.next;
  drawJobs();
});
document.addEventListener("token", () => { refreshJobs(); findReport(); if (page.selected) select(page.selected); });
addEventListener("hashchange", () => { const id = /^#job=([a-z2-7]+)$/.exec(location.hash)?.[1]; if (id && id !== page.selected) select(id); });

(async () => {
  refreshHealth();
  await refreshJobs();
  findReport();
  const wanted = /^#job=([a-z2-7]+)$/.exec(location.hash)?.[1] ?? page.jobs[0]?.id;
  if (wanted) select(wanted);
  for (;;) {
    await pause(LIST_MS);
    if (!document.hidden) { refreshHealth(); await refreshJobs(); }
  }
})();
