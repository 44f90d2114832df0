/* The page: its state, its controls, and how they are kept in step. */

const byId = (id) => document.getElementById(id);
const plans = JSON.parse(byId("data").textContent);
plans.forEach(unpackPlan);

const calm = matchMedia("(prefers-reduced-motion: reduce)"), nightfall = matchMedia("(prefers-color-scheme: dark)");
const SECONDS = { mission: 40, scouting: 15 }, SAY_EVERY = 2500, CALM_EVERY = 1200;
const horizon = Math.max(...plans.map((plan) => Math.max(plan.makespan, plan.run ? plan.run.end : 0)));
const steps = Math.max(...plans.map((plan) => (plan.scouting ? plan.scouting.steps : -1)));
const maximum = Math.max(...plans.map((plan) => plan.robots.length));
const state = {
  phase: steps >= 0 ? "scouting" : "mission", t: 0, step: 0, playing: false, robot: null, victim: null,
  theme: nightfall.matches ? "dark" : "light", last: 0, said: 0, saidAt: 0,
  layers: { trails: maximum > 12 ? "recent" : "all", ahead: false, clusters: false, replans: true, stages: new Map() },
};
const stageNames = [...new Map(plans.flatMap((plan) => plan.stages.map((s) => [s.name, s.title])))];
const panels = plans.map(makePanel);

/* Panels */

function makePanel(plan) {
  const section = byId("plan").content.cloneNode(true).firstElementChild;
  const [map, gantt] = section.querySelectorAll("canvas");
  const panel = { plan, section, map, gantt, marks: [], bars: [], view: { zoom: 1, x: 0, y: 0 }, beside: plans.length > 1 };
  panel.cells = new Set(plan.victims.map((victim) => String(victim.cell)));
  const figures = `makespan ${short(plan.makespan)}, total time ${short(plan.totalTime)}, ${count(plan.distance, "cell")} walked`;
  section.querySelector("h2").textContent = `${plan.label}: ${figures}`;
  map.setAttribute("aria-label", `Map of ${plan.name}; the tables of robots and victims say what it shows`);
  gantt.setAttribute("aria-label", "Timeline of the robots; the table of robots and the details say what it shows");
  const [robots, victims, events] = section.querySelectorAll("tbody");
  if (plan.run) listEvents(plan, section, events);
  panel.robotRows = plan.robots.map((robot) => row(robots, `R${robot.id}`, robot.colour, 2, () => select(robot.id, null)));
  panel.victimRows = plan.victims.map((victim) => row(victims, `v${victim.id}`, null, 1, () => select(null, victim.id)));
  plan.robots.forEach((robot, i) => { panel.robotRows[i].dataset.robot = robot.id; });
  plan.victims.forEach((victim, i) => { panel.victimRows[i].dataset.victim = victim.id; });
  const open = plan.victims.filter((victim) => Object.keys(victim.unserved).length);
  const needs = open.reduce((n, victim) => n + Object.keys(victim.unserved).length, 0);
  if (needs) section.querySelector(".unserved").textContent = `${count(needs, "requirement")} of ${count(open.length, "victim")} stay unserved (red rings)`;
  byId("plans").append(section);
  listen(panel);
  return panel;
}

/* What happened in a run, and what each decision changed; a tap goes there. */
function listEvents(plan, section, body) {
  section.querySelector(".events").hidden = false;
  section.querySelectorAll(".robots th")[2].textContent = "served";
  for (const [time, text, number] of plan.run.events) {
    const line = row(body, short(+time.toFixed(2)), null, 1, () => { state.phase = "mission"; go(time); });
    line.dataset.time = time;
    const texts = number === null ? [text] : [text, ...decisionLines(plan, plan.run.decisions[number])];
    lines(line.cells[1], texts);
  }
}

function row(body, name, colour, cells, chosen) {
  const line = body.insertRow(), button = document.createElement("button");
  button.type = "button";
  button.setAttribute("aria-pressed", "false");
  if (colour) {
    const swatch = document.createElement("span");
    swatch.className = "swatch";
    swatch.style.background = colour;
    button.append(swatch);
  }
  button.append(name);
  button.onclick = chosen;
  line.insertCell().append(button);
  for (let i = 0; i < cells; i++) line.insertCell();
  return line;
}

function set(line, values) {
  for (const [name, value] of Object.entries(values)) if (line.dataset[name] !== String(value)) line.dataset[name] = value;
}

function write(cell, text) {
  if (cell.textContent !== text) cell.textContent = text;
}

function fillTables(panel) {
  const { plan } = panel;
  plan.robots.forEach((robot, i) => {
    const now = robotAt(robot, state.t), line = panel.robotRows[i];
    set(line, { cell: now.cell.join(), state: now.state, at: now.visit ? plan.victims[now.visit.victim].id : "", visits: now.visits });
    write(line.cells[1], doing(plan, now));
    write(line.cells[2], `${now.visits}/${robot.visits.length}`);
    line.querySelector("button").setAttribute("aria-pressed", String(state.robot === robot.id));
  });
  // While playing, a table of a thousand rows that is not open can wait.
  const isAwaited = !state.playing || panel.section.querySelector(".victims").open;
  if (isAwaited) plan.victims.forEach((victim, i) => {
    const needs = needsAt(victim, state.t), line = panel.victimRows[i];
    const of = (kind) => JSON.stringify(needs.filter((n) => n.state === kind).map((n) => plan.kinds[n.kind]));
    set(line, { served: of("served"), serving: of("serving"), unserved: of("unserved") });
    write(line.cells[1], state.phase === "scouting" ? foundSaid(plan, victim, state.step) : needsSaid(plan, victim, needs));
    line.querySelector("button").setAttribute("aria-pressed", String(state.victim === victim.id));
  });
  const { progress, detail } = { progress: panel.section.querySelector(".progress"), detail: panel.section.querySelector(".detail") };
  panel.section.classList.toggle("scouting", state.phase === "scouting");
  if (state.phase === "scouting") {
    write(progress, scoutingSummary(plan, state.step));
    const seen = plan.scouting ? plan.scouting.seen.reduce((n, step) => n + (step >= 0 && step <= state.step), 0) : 0;
    set(panel.section, { seen });
  } else {
    write(progress, `${served(plan, state.t)} of ${plan.available} available requirements served`);
  }
  const robot = plan.robots.find((x) => x.id === state.robot), victim = plan.victims.find((x) => x.id === state.victim);
  lines(detail, robot ? robotLines(plan, robot, state.t) : victim ? victimLines(plan, victim, state.t) : ["Nothing is selected."]);
}

function lines(box, texts) {
  const said = texts.join("\n");
  if (box.said === said) return;
  box.said = said;
  box.replaceChildren(...texts.map((text) => Object.assign(document.createElement("p"), { textContent: text })));
}

/* Showing */

function show() {
  const whole = Math.floor(state.step);
  const scene = {
    scouting: state.phase === "scouting", t: state.t, step: whole, horizon, steps: Math.max(steps, 0), robot: state.robot,
    victim: state.victim, theme: state.theme, colours: colours(),
  };
  for (const panel of panels) {
    const shown = panel.plan.stages.map((stage, i) => [i, state.layers.stages.get(stage.name) !== false]);
    scene.layers = { ...state.layers, stages: new Set(shown.filter(([, on]) => on).map(([i]) => i)) };
    drawMap(panel, scene);
    if (scene.scouting) drawCoverage(panel, scene);
    else drawGantt(panel, scene);
    fillTables(panel);
  }
  const [value, end] = extent(), words = scene.scouting ? `step ${whole} of ${end}` : `t = ${short(+value.toFixed(2))} of ${short(end)}`;
  byId("time").max = end || 1;
  byId("time").value = value;
  byId("time").setAttribute("aria-valuetext", words);
  byId("clock").textContent = words;
  byId("play").textContent = state.playing ? "Pause" : "Play";
  for (const button of byId("phases").children) button.setAttribute("aria-pressed", String(button.dataset.phase === state.phase));
}

function extent() {
  return state.phase === "scouting" ? [state.step, steps] : [state.t, horizon];
}

/* What happens, for the eye and for screen readers: while playing now and then, else at once. */
function say(isSeek) {
  const now = performance.now();
  if (!isSeek && now - state.saidAt < SAY_EVERY && state.playing) return;
  const parts = panels.map(({ plan }) => {
    if (state.phase === "scouting") return scoutingSummary(plan, state.step);
    if (isSeek || !state.playing) return summary(plan, state.t);
    const events = plan.events.filter((event) => event.time > state.said && event.time <= state.t);
    const shown = events.slice(-4).map((event) => eventSaid(plan, event)), more = events.length - shown.length;
    return (more > 0 ? `${count(more, "event")}, then ` : "") + (shown.join("; ") || summary(plan, state.t));
  });
  const place = state.phase === "scouting" ? `Step ${Math.floor(state.step)}` : `Time ${short(+state.t.toFixed(2))}`;
  const text = parts.length > 1 ? parts.map((part, i) => `${plans[i].label}: ${part}`).join(" ") : parts[0];
  byId("now").textContent = `${place}: ${text}`;
  state.said = state.t;
  state.saidAt = now;
}

/* Time */

function go(value, isKept = true) {
  const [, end] = extent(), at = Math.min(Math.max(value, 0), end);
  if (state.phase === "scouting") state.step = Math.round(at);
  else state.t = at;
  show();
  say(true);
  if (isKept) keep();
}

function enter(phase, value = 0) {
  state.phase = phase;
  go(value);
}

/* The moment in the address, where the page has one. */
function keep() {
  if (!location.href.startsWith("about:")) {
    const robot = state.robot === null ? "" : `&robot=${state.robot}`;
    history.replaceState(null, "", (state.phase === "scouting" ? `#step=${state.step}` : `#t=${+state.t.toFixed(4)}`) + robot);
  }
}

function readAddress() {
  const asked = new URLSearchParams(location.hash.slice(1)), t = parseFloat(asked.get("t")), step = parseFloat(asked.get("step"));
  if (asked.has("robot")) state.robot = +asked.get("robot");
  if (Number.isFinite(t)) state.phase = "mission";
  else if (Number.isFinite(step) && steps >= 0) state.phase = "scouting";
  go(Number.isFinite(t) ? t : Number.isFinite(step) ? step : 0, false);
}

function eventTimes() {
  if (state.phase === "scouting") return [0, ...plans.flatMap((p) => (p.scouting ? p.scouting.finds.map((find) => find[2]) : [])), steps];
  return [0, ...plans.flatMap((plan) => plan.events.map((event) => event.time)), horizon];
}

function neighbour(direction) {
  const [value] = extent(), beyond = eventTimes().filter((time) => (time - value) * direction > 1e-9);
  return beyond.length ? (direction > 0 ? Math.min(...beyond) : Math.max(...beyond)) : value;
}

function play(isOn) {
  const [value, end] = extent();
  state.playing = isOn;
  // From the end on it is played anew; from the end of scouting on, the mission follows.
  if (isOn && value >= end && state.phase === "mission") enter(steps >= 0 ? "scouting" : "mission");
  state.last = performance.now();
  if (isOn) requestAnimationFrame(tick);
  else go(extent()[0]);
  show();
}

function tick(now) {
  if (!state.playing) return;
  const [value, end] = extent(), speed = +byId("speed").value, passed = now - state.last;
  if (!calm.matches || passed >= CALM_EVERY / speed) {
    state.last = now;
    const next = calm.matches ? neighbour(1) : value + (passed / 1000) * speed * (end / SECONDS[state.phase]);
    if (state.phase === "scouting") state.step = Math.min(next, end);
    else state.t = Math.min(next, end);
    if (value >= end) {
      if (state.phase === "mission") return play(false);
      state.phase = "mission";
      state.t = 0;
    }
    show();
    say(calm.matches);
  }
  requestAnimationFrame(tick);
}

/* Selection, and details on hover and tap */

function select(robot, victim) {
  state.robot = robot !== null && state.robot === robot ? null : robot;
  state.victim = victim !== null && state.victim === victim ? null : victim;
  show();
  if (!state.playing) keep();
}

function markAt(panel, x, y) {
  const near = panel.marks.map((mark) => ({ ...mark, away: Math.hypot(mark.x - x, mark.y - y) - mark.radius }));
  const hit = near.filter((mark) => mark.away <= 3).sort((a, b) => a.away - b.away);
  return hit.find((mark) => mark.robot || mark.scout) || hit[0];
}

function barAt(panel, x, y) {
  return panel.bars.find((bar) => x >= bar.x - 1 && x <= bar.x + bar.wide + 1 && y >= bar.top && y <= bar.top + bar.tall);
}

function tip(event, texts) {
  const box = byId("tip");
  box.hidden = !texts;
  if (!texts) return;
  lines(box, texts);
  box.style.left = `${Math.min(event.clientX + 14, window.innerWidth - box.offsetWidth - 6)}px`;
  box.style.top = `${Math.min(event.clientY + 14, window.innerHeight - box.offsetHeight - 6)}px`;
}

function markLines(plan, mark) {
  if (mark.robot) return robotLines(plan, mark.robot, state.t);
  if (mark.victim) return victimLines(plan, mark.victim, state.t);
  return [`Scout ${mark.scout.id}`, `sees ${count(mark.scout.depth, "cell")} far, where no wall is between`];
}

function listen(panel) {
  const { map, gantt, plan, view } = panel;
  let dragged = null;
  map.onpointerdown = (event) => {
    dragged = { x: event.clientX, y: event.clientY, moved: false };
    if (view.zoom > 1) map.setPointerCapture(event.pointerId);
  };
  map.onpointermove = (event) => {
    if (dragged && view.zoom > 1 && (dragged.moved || Math.hypot(event.clientX - dragged.x, event.clientY - dragged.y) > 4)) {
      view.x += event.clientX - dragged.x;
      view.y += event.clientY - dragged.y;
      dragged = { x: event.clientX, y: event.clientY, moved: true };
      show();
      return;
    }
    const mark = markAt(panel, event.offsetX, event.offsetY);
    tip(event, mark && markLines(plan, mark));
  };
  map.onpointerup = (event) => {
    const mark = markAt(panel, event.offsetX, event.offsetY);
    if (dragged && !dragged.moved) {
      select(mark && mark.robot ? mark.robot.id : null, mark && mark.victim ? mark.victim.id : null);
      tip(event, mark && markLines(plan, mark));
    }
    dragged = null;
  };
  map.onpointerleave = (event) => event.pointerType === "mouse" && tip(event, null);
  const seek = (event) => go(timeScale(panel, extent()[1]).time(event.offsetX));
  let held = false;
  gantt.onpointerdown = (event) => {
    const bar = barAt(panel, event.offsetX, event.offsetY);
    gantt.setPointerCapture(event.pointerId);
    held = !bar;
    if (bar && bar.visit) {
      state.robot = bar.visit.robot.id;
      state.victim = null;
      go(bar.visit.arrival);
    } else if (bar) go(bar.find.step);
    else seek(event);
  };
  gantt.onpointermove = (event) => {
    if (held) seek(event);
    const bar = barAt(panel, event.offsetX, event.offsetY);
    const found = bar && bar.find && [`v${bar.find.victim} found at step ${bar.find.step}`];
    tip(event, bar && (bar.visit ? visitLines(plan, bar.visit) : found));
  };
  gantt.onpointerup = gantt.onpointercancel = () => { held = false; };
  gantt.onpointerleave = (event) => tip(event, null);
  for (const button of panel.section.querySelectorAll("[data-zoom]")) button.onclick = () => zoom(view, +button.dataset.zoom);
}

function zoom(view, by) {
  const next = by ? Math.min(Math.max(view.zoom * by, 1), 24) : 1, grown = next === 1 ? 0 : next / view.zoom;
  Object.assign(view, { zoom: next, x: view.x * grown, y: view.y * grown });
  for (const panel of panels) panel.map.style.touchAction = panel.view.zoom > 1 ? "none" : "auto";
  show();
}

/* Controls */

function paint(theme) {
  state.theme = document.documentElement.dataset.theme = theme;
  byId("theme").setAttribute("aria-pressed", String(theme === "dark"));
}

function isOwn(target) {
  return target.closest("button, summary, select, [type=checkbox]");
}

document.onkeydown = (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.tagName === "SELECT") return;
  const [value, end] = extent(), unit = state.phase === "scouting" ? 1 : end / 100;
  const step = { ArrowRight: 1, ArrowLeft: -1, ArrowUp: 1, ArrowDown: -1 }[event.key];
  const isScroll = event.key.endsWith("Up") || event.key.endsWith("Down");
  if (event.key === " " && !isOwn(event.target)) play(!state.playing);
  else if (step && isScroll && event.target.id !== "time") return;
  else if (step) go(event.shiftKey ? neighbour(step) : value + step * unit);
  else if (event.key === "PageUp" && event.target.id === "time") go(value + 10 * unit);
  else if (event.key === "PageDown" && event.target.id === "time") go(value - 10 * unit);
  else if (event.key === "Home") go(0);
  else if (event.key === "End") go(end);
  else return;
  event.preventDefault();
};

byId("play").onclick = () => play(!state.playing);
byId("earlier").onclick = () => go(neighbour(-1));
byId("later").onclick = () => go(neighbour(1));
byId("time").oninput = (event) => go(+event.target.value);
byId("theme").onclick = () => { paint(state.theme === "dark" ? "light" : "dark"); show(); };
nightfall.onchange = () => { paint(nightfall.matches ? "dark" : "light"); show(); };
byId("phases").hidden = steps < 0;
for (const button of byId("phases").children) button.onclick = () => enter(button.dataset.phase);
byId("trails").value = state.layers.trails;
byId("trails").onchange = (event) => { state.layers.trails = event.target.value; show(); };
byId("ahead").onchange = (event) => { state.layers.ahead = event.target.checked; show(); };
byId("clusters-label").hidden = !plans.some((plan) => plan.clusters.length);
byId("replans-label").hidden = !plans.some((plan) => plan.run && plan.run.decisions.length);
byId("replans").onchange = (event) => { state.layers.replans = event.target.checked; show(); };
byId("clusters").onchange = (event) => { state.layers.clusters = event.target.checked; show(); };
for (const [name, title] of stageNames) {
  const label = document.createElement("label"), box = document.createElement("input");
  Object.assign(box, { type: "checkbox", checked: true, onchange: () => { state.layers.stages.set(name, box.checked); show(); } });
  label.append(box, ` ${title}`);
  byId("stages").append(label);
}
document.body.classList.toggle("beside", plans.length > 1);
window.onresize = show;
window.onhashchange = readAddress;
paint(state.theme);
readAddress();
