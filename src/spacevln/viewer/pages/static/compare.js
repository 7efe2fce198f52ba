(() => {
  const { sides, differing } = JSON.parse(document.getElementById("data").textContent);
  const by = (id) => document.getElementById(id);
  const scrub = by("scrub"), last = Math.max(...sides.map((story) => story.steps.length)) - 1;
  let at = 0;
  scrub.max = Math.max(0, last);
  const columns = ["a", "b"].map((name, k) => {
    const root = by(`side-${name}`);
    return { root, story: sides[k], floors: new FloorView(root.querySelector("canvas"), sides[k], (index) => go(index)) };
  });

  function go(index, each = null) {
    at = Math.min(last, Math.max(0, index));
    scrub.value = at;
    by("where").textContent = `step ${at + 1} of ${last + 1}`;
    columns.forEach(({ root, story, floors }, k) => {
      const own = Math.min(each ? each[k] : at, story.steps.length - 1), step = story.steps[own];
      root.querySelector(".now").textContent = step ? `step ${step.step} of ${story.steps.length}, stage ${step.stage + 1}` : "no step";
      showFrame(root.querySelector(".frame"), story, step, true);
      floors.draw(own);
      const subtask = step && story.stages[step.stage].subtask;
      const here = differing && step && step.stage === differing.stage;
      const marked = here && differing.decision === null;
      root.querySelector(".plan").replaceChildren(
        make("p", { class: `instruction${marked ? " differs" : ""}` }, subtask ? (subtask.complete ? "The task is done." : subtask.instruction) : "No subtask"),
        subtask ? make("p", { class: "chips" }, subtask.complete ? null : make("span", { class: "chip chosen" }, subtask.direction || "no direction"), subtask.landmark ? make("span", { class: "chip" }, `landmark: ${subtask.landmark}`) : null) : "",
        subtask ? fields(Object.entries(subtask.thought)) : "");
      const act = root.querySelector(".act-of");
      act.replaceChildren(...showAct(story, step, ` of record ${k + 1}`));
      act.classList.toggle("differs", Boolean(here && differing.decision === story.decisions[step.decision]?.number));
    });
    if (!each) history.replaceState(null, "", `#step=${at + 1}`);
  }

  function toStage(change) {
    const story = sides[0].steps.length > at ? sides[0] : sides[1];
    const now = story.steps[Math.min(at, story.steps.length - 1)]?.stage ?? 0;
    const next = Math.min(story.stages.length - 1, Math.max(0, now + change));
    const each = sides.map((side) => { const stage = side.stages[next]; return stage ? stage.planned ?? stage.first : side.steps.length - 1; });
    go(each[story === sides[0] ? 0 : 1], each);
  }

  const toggle = player(by("play"), last, () => at, go);

  scrub.addEventListener("input", () => go(Number(scrub.value)));
  by("to-step-before").addEventListener("click", () => go(at - 1));
  by("to-step-after").addEventListener("click", () => go(at + 1));
  by("to-stage-before").addEventListener("click", () => toStage(-1));
  by("to-stage-after").addEventListener("click", () => toStage(1));
  by("to-differing")?.addEventListener("click", () => go(differing.steps[0], differing.steps));
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const acts = { ArrowLeft: () => go(at - 1), ArrowRight: () => go(at + 1), "[": () => toStage(-1), "]": () => toStage(1), Home: () => go(0), End: () => go(last) };
    if (event.key === " " && !event.target.closest("button, input, summary, a")) acts[" "] = () => toggle();
    if (!acts[event.key] || event.target.closest("[role=region], pre")) return;
    event.preventDefault();
    acts[event.key]();
  });
  const band = () => drawBand(by("band"), sides.map((story, k) => ({ story, marked: differing ? differing.steps[k] : null })));
  new ResizeObserver(band).observe(by("band"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { band(); go(at); });
  const asked = Number(new URLSearchParams(location.hash.slice(1)).get("step"));
  if (asked) go(asked - 1);
  else if (differing) go(differing.steps[0], differing.steps);
  else go(0);
})();
