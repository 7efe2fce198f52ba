"use strict";
/* Everything from the record enters the page as text nodes or attributes of fixed names: nothing is parsed as markup. */
function make(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (key === "onclick") node.addEventListener("click", value);
    else node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== ""));
  return node;
}

function drawn(name, attributes = {}, text = "") {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text) node.textContent = text;
  return node;
}

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

const REGION_HUES = [32, 208, 112, 292, 52, 0, 178, 250, 74, 330];

function fields(pairs) {
  const list = make("dl", { class: "fields" });
  for (const [name, value] of pairs) if (value) list.append(make("dt", {}, name), make("dd", {}, value));
  return list;
}

function metres(value) { return value === null ? "∞" : `${value.toFixed(2)} m`; }

function folded(title, ...content) { return make("details", {}, make("summary", {}, title), ...content); }

// Plays from step to step and stops with the last one; played again there, it begins anew. Gives what toggles it.
function player(button, last, at, go) {
  let timer = null;
  function toggle(on = timer === null) {
    clearInterval(timer);
    timer = null;
    if (on) {
      if (at() >= last) go(0);
      timer = setInterval(() => { go(at() + 1); if (at() >= last) toggle(false); }, 250);
    }
    button.querySelector("path").setAttribute("d", on ? "M3 2h4v12H3zM9 2h4v12H9z" : "M4 2l10 6-10 6z");
    button.setAttribute("aria-label", on ? "Pause" : "Play");
  }
  button.addEventListener("click", () => toggle());
  return toggle;
}

/* The floor of a step, its map, and what is drawn on it. */
class FloorView {
  constructor(canvas, story, onPick) {
    this.canvas = canvas;
    this.story = story;
    this.layers = { regions: true, graph: true, walked: true, landmarks: true, truth: true, whole: false };
    this.grounds = new Map();
    this.at = 0;
    canvas.addEventListener("click", (event) => this.pick(event, onPick));
    new ResizeObserver(() => this.draw(this.at)).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.grounds.clear(); this.load(); });
    this.load();
  }

  load() {
    for (const floor of this.story.floors) {
      const image = new Image();
      image.onload = () => {
        const canvas = make("canvas");
        [canvas.width, canvas.height] = [floor.width, floor.height];
        const pen = canvas.getContext("2d", { willReadFrequently: true });
        pen.drawImage(image, 0, 0);
        this.grounds.set(floor.floor, { canvas, pen, raw: pen.getImageData(0, 0, floor.width, floor.height).data });
        this.draw(this.at);
      };
      image.src = floor.picture;
    }
  }

  pose(index) { return index < 0 ? this.story.start : this.story.steps[index].at; }

  floorAt(index) {
    const z = this.pose(index)[2];
    return this.story.floors.reduce((best, floor) => (!best || Math.abs(floor.z - z) < Math.abs(best.z - z) ? floor : best), null);
  }

  bounds(floor) {
    const points = [];
    if (floor) {
      const [left, bottom, right, top] = floor.focus;
      points.push([left, bottom], [right, top]);
    }
    const same = (z) => !floor || Math.abs(z - floor.z) < 1.3;
    for (const step of this.story.steps) if (same(step.at[2])) points.push(step.at);
    for (const point of [...this.story.shortest, ...this.story.goals]) if (same(point[2])) points.push(point);
    if (!points.length) points.push([0, 0]);
    const xs = points.map((p) => p[0]), ys = points.map((p) => p[1]);
    return [Math.min(...xs) - 0.4, Math.min(...ys) - 0.4, Math.max(...xs) + 0.4, Math.max(...ys) + 0.4];
  }

  draw(index) {
    this.at = index;
    const { canvas, story } = this;
    const ratio = window.devicePixelRatio || 1;
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    if (!w || !h) return;
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const floor = this.floorAt(index);
    const [x0, y0, x1, y1] = this.bounds(floor);
    const scale = Math.min(w / (x1 - x0), h / (y1 - y0));
    const [left, top] = [(w - scale * (x1 - x0)) / 2, (h - scale * (y1 - y0)) / 2];
    this.px = (p) => [left + (p[0] - x0) * scale, top + (y1 - p[1]) * scale];
    this.same = (z) => !floor || Math.abs(z - floor.z) < 1.3;
    if (floor) this.ground(pen, floor, index, scale);
    if (this.layers.truth) this.truth(pen);
    if (this.layers.graph) this.graph(pen, index);
    if (this.layers.walked) this.walked(pen, index);
    if (this.layers.landmarks) this.landmarks(pen, index);
    this.agent(pen, index);
    const stage = story.steps[index]?.stage;
    const known = story.waypoints.filter((waypoint) => waypoint.step <= index + 1).length;
    canvas.setAttribute("aria-label", `Map after step ${story.steps[index]?.step ?? 0}${stage === undefined ? "" : `, stage ${stage + 1}`}: ${known} Spatial Waypoints` +
      (story.floors.length > 1 && floor ? `, floor ${floor.floor + 1}` : ""));
    if (story.floors.length > 1 && floor) {
      pen.fillStyle = colour("soft");
      pen.font = "13px system-ui, sans-serif";
      pen.textAlign = "left";
      pen.fillText(`floor ${floor.floor + 1}`, 10, 20);
    }
  }

  ground(pen, floor, index, scale) {
    const ground = this.grounds.get(floor.floor);
    if (!ground) return;
    const out = ground.pen.createImageData(floor.width, floor.height);
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const shades = [colour("unknown"), colour("free"), colour("wall")].map(channels);
    const regions = REGION_HUES.map((hue) => channels(hsl(hue, dark ? 32 : 85, dark ? 30 : 88)));
    const sums = new Map();
    for (let k = 0; k < out.data.length; k += 4) {
      const red = ground.raw[k];
      const cell = red & 3, region = ground.raw[k + 1], step = ((red >> 2) << 8) | ground.raw[k + 2];
      const visible = cell && (this.layers.whole || step <= index + 1);
      let shade = shades[visible ? cell : 0];
      if (visible && cell === 1 && region && this.layers.regions) {
        shade = regions[(region - 1) % regions.length];
        const sum = sums.get(region) ?? [0, 0, 0];
        sum[0] += 1; sum[1] += (k / 4) % floor.width; sum[2] += Math.floor(k / 4 / floor.width);
        sums.set(region, sum);
      }
      [out.data[k], out.data[k + 1], out.data[k + 2], out.data[k + 3]] = [...shade, 255];
    }
    ground.pen.putImageData(out, 0, 0);
    const [x, y] = this.px([floor.origin[0], floor.origin[1] + floor.height * floor.resolution]);
    pen.imageSmoothingEnabled = false;
    pen.drawImage(ground.canvas, x, y, floor.width * floor.resolution * scale, floor.height * floor.resolution * scale);
    pen.font = "12px system-ui, sans-serif";
    pen.textAlign = "center";
    for (const [region, [count, js, is]] of sums) {
      if (count < 150) continue;
      const name = floor.names[region - 1] ?? "";
      const at = [x + (js / count) * floor.resolution * scale, y + (is / count) * floor.resolution * scale];
      this.label(pen, name, at, colour("ink"));
    }
  }

  label(pen, text, [x, y], ink) {
    pen.lineWidth = 3;
    pen.strokeStyle = colour("bg");
    pen.lineJoin = "round";
    pen.strokeText(text, x, y);
    pen.fillStyle = ink;
    pen.fillText(text, x, y);
  }

  line(pen, points, ink, width, dash = []) {
    pen.strokeStyle = ink;
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.lineJoin = pen.lineCap = "round";
    pen.beginPath();
    let open = false;
    for (const point of points) {
      if (!this.same(point[2] ?? 0)) { open = false; continue; }
      const [x, y] = this.px(point);
      open ? pen.lineTo(x, y) : pen.moveTo(x, y);
      open = true;
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  dot(pen, point, radius, fill, stroke = colour("bg"), width = 1.5) {
    const [x, y] = this.px(point);
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    if (fill) { pen.fillStyle = fill; pen.fill(); }
    pen.strokeStyle = stroke;
    pen.lineWidth = width;
    pen.stroke();
  }

  truth(pen) {
    this.line(pen, this.story.shortest, colour("shortest"), 3, [7, 6]);
    for (const goal of this.story.goals) {
      if (!this.same(goal[2])) continue;
      const [x, y] = this.px(goal);
      pen.beginPath();
      for (let k = 0; k < 10; k++) {
        const radius = k % 2 ? 4.5 : 10;
        pen.lineTo(x + radius * Math.sin((k * Math.PI) / 5), y - radius * Math.cos((k * Math.PI) / 5));
      }
      pen.closePath();
      pen.fillStyle = colour("goal");
      pen.fill();
      pen.strokeStyle = colour("bg");
      pen.lineWidth = 1.5;
      pen.stroke();
    }
  }

  graph(pen, index) {
    const known = new Map(this.story.waypoints.filter((w) => w.step <= index + 1).map((w) => [w.index, w]));
    const stage = this.story.steps[index]?.stage ?? 0;
    const seen = new Set();
    let chain = [];
    for (let k = 0; k <= stage; k++) {
      const memory = this.story.stages[k]?.memory;
      if (!memory || this.story.stages[k].planned > index) continue;
      chain = memory.chain;
      for (const [a, b] of memory.links) {
        if (seen.has(`${a} ${b}`) || !known.has(a) || !known.has(b)) continue;
        seen.add(`${a} ${b}`);
        this.line(pen, [known.get(a).at, known.get(b).at], colour("link"), 2);
      }
    }
    const newest = [...known.keys()].filter((number) => !chain.includes(number));
    const visited = [...chain, ...newest].map((number) => known.get(number)?.at).filter(Boolean);
    this.line(pen, visited, colour("walked"), 1.5, [3, 5]);
    pen.font = "bold 11px system-ui, sans-serif";
    pen.textAlign = "center";
    for (const waypoint of known.values()) {
      if (!this.same(waypoint.at[2])) continue;
      this.dot(pen, waypoint.at, 8, colour("bg"), colour("walked"), 2);
      const [x, y] = this.px(waypoint.at);
      pen.fillStyle = colour("ink");
      pen.fillText(String(waypoint.index), x, y + 4);
    }
  }

  walked(pen, index) {
    const points = [this.story.start, ...this.story.steps.slice(0, index + 1).map((step) => step.at)];
    this.line(pen, points, colour("walked"), 2.5);
    if (this.same(this.story.start[2])) this.dot(pen, this.story.start, 5, colour("start"));
  }

  landmarks(pen, index) {
    const step = this.story.steps[index];
    if (!step) return;
    const stage = this.story.stages[step.stage];
    if (stage.subtask?.target && index > stage.planned && this.same(stage.subtask.target[2])) {
      this.dot(pen, stage.subtask.target, 7, null, colour("target"), 2.5);
    }
    const decision = this.story.decisions[step.decision];
    pen.font = "12px system-ui, sans-serif";
    pen.textAlign = "left";
    for (const candidate of decision?.pool ?? []) {
      const [x, y] = this.px(candidate.at);
      pen.fillStyle = colour("landmark");
      pen.strokeStyle = colour("bg");
      pen.lineWidth = 1.5;
      pen.fillRect(x - 5, y - 5, 10, 10);
      pen.strokeRect(x - 5, y - 5, 10, 10);
      this.label(pen, candidate.name, [x + 9, y + 4], colour("landmark"));
    }
  }

  agent(pen, index) {
    const pose = this.pose(index);
    const [x, y] = this.px(pose);
    pen.save();
    pen.translate(x, y);
    pen.rotate(-pose[3]);
    pen.beginPath();
    for (const [a, b] of [[12, 0], [-8, -8], [-4, 0], [-8, 8]]) pen.lineTo(a, b);
    pen.closePath();
    pen.fillStyle = colour("walked");
    pen.fill();
    pen.strokeStyle = colour("bg");
    pen.lineWidth = 1.5;
    pen.stroke();
    pen.restore();
  }

  pick(event, onPick) {
    const box = this.canvas.getBoundingClientRect();
    let best = [20, null];
    this.story.steps.forEach((step, index) => {
      if (!this.same(step.at[2])) return;
      const [x, y] = this.px(step.at);
      const gap = Math.hypot(event.clientX - box.left - x, event.clientY - box.top - y);
      if (gap < best[0]) best = [gap, index];
    });
    if (best[1] !== null) onPick(best[1]);
  }
}

function channels(text) {
  const pen = make("canvas").getContext("2d");
  pen.fillStyle = text;
  const code = pen.fillStyle;
  return [1, 3, 5].map((k) => parseInt(code.slice(k, k + 2), 16));
}

function hsl(hue, saturation, lightness) { return `hsl(${hue}, ${saturation}%, ${lightness}%)`; }

/* The first-person picture with its boxes. */
function showFrame(frame, story, step, withBoxes) {
  const image = frame.querySelector("img"), svg = frame.querySelector("svg");
  frame.querySelector(".none")?.remove();
  if (step?.rgb) {
    image.src = step.rgb;
    image.alt = `First-person view at step ${step.step}` + (step.boxes.length ? `: ${step.boxes.map((box) => box.name).join(", ")}` : "");
  } else {
    image.removeAttribute("src");
    image.alt = "";
    frame.append(make("div", { class: "none" }, step ? "no image recorded" : "no step recorded"));
  }
  svg.replaceChildren();
  svg.setAttribute("viewBox", `0 0 ${story.frame[0]} ${story.frame[1]}`);
  if (!withBoxes || !step) return;
  for (const { name, box: [x0, y0, x1, y1], m } of step.boxes) {
    const shape = { x: x0, y: y0, width: x1 - x0, height: y1 - y0, fill: "none" };
    svg.append(drawn("rect", { ...shape, stroke: "#000", "stroke-width": 5, opacity: 0.45 }), drawn("rect", { ...shape, stroke: "#ffd60a", "stroke-width": 2.5 }));
    if ((x1 - x0) * (y1 - y0) < 0.006 * story.frame[0] * story.frame[1]) continue;
    const text = `${name}${m === null ? "" : ` ${m.toFixed(1)} m`}`, size = frame.clientWidth < 420 ? 22 : 16;
    svg.append(drawn("text", { x: Math.max(4, Math.min(x0 + 4, story.frame[0] - 0.64 * size * text.length)), y: Math.max(y0, 0) + size + 2, "font-size": size, "font-weight": 600, fill: "#ffd60a", stroke: "#000", "stroke-width": 4, "paint-order": "stroke" }, text));
  }
}

/* The robot from outside, in a corner of that picture, where the record has it. */
function showExternal(image, step, wanted) {
  if (!image) return;
  image.hidden = !wanted || !step?.external;
  if (image.hidden) return;
  image.src = step.external;
  image.alt = `The robot seen from behind at step ${step.step}`;
}

/* Omega_t as three sectors, each as long as it is free. */
function sectors(decision) {
  const svg = drawn("svg", { class: "sectors", viewBox: "0 0 150 96", role: "img",
    "aria-label": `free: left ${metres(decision.obstacles[0])}, front ${metres(decision.obstacles[1])}, right ${metres(decision.obstacles[2])}` });
  [-30, 0, 30].forEach((turn, k) => {
    const value = decision.obstacles[k] ?? 3, reach = 14 + 18 * Math.min(value, 3);
    const angle = (a) => ((a - 90) * Math.PI) / 180;
    const corner = (a) => `${75 + reach * Math.cos(angle(a))},${90 + reach * Math.sin(angle(a))}`;
    const fill = value < 0.5 ? colour("goal") : value < 1 ? colour("landmark") : colour("shortest");
    svg.append(drawn("path", { d: `M75,90 L${corner(turn - 15)} A${reach},${reach} 0 0 1 ${corner(turn + 15)} Z`, fill }));
    const at = reach + 10;
    svg.append(drawn("text", { x: 75 + (at + (turn ? 6 : 0)) * Math.cos(angle(turn)), y: 93 + at * Math.sin(angle(turn)) }, value.toFixed(1)));
  });
  return svg;
}

const PHASES = { lookaround: "looking around", align: "aligning with the chosen direction", execute: "executing", stop: "stopping" };

/* What the executor decided at a step, or what the body did otherwise; `whose` tells two records apart. */
function showAct(story, step, whose = "") {
  if (!step) return [make("p", { class: "soft" }, "Nothing was recorded after the start.")];
  const decision = story.decisions[step.decision];
  const real = `${step.action}${step.moved ? `, moved ${step.moved.toFixed(2)} m` : ""}${step.turned ? `, turned ${step.turned}°` : ""}`;
  const chips = [make("span", { class: "chip" }, PHASES[step.phase] ?? step.phase), make("span", { class: "chip" }, real)];
  if (step.collided) chips.push(make("span", { class: "chip warn" }, "collided"));
  if (!decision) return [make("p", { class: "chips" }, ...chips)];
  const done = decision.done;
  if (done?.stalled) chips.push(make("span", { class: "chip no" }, "stalled"));
  if (done?.interrupted) chips.push(make("span", { class: "chip warn" }, "interrupted"));
  const allowed = ["stop", ...decision.forward.map((value) => `forward ${value.toFixed(2)}`), decision.left ? "left" : null, decision.right ? "right" : null].filter(Boolean);
  const chosen = (name) => decision.action === name || ((name === "left" || name === "right") && decision.action.startsWith(name));
  const result = !done ? "not recorded" : `moved ${done.moved.toFixed(2)} m, turned ${done.turned}° in ${done.primitives} step${done.primitives === 1 ? "" : "s"}`;
  const parts = [
    make("p", { class: "chips" }, ...chips),
    make("div", { class: "act" }, sectors(decision), fields([
      ["asked", `${decision.action}${decision.purpose ? ` (${decision.purpose})` : ""}, decision ${decision.number} of the stage`],
      ["done", result],
      ["view", decision.thought.view], ["detection", decision.thought.detection],
      ["progress", decision.thought.progress], ["action", decision.thought.action],
      ["time", `${decision.seconds.toFixed(2)} s`],
    ])),
    make("p", { class: "chips", "aria-label": "Admissible actions" }, ...allowed.map((name) => make("span", { class: `chip${chosen(name) ? " chosen" : ""}` }, name))),
  ];
  if (decision.reasons.length) parts.push(make("p", { class: "soft small" }, `Masked: ${decision.reasons.join("; ")}`));
  parts.push(poolTable(decision.pool, whose));
  return parts;
}

function poolTable(pool, whose) {
  if (!pool.length) return make("p", { class: "soft small" }, "The landmark pool is empty.");
  const head = ["landmark", "distance", "bearing", "confidence", "visible", "arrived"];
  return make("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": `Landmark pool${whose}` }, make("table", {},
    make("thead", {}, make("tr", {}, ...head.map((name, k) => make("th", { scope: "col", class: k > 0 && k < 4 ? "num" : null }, name)))),
    make("tbody", {}, ...pool.map((c) => make("tr", {},
      make("td", {}, `${c.name} (${c.kind})`), make("td", { class: "num" }, metres(c.m)),
      make("td", { class: "num" }, c.bearing === 0 ? "front" : `${c.bearing > 0 ? "left" : "right"} ${Math.abs(c.bearing)}°`),
      make("td", { class: "num" }, c.confidence.toFixed(2)), make("td", {}, c.visible ? "yes" : "no"), make("td", {}, c.arrived ? "yes" : "no"))))));
}

const TICKS = { verified: "✓ ", current: "● ", pending: "○ " };

/* A planner stage in full; `open` names the details that stay open while one scrubs. */
function showStage(story, number, go) {
  const stage = story.stages[number];
  if (!stage) return [make("p", { class: "soft" }, "No planner stage was recorded.")];
  const subtask = stage.subtask, parts = [];
  if (subtask) {
    const next = subtask.chain.findIndex((anchor) => anchor.status === "pending");
    parts.push(
      make("p", { class: "instruction" }, subtask.complete ? "The task is done." : subtask.instruction),
      make("p", { class: "chips" }, subtask.complete ? null : make("span", { class: "chip chosen" }, subtask.direction || "no direction"),
        subtask.landmark ? make("span", { class: "chip" }, `landmark: ${subtask.landmark}`) : null,
        make("span", { class: "chip" }, `last subtask: ${subtask.verdict}`),
        subtask.revision ? make("span", { class: "chip warn" }, `anchors revised: ${subtask.revision}`) : null,
        stage.end ? make("span", { class: `chip${stage.end === "blocked" || stage.end === "stage_budget" ? " no" : ""}` }, `ended by ${stage.end.replace("_", " ")}`) : null),
      make("ol", { class: "anchors", "aria-label": "Anchor chain" }, ...subtask.chain.map((anchor, k) =>
        make("li", { class: k === next && !subtask.complete ? "pending next" : anchor.status }, (TICKS[anchor.status] ?? "") + anchor.text,
          make("span", { class: "sr" }, ` (${anchor.status})`)))));
  } else parts.push(make("p", { class: "note" }, "No subtask was issued in this stage."));
  const chosen = subtask?.complete ? null : subtask?.direction;
  const views = [...stage.views].sort((a, b) => b.heading - a.heading), known = views.filter((view) => !view.rgb);
  parts.push(make("div", { class: "views" }, ...views.filter((view) => view.rgb).map((view) => {
    const marked = view.label === chosen;
    const saw = view.boxes.map((box) => box.name);
    return make("button", { type: "button", class: marked ? "chosen" : null, onclick: () => view.step !== null && go(view.step),
      "aria-label": `View ${view.label}${marked ? ", chosen" : ""}, ${metres(view.m)} free` },
      make("img", { src: view.rgb, loading: "lazy", alt: `View ${view.label}${saw.length ? `: ${[...new Set(saw)].join(", ")}` : ""}` }),
      make("span", {}, make("b", {}, marked ? `▸ ${view.label}` : view.label), make("i", { class: "soft" }, metres(view.m))));
  })));
  if (known.length) {
    parts.push(make("p", { class: "chips" }, make("span", { class: "soft" }, "Known, not turned to:"), ...known.map((view) =>
      make("span", { class: `chip${view.label === chosen ? " chosen" : ""}` }, `${view.label} ${metres(view.m)}`))));
  }
  const left = make("div", { class: "panel" }, make("h3", {}, "Reasoning"));
  if (subtask) left.append(fields([...Object.entries(subtask.thought), ["anchor now", subtask.current], ["next anchor", subtask.next], ["time", `${subtask.seconds.toFixed(2)} s`]]));
  for (const gate of stage.gates) {
    left.append(make("p", { class: "chips" }, make("span", { class: `chip ${gate.accepted ? "yes" : "no"}` }, gate.accepted ? "finish accepted" : "finish refused"),
      ...gate.clauses.map(([name, holds]) => make("span", { class: `chip ${holds ? "yes" : "no"}` }, `${holds ? "✓" : "✗"} ${name.replaceAll("_", " ")}`))));
  }
  for (const refusal of stage.refused) left.append(make("p", { class: "refused" }, `${refusal.role} reply refused (${refusal.kind}): ${refusal.reason}`));
  for (const fallback of stage.fallbacks) left.append(make("p", { class: "refused" }, `Fallback (${fallback.kind}): ${fallback.detail}`));
  for (const retry of stage.retries) left.append(make("p", { class: "refused" }, `${retry.role} call retried (${retry.kind}): ${retry.detail}`));
  const right = make("div", { class: "panel" }, make("h3", {}, "Spatial memory"));
  if (stage.memory) {
    if (stage.memory.image) right.append(make("img", { class: "mu", src: stage.memory.image, loading: "lazy", alt: `Rendered map shown to the planner in stage ${number + 1}` }));
    right.append(make("p", { class: "small soft" }, stage.memory.region ? `Stands in: ${stage.memory.region}` : "Stands in no known region"));
    right.append(folded("As text", make("pre", { tabindex: "0" }, stage.memory.text)));
  } else right.append(make("p", { class: "soft" }, "Switched off, or not recorded."));
  parts.push(make("div", { class: "two" }, left, right));
  if (stage.calls.length) parts.push(folded(`Calls of models (${stage.calls.length})`, ...stage.calls.map((call) => showCall(story, call))));
  return parts;
}

function showCall(story, call) {
  const facts = [`#${call.number} ${call.role}`, call.model, call.tokens && `${call.tokens[0]} + ${call.tokens[1]} tokens`, call.seconds !== null && `${call.seconds.toFixed(2)} s`,
    call.usd !== null && call.usd !== undefined && `${call.usd.toFixed(4)} USD`, call.problem && `unusable: ${call.problem}`].filter(Boolean);
  const node = make("div", { class: "call" }, make("details", {}, make("summary", {}, facts.join(" · "))));
  const inside = node.firstChild;
  inside.addEventListener("toggle", () => {
    if (!inside.open || inside.childElementCount > 1) return;
    for (const message of call.messages) {
      inside.append(make("h3", {}, message.speaker));
      for (const part of message.parts) {
        if (part.image) inside.append(make("img", { src: part.image, alt: part.name, loading: "lazy" }));
        else if ("name" in part) inside.append(make("p", { class: "soft small" }, `picture ${part.name}, not kept at this level of recording`));
        else inside.append(make("pre", { tabindex: "0" }, part.text ?? story.texts[part.file] ?? `not in the record: ${part.file}`));
      }
    }
    if (call.detail) inside.append(make("p", { class: "refused" }, call.detail));
    inside.append(make("h3", {}, "reply"), make("pre", { tabindex: "0" }, call.reply ?? "no reply"));
  });
  return node;
}

/* Stages as bands of the timeline, a row for each record, over the steps of the longest. */
function drawBand(canvas, rows) {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, height = canvas.clientHeight / rows.length;
  const n = Math.max(1, ...rows.map(({ story }) => story.steps.length));
  canvas.width = Math.round(w * ratio);
  canvas.height = Math.round(canvas.clientHeight * ratio);
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  rows.forEach(({ story, marked }, row) => {
    const top = row * height, bottom = top + height - (row < rows.length - 1 ? 1 : 0);
    story.steps.forEach((step, k) => {
      pen.globalAlpha = (step.stage % 2 ? 0.55 : 0.9) * (step.phase === "lookaround" ? 0.35 : 1);
      pen.fillStyle = step.collided ? colour("goal") : colour("accent");
      pen.fillRect((k / n) * w, top, w / n + 0.6, bottom - top);
    });
    pen.globalAlpha = 1;
    if (marked === null) return;
    const x = ((marked + 0.5) / n) * w;
    pen.fillStyle = colour("target");
    pen.strokeStyle = colour("bg");
    pen.lineWidth = 1.5;
    pen.beginPath();
    for (const [dx, y] of [[-height / 2, top], [height / 2, top], [0, bottom - 0.5]]) pen.lineTo(x + dx, y);
    pen.closePath();
    pen.fill();
    pen.stroke();
  });
}
