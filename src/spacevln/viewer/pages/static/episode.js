(() => {
  const story = JSON.parse(document.getElementById("data").textContent);
  const by = (id) => document.getElementById(id);
  const scrub = by("scrub"), where = by("where"), last = story.steps.length - 1;
  let at = last >= 0 ? 0 : -1, shownStage = null;
  scrub.max = Math.max(0, last);
  const floors = new FloorView(by("map"), story, go);

  function go(index, { keep = false } = {}) {
    at = last < 0 ? -1 : Math.min(last, Math.max(0, index));
    const step = story.steps[at];
    scrub.value = at;
    scrub.setAttribute("aria-valuetext", step ? `step ${step.step}, stage ${step.stage + 1}, ${step.action}` : "no step");
    where.textContent = step ? `step ${step.step} of ${last + 1} · stage ${step.stage + 1} of ${story.stages.length}` : "no step";
    showFrame(by("frame"), story, step, by("show-boxes").checked);
    showExternal(by("external"), step, by("show-external")?.checked);
    by("act").replaceChildren(...showAct(story, step));
    floors.draw(at);
    const stage = step ? step.stage : story.stages.length - 1;
    if (stage !== shownStage) {
      shownStage = stage;
      by("stage-title").textContent = stage < 0 ? "Planner" : `Planner, stage ${stage + 1}`;
      by("plan").replaceChildren(...showStage(story, stage, go));
      for (const row of by("stage-table").tBodies[0].rows) row.setAttribute("aria-current", String(Number(row.dataset.stage) === stage));
    }
    if (!keep && step) history.replaceState(null, "", `#step=${step.step}`);
    const ahead = story.steps[at + 1];
    if (ahead?.rgb) new Image().src = ahead.rgb;
  }

  function toStage(change) {
    const now = story.steps[at]?.stage ?? 0;
    const starts = story.stages.map((stage) => stage.planned ?? stage.first);
    if (change < 0 && at > starts[now]) go(starts[now]);
    else go(starts[Math.min(starts.length - 1, Math.max(0, now + change))] ?? 0);
  }

  const toggle = player(by("play"), last, () => at, go);

  function fromAddress() {
    const asked = new URLSearchParams(location.hash.slice(1));
    if (asked.has("step")) {
      const number = Number(asked.get("step"));
      const found = story.steps.findIndex((step) => step.step >= number);
      go(found < 0 ? last : found, { keep: true });
    } else if (asked.has("stage")) {
      const stage = story.stages[Number(asked.get("stage")) - 1];
      go(stage ? stage.planned ?? stage.first : 0, { keep: true });
    } else return false;
    return true;
  }

  story.stages.forEach((stage, k) => {
    const steps = story.steps.filter((step) => step.stage === k).length;
    by("stage-table").tBodies[0].append(make("tr", { "data-stage": k },
      make("td", {}, make("a", { href: `#stage=${k + 1}` }, String(k + 1))),
      make("td", {}, stage.subtask ? (stage.subtask.complete ? "the task is done" : stage.subtask.instruction) : "–"),
      make("td", {}, (stage.subtask?.complete ? null : stage.subtask?.direction) ?? "–"), make("td", {}, stage.subtask?.landmark || "–"),
      make("td", {}, stage.end?.replace("_", " ") ?? "–", stage.refused.length ? make("span", { class: "why soft" }, `${stage.refused.length} refused`) : null),
      make("td", { class: "num" }, String(steps))));
  });
  scrub.addEventListener("input", () => go(Number(scrub.value)));
  by("to-step-before").addEventListener("click", () => go(at - 1));
  by("to-step-after").addEventListener("click", () => go(at + 1));
  by("to-stage-before").addEventListener("click", () => toStage(-1));
  by("to-stage-after").addEventListener("click", () => toStage(1));
  by("show-boxes").addEventListener("change", () => go(at, { keep: true }));
  by("show-external")?.addEventListener("change", () => go(at, { keep: true }));
  for (const box of document.querySelectorAll("[data-layer]")) {
    box.addEventListener("change", () => { floors.layers[box.dataset.layer] = box.checked; floors.draw(at); });
  }
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const inside = event.target.closest("input:not(#scrub):not([type=checkbox]), select, textarea, [role=region], pre");
    const acts = { ArrowLeft: () => go(at - 1), ArrowRight: () => go(at + 1), "[": () => toStage(-1), "]": () => toStage(1), Home: () => go(0), End: () => go(last) };
    if (event.key === " " && !event.target.closest("button, input, summary, a")) acts[" "] = () => toggle();
    if (inside || !acts[event.key]) return;
    event.preventDefault();
    acts[event.key]();
  });
  addEventListener("hashchange", () => { if (fromAddress()) scrollTo({ top: 0 }); });
  const band = () => drawBand(by("band"), [{ story, marked: story.decisive }]);
  new ResizeObserver(band).observe(by("band"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { band(); go(at, { keep: true }); });
  if (!fromAddress()) go(0, { keep: true });
})();
