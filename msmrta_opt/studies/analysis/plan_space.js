"use strict";
(() => {
const data = JSON.parse(document.getElementById("data").textContent);
const SVG = "http://www.w3.org/2000/svg";
const RADIUS = 85;  // of a dot that is all of the square
const APART = 18;  // from one to the next of dots at one place
const box = { left: 74, right: 540, top: 18, bottom: 388 };
const field = { left: 52, size: 372, top: 16 };
let kept = null;

const element = (name, attributes = {}, text = "") => {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== "") made.textContent = text;
  return made;
};
const short = (x) => Number(x.toPrecision(6)).toLocaleString("en");
const percent = (plan) => Number((100 * plan.share).toPrecision(3));
const choice = { across: data.axes[0], up: data.axes[1] };

// From dark to bright in the order of the two metrics: no two plans are alike.
function colourOf(plan) {
  const before = (other) => [choice.across, choice.up].map((name) => other.metrics[name] - plan.metrics[name])
    .concat(other.number - plan.number).find((gap) => gap !== 0) < 0;
  const at = data.plans.filter(before).length / Math.max(data.plans.length - 1, 1);
  return data.colours[Math.round(at * (data.colours.length - 1))];
}

function shiftOf(plan) {
  const alike = data.plans.filter((other) => [choice.across, choice.up].every((name) => other.metrics[name] === plan.metrics[name]));
  return APART * (alike.indexOf(plan) - (alike.length - 1) / 2);
}

function inkOn(colour) {
  const [r, g, b] = [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16) / 255)
    .map((x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b > 0.179 ? "#000" : "#fff";
}

function ticks(low, high) {
  const rough = (high - low) / 5 || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((x) => x * power).find((x) => x >= rough);
  const found = [];
  for (let t = Math.ceil(low / step) * step; t <= high + 1e-9; t += step) found.push(t);
  return found;
}

function scaleOf(name, from, to) {
  const values = data.plans.map((plan) => plan.metrics[name]);
  let [low, high] = [Math.min(...values), Math.max(...values)];
  const room = (high - low) * 0.3 || Math.abs(high) * 0.1 || 1;
  [low, high] = [low - room, high + room];
  return { low, high, at: (x) => from + ((x - low) / (high - low)) * (to - from) };
}

function drawSpace() {
  const svg = document.getElementById("space");
  svg.replaceChildren();
  const x = scaleOf(choice.across, box.left, box.right);
  const y = scaleOf(choice.up, box.bottom, box.top);
  for (const t of ticks(x.low, x.high)) {
    svg.append(element("line", { class: "grid", x1: x.at(t), x2: x.at(t), y1: box.top, y2: box.bottom }));
    svg.append(element("text", { x: x.at(t), y: box.bottom + 17, "text-anchor": "middle" }, short(t)));
  }
  for (const t of ticks(y.low, y.high)) {
    svg.append(element("line", { class: "grid", y1: y.at(t), y2: y.at(t), x1: box.left, x2: box.right }));
    svg.append(element("text", { x: box.left - 7, y: y.at(t) + 4, "text-anchor": "end" }, short(t)));
  }
  svg.append(element("path", { class: "axis", d: `M${box.left} ${box.top}V${box.bottom}H${box.right}` }));
  svg.append(element("text", { x: (box.left + box.right) / 2, y: 426, "text-anchor": "middle" }, data.metrics[choice.across].title));
  svg.append(element("text", { transform: `translate(14 ${(box.top + box.bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, data.metrics[choice.up].title));
  // The larger first, so that the smaller lie on them.
  const drawn = [];
  for (const plan of [...data.plans].sort((a, b) => b.share - a.share)) {
    const [cx, cy] = [x.at(plan.metrics[choice.across]) + shiftOf(plan), y.at(plan.metrics[choice.up])];
    const r = RADIUS * Math.sqrt(plan.share);
    const dot = element("g", {
      class: "dot", tabindex: 0, role: "button", "data-plan": plan.number, "aria-label": said(plan),
    });
    dot.append(element("circle", { class: "hit", cx, cy, r: Math.max(r, 11) }));
    dot.append(element("circle", { class: "area", cx, cy, r, fill: colourOf(plan) }));
    watch(dot, plan.number);
    svg.append(dot);
    drawn.push({ plan, dot, cx, cy, r });
  }
  const taken = [];
  drawn.forEach((one, i) => numberDot(one, drawn.slice(i + 1), taken));
}

// In the dot if it is large enough and nothing lies on its middle, else beside it where no other number is.
function numberDot({ plan, dot, cx, cy, r }, later, taken) {
  const half = 4 * String(plan.number).length + 1;
  const free = r > half + 3 && later.every((other) => Math.hypot(other.cx - cx, other.cy - cy) > other.r + half + 1);
  const sides = [[1, 0], [-1, 0], [0, 1], [0, -1], [0.75, 0.75], [-0.75, -0.75]];
  for (const [dx, dy] of free ? [[0, 0], ...sides] : sides) {
    const [x, y] = [cx + dx * (r + half + 3), cy + dy * (r + 9)];
    if (taken.some((other) => Math.abs(other.x - x) < half + other.half && Math.abs(other.y - y) < 13)) continue;
    taken.push({ x, y, half });
    const beside = dx !== 0 || dy !== 0;
    dot.append(element("text", {
      class: beside ? "label beside" : "label", x, y: y + 4.5, "text-anchor": "middle",
      ...(beside ? {} : { fill: inkOn(colourOf(plan)) }),
    }, plan.number));
    return;
  }
}

function drawSquare() {
  const svg = document.getElementById("square");
  svg.replaceChildren();
  const across = (x) => field.left + x * field.size;
  const up = (y) => field.top + (1 - y) * field.size;
  for (const region of data.regions) {
    const plan = data.plans[region.plan - 1];
    const [x, y] = [across(region.psi[0]), up(region.beta[1])];
    const width = across(region.psi[1]) - x;
    const height = up(region.beta[0]) - y;
    const part = element("rect", { class: "region", x, y, width, height, fill: colourOf(plan), "data-plan": region.plan });
    part.append(element("title", {}, `ψ ${region.text[0]}, β ${region.text[1]}: plan ${region.plan}${region.unique ? "" : ", one of several optimal"}`));
    watch(part, region.plan);
    svg.append(part);
    if (width > 10 + 8 * String(region.plan).length && height > 16) {
      svg.append(element("text", {
        class: "label", x: x + width / 2, y: y + height / 2 + 4.5, "text-anchor": "middle",
        fill: inkOn(colourOf(plan)), "data-plan": region.plan,
      }, region.plan));
    }
  }
  for (const t of [0, 0.25, 0.5, 0.75, 1]) {
    svg.append(element("text", { x: across(t), y: up(0) + 17, "text-anchor": "middle" }, t));
    svg.append(element("text", { x: field.left - 6, y: up(t) + 4, "text-anchor": "end" }, t));
  }
  svg.append(element("text", { x: across(0.5), y: 426, "text-anchor": "middle" }, "ψ"));
  svg.append(element("text", { x: 10, y: up(0.5) }, "β"));
}

function drawTable() {
  const names = Object.keys(data.metrics);
  const table = document.getElementById("plans");
  const head = table.createTHead().insertRow();
  for (const text of ["plan", "share of the square", ...names.map((name) => data.metrics[name].title)]) {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.textContent = text;
    head.append(cell);
  }
  const body = table.createTBody();
  for (const plan of data.plans) {
    const row = body.insertRow();
    row.dataset.plan = plan.number;
    for (const text of [plan.number, `${percent(plan)} %`, ...names.map((name) => short(plan.metrics[name]))]) {
      row.insertCell().textContent = text;
    }
    watch(row, plan.number);
  }
}

function said(plan) {
  const [x, y] = [choice.across, choice.up];
  return `plan ${plan.number}: ${data.metrics[x].title} ${short(plan.metrics[x])}, ${data.metrics[y].title} ${short(plan.metrics[y])}, ${percent(plan)} % of the square`;
}

function show(number) {
  for (const part of document.querySelectorAll("[data-plan]")) {
    const mine = +part.dataset.plan === number;
    part.classList.toggle("on", mine);
    part.classList.toggle("off", number !== null && !mine && part.tagName !== "TR");
    if (part.getAttribute("role") === "button") part.setAttribute("aria-pressed", String(mine && kept === number));
  }
  const told = document.getElementById("told");
  told.replaceChildren();
  const plan = data.plans[(number ?? 0) - 1];
  if (!plan) {
    told.textContent = "No plan is chosen.";
    return;
  }
  const line = document.createElement("p");
  const name = document.createElement("strong");
  name.textContent = `Plan ${plan.number}`;
  const where = data.regions.filter((region) => region.plan === number);
  const texts = where.slice(0, 4).map((region) => `ψ ${region.text[0]} with β ${region.text[1]}`);
  const more = where.length > 4 ? ` and ${where.length - 4} more parts` : "";
  line.append(name, `${said(plan).slice(said(plan).indexOf(":"))}; optimal for ${texts.join("; ")}${more}${plan.unique ? "" : "; not everywhere the only one"}.`);
  const list = document.createElement("ul");
  for (const text of plan.robots) {
    const item = document.createElement("li");
    item.textContent = text;
    list.append(item);
  }
  told.append(line, list);
}

function watch(part, number) {
  part.addEventListener("pointerenter", () => { if (kept === null) show(number); });
  part.addEventListener("pointerleave", () => { if (kept === null) show(null); });
  part.addEventListener("focus", () => { if (kept === null) show(number); });
  part.addEventListener("blur", () => { if (kept === null) show(null); });
  part.addEventListener("click", () => keep(number));
  part.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    keep(number);
  });
}

function keep(number) {
  kept = kept === number ? null : number;
  show(kept);
}

addEventListener("keydown", (event) => {
  if (event.key !== "Escape") return;
  kept = null;
  show(null);
});

for (const [id, name] of Object.entries(choice)) {
  const select = document.getElementById(id);
  for (const metric of Object.keys(data.metrics)) select.add(new Option(data.metrics[metric].title, metric, false, metric === name));
  select.addEventListener("change", () => {
    choice[id] = select.value;
    drawSpace();
    drawSquare();
    show(kept);
  });
}
drawTable();
drawSpace();
drawSquare();
show(null);
})();
