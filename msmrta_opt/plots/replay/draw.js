/* The map with all that moves on it, and the strokes of all drawings. Nothing here keeps state: a `panel`
   has a plan and its canvases, a `scene` says what to show of it and when. */

const MARGIN = 12, TURN = 2 * Math.PI;
/* Share of the whole time for which a decision, or a victim that turned up, stays marked. */
const REPLAN_SHARE = 0.04;

function colours() {
  const style = getComputedStyle(document.documentElement), named = {};
  for (const name of ["ink", "paper", "faint", "line", "wall", "floor", "unseen", "sight", "red", "casing"]) {
    named[name] = style.getPropertyValue(`--${name}`).trim();
  }
  return named;
}

/* A canvas of so many CSS pixels, with its unit set to one of them, and nothing left of what was drawn. */
function cleared(canvas, width, height) {
  const dots = window.devicePixelRatio || 1;
  canvas.style.height = `${height}px`;
  canvas.width = Math.round(width * dots);
  canvas.height = Math.round(height * dots);
  const pen = canvas.getContext("2d");
  pen.setTransform(dots, 0, 0, dots, 0, 0);
  return pen;
}

/* Map */

/* How cells become pixels: `x(column)`, `y(row)` of a cell's centre. */
function mapScale(panel) {
  const [rows, cols] = panel.plan.shape, width = panel.map.clientWidth;
  const tallest = Math.max(240, window.innerHeight * (panel.beside ? 0.5 : 0.6));
  const cell = Math.min((width - 2 * MARGIN) / cols, (tallest - 2 * MARGIN) / rows);
  const height = Math.max(cell * rows, 20) + 2 * MARGIN;
  const zoomed = cell * panel.view.zoom;
  const left = (width - zoomed * cols) / 2 + panel.view.x, top = (height - zoomed * rows) / 2 + panel.view.y;
  const mark = Math.min(Math.max(0.4 * zoomed, 2.6), 15);
  return {
    width, height, cell: zoomed, mark, left, top, casing: mark < 5 ? 0.6 : 1.6,
    named: zoomed >= 15 && (panel.plan.victims.length <= 40 || panel.view.zoom > 1),
    line: Math.min(Math.max(0.13 * zoomed, 1.2), 4),
    x: (col) => left + (col + 0.5) * zoomed,
    y: (row) => top + (row + 0.5) * zoomed,
  };
}

function drawMap(panel, scene) {
  const scale = mapScale(panel), pen = cleared(panel.map, scale.width, scale.height);
  panel.scale = scale;
  panel.marks = [];
  drawGround(pen, panel, scene, scale);
  if (scene.scouting) {
    drawScouts(pen, panel, scene, scale);
    return;
  }
  if (scene.layers.clusters) drawClusters(pen, panel, scene, scale);
  const now = panel.plan.robots.map((robot) => robotAt(robot, scene.t));
  const shift = laneShift(panel.plan, scale);
  panel.plan.robots.forEach((robot, i) => drawTrail(pen, robot, now[i], scene, scale, shift(i)));
  if (panel.plan.run) {
    drawChanges(pen, panel, scene, scale);
    drawQueues(pen, panel.plan, now, scene, scale);
  }
  pen.globalAlpha = 1;
  pen.setLineDash([]);
  for (const victim of panel.plan.victims) drawVictim(pen, panel, victim, scene, scale);
  panel.plan.robots.forEach((robot, i) => drawRobot(pen, panel, robot, now[i], scene, scale));
}

/* Walls, and while scouting what has been seen: a picture of one dot a cell, drawn large. */
function drawGround(pen, panel, scene, scale) {
  const plan = panel.plan, [rows, cols] = plan.shape;
  const name = `${scene.theme}:${scene.scouting ? scene.step : "all"}`;
  if (panel.groundName !== name) {
    const picture = document.createElement("canvas");
    picture.width = cols;
    picture.height = rows;
    const small = picture.getContext("2d"), { wall, floor, unseen, sight } = scene.colours;
    for (let i = 0; i < plan.free.length; i++) {
      const seen = plan.scouting && scene.scouting ? plan.scouting.seen[i] : 0;
      const isSeen = seen >= 0 && (!scene.scouting || seen <= scene.step);
      small.fillStyle = !plan.free[i] ? wall : isSeen ? floor : unseen;
      small.fillRect(i % cols, Math.floor(i / cols), 1, 1);
      if (scene.scouting && plan.scouting && isSeen && plan.free[i]) {
        const age = (scene.step - seen) / Math.max(plan.scouting.steps, 1);
        small.globalAlpha = 0.12 + 0.3 * (1 - age);
        small.fillStyle = sight;
        small.fillRect(i % cols, Math.floor(i / cols), 1, 1);
        small.globalAlpha = 1;
      }
    }
    panel.ground = picture;
    panel.groundName = name;
  }
  pen.imageSmoothingEnabled = false;
  pen.drawImage(panel.ground, scale.left, scale.top, cols * scale.cell, rows * scale.cell);
  pen.strokeStyle = scene.colours.line;
  pen.lineWidth = 1;
  if (scale.cell >= 14) {
    pen.globalAlpha = 0.4;
    pen.beginPath();
    for (let row = 1; row < rows; row++) trace(pen, [[row - 0.5, -0.5], [row - 0.5, cols - 0.5]], scale);
    for (let col = 1; col < cols; col++) trace(pen, [[-0.5, col - 0.5], [rows - 0.5, col - 0.5]], scale);
    pen.stroke();
    pen.globalAlpha = 1;
  }
  pen.strokeRect(scale.left, scale.top, cols * scale.cell, rows * scale.cell);
}

function trace(pen, points, scale, shift = 0) {
  points.forEach(([row, col], i) => {
    const x = scale.x(col + shift), y = scale.y(row + shift);
    if (i) pen.lineTo(x, y);
    else pen.moveTo(x, y);
  });
}

/* Sideways shifts, in cells, that keep the walks of several robots over the same cells apart. */
function laneShift(plan, scale) {
  const n = plan.robots.length, step = Math.min(0.6 / Math.max(n - 1, 1), (1.6 * scale.line) / scale.cell);
  return (i) => (i - (n - 1) / 2) * step;
}

function drawTrail(pen, robot, now, scene, scale, shift) {
  const chosen = scene.robot === null || scene.robot === robot.id;
  const since = scene.layers.trails === "recent" ? scene.t - 0.08 * scene.horizon : -Infinity;
  pen.lineJoin = pen.lineCap = "round";
  const draw = (points, alpha, isAhead) => {
    if (points.length < 2) return;
    pen.beginPath();
    trace(pen, points, scale, shift);
    pen.globalAlpha = alpha * (chosen ? 1 : 0.15);
    pen.setLineDash(isAhead ? [1, 2 * scale.line + 2] : robot.dash.map((x) => x * scale.line));
    if (!isAhead) {
      pen.strokeStyle = scene.colours.casing;
      pen.lineWidth = scale.line + scale.casing;
      pen.stroke();
    }
    pen.strokeStyle = robot.colour;
    pen.lineWidth = isAhead ? Math.max(0.6 * scale.line, 1) : scale.line;
    pen.stroke();
  };
  for (const leg of robot.legs) {
    const shown = !leg.visit || scene.layers.stages.has(leg.visit.stage) ? 0.95 : 0.15;
    const length = leg.path.length, share = leg.end > leg.begin ? (scene.t - leg.begin) / (leg.end - leg.begin) : Infinity;
    const done = scene.t < leg.begin ? 0 : Math.min(Math.max(share, 0), 1) * length;
    if (done > 0 && leg.end > since && scene.layers.trails !== "none") draw(part(leg.path, 0, done), shown, false);
    // What comes of a run is not known yet; what was to be is drawn by drawQueues.
    if (done < length && !robot.queues && (scene.layers.ahead || scene.robot === robot.id)) draw(part(leg.path, done, length), shown, true);
  }
}

/* Cells that events have blocked, a boxed cross, or opened, a box; filled once robots know. */
function drawChanges(pen, panel, scene, scale) {
  const { ink, wall, floor } = scene.colours, half = Math.max(scale.cell / 2, 3);
  for (const { row, col, free, noticed } of changesAt(panel.plan, scene.t)) {
    const x = scale.x(col), y = scale.y(row);
    pen.fillStyle = free ? floor : wall;
    pen.globalAlpha = noticed ? 0.8 : 0.3;
    pen.fillRect(x - scale.cell / 2, y - scale.cell / 2, scale.cell, scale.cell);
    pen.globalAlpha = 1;
    pen.strokeStyle = ink;
    pen.lineWidth = 1;
    pen.strokeRect(x - half, y - half, 2 * half, 2 * half);
    if (!free) cross(pen, x, y, half, ink, 1);
  }
}

/* What robots are to do next, as lines from victim to victim; for a while after a decision what it took
   away in red, what it gave in the colour of the robot. */
function drawQueues(pen, plan, now, scene, scale) {
  const cell = (victim) => plan.victims[victim].cell;
  const draw = (start, victims, colour, dash) => {
    pen.beginPath();
    trace(pen, [start, ...victims.map(cell)], scale);
    pen.setLineDash(dash);
    pen.strokeStyle = colour;
    pen.lineWidth = Math.max(0.5 * scale.line, 1.2);
    pen.globalAlpha = 0.85;
    pen.stroke();
  };
  const last = plan.run.decisions.findLast((x) => x.time <= scene.t);
  const fresh = last && scene.layers.replans && scene.t - last.time < REPLAN_SHARE * scene.horizon ? last.queues : [];
  for (const [i, before, after] of fresh) {
    if (scene.robot !== null && scene.robot !== plan.robots[i].id) continue;
    draw(now[i].point, before, scene.colours.red, [2, 5]);
    draw(now[i].point, after, plan.robots[i].colour, [7, 4]);
  }
  plan.robots.forEach((robot, i) => {
    if ((scene.layers.ahead || scene.robot === robot.id) && !fresh.some(([number]) => number === i)) {
      draw(now[i].point, queueAt(robot, scene.t), robot.colour, [1, 2 * scale.line + 2]);
    }
  });
  pen.setLineDash([]);
  pen.globalAlpha = 1;
}

/* The points of a walk from `f` cells on to `g`. */
function part(path, f, g) {
  const from = pointAt(path, f), to = pointAt(path, g);
  return [from.point, ...path.corners.slice(from.corner + 1, to.corner + 1), to.point];
}

function drawVictim(pen, panel, victim, scene, scale) {
  const [row, col] = victim.cell, x = scale.x(col), y = scale.y(row), radius = scale.mark;
  const missed = panel.plan.scouting && panel.plan.scouting.missed.includes(victim.id);
  const needs = needsAt(victim, scene.t), wedge = TURN / Math.max(needs.length, 1);
  if (!isKnown(victim, scene.t)) {
    pen.setLineDash([3, 3]);
    ring(pen, x, y, radius, scene.colours.faint);
    pen.setLineDash([]);
    panel.marks.push({ x, y, radius: radius + 3, victim });
    return;
  }
  const age = victim.appears > 0 ? (scene.t - victim.appears) / (REPLAN_SHARE * scene.horizon) : 1;
  if (age < 1) ring(pen, x, y, radius + 4 + 14 * age, scene.colours.sight);
  disc(pen, x, y, radius + scale.casing, scene.colours.casing);
  disc(pen, x, y, radius, scene.colours.paper);
  needs.forEach((need, i) => {
    if (need.share === 0) return;
    const from = -TURN / 4 + i * wedge, shown = scene.layers.stages.has(need.visit.stage);
    pen.globalAlpha = (need.state === "served" ? 1 : 0.6) * (shown ? 1 : 0.25);
    pen.fillStyle = need.visit.robot.colour;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.arc(x, y, radius * Math.sqrt(need.share), from, from + wedge);
    pen.closePath();
    pen.fill();
  });
  pen.globalAlpha = 1;
  const open = needs.some((need) => need.state === "unserved");
  pen.setLineDash(missed ? [3, 2] : []);
  pen.strokeStyle = open ? scene.colours.red : scene.colours.ink;
  pen.lineWidth = open ? Math.max(2.5, 0.22 * radius) : Math.min(1.2, radius / 4);
  pen.beginPath();
  pen.arc(x, y, radius, 0, TURN);
  if (needs.length > 1 && radius > 4) {
    for (let i = 0; i < needs.length; i++) {
      const angle = -TURN / 4 + i * wedge;
      pen.moveTo(x, y);
      pen.lineTo(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
    }
  }
  pen.stroke();
  pen.setLineDash([]);
  if (scene.victim === victim.id) ring(pen, x, y, radius + 4, scene.colours.ink);
  if (scale.named) word(pen, `v${victim.id}`, x + radius * 0.9, y - radius * 0.9, scene, "left");
  panel.marks.push({ x, y, radius: radius + 3, victim });
}

function drawRobot(pen, panel, robot, now, scene, scale) {
  const x = scale.x(now.point[1]), stands = panel.cells.has(String(now.point));
  const y = scale.y(now.point[0]) + (stands ? scale.mark + 7 : 0);  // below the victim that it is at
  pen.globalAlpha = scene.robot === null || scene.robot === robot.id ? 1 : 0.35;
  let radius = Math.max(0.9 * scale.mark, 4);
  const isLost = now.state === "lost", { paper, faint, red } = scene.colours;
  if (scale.cell < 8) {
    disc(pen, x, y, radius + 2, scene.colours.casing);
    disc(pen, x, y, radius, isLost ? faint : robot.colour);
    ring(pen, x, y, radius, "#202020");
  } else {
    const size = Math.min(radius, 10);
    radius = badge(pen, `R${robot.id}`, x, y, isLost ? faint : robot.colour, isLost ? paper : robot.ink, size, scene);
  }
  if (isLost) cross(pen, x + radius, y - 6, 5, red, 2.5);  // beside the name
  pen.globalAlpha = 1;
  panel.marks.push({ x, y, radius: radius + 3, robot });
}

function drawClusters(pen, panel, scene, scale) {
  const of = new Map(panel.plan.robots.map((robot) => [robot.id, robot]));
  const cells = new Map(panel.plan.victims.map((victim) => [victim.id, victim.cell]));
  pen.lineWidth = 1;
  panel.plan.clusters.forEach((cluster, number) => {
    const taker = of.get(cluster.robots[0]), [row, col] = cluster.centre;
    pen.strokeStyle = taker ? taker.colour : scene.colours.faint;
    pen.globalAlpha = 0.6;
    for (const victim of cluster.victims) {
      pen.beginPath();
      trace(pen, [cluster.centre, cells.get(victim)], scale);
      pen.stroke();
    }
    pen.globalAlpha = 1;
    word(pen, `C${number}`, scale.x(col), scale.y(row), scene, "center");
  });
}

/* Scouting */

function drawScouts(pen, panel, scene, scale) {
  const { scouting, victims, shape } = panel.plan, scouts = scouting ? scouting.scouts : [];
  pen.fillStyle = scene.colours.sight;
  pen.globalAlpha = 0.45;
  for (const scout of scouts) {
    for (const cell of inSight(panel.plan, scoutAt(scout, scene.step), scout.depth)) {
      pen.fillRect(scale.x((cell % shape[1]) - 0.5), scale.y(Math.floor(cell / shape[1]) - 0.5), scale.cell, scale.cell);
    }
  }
  pen.globalAlpha = 1;
  for (const victim of victims) {
    const found = scouting && scouting.found.get(victim.id), x = scale.x(victim.cell[1]), y = scale.y(victim.cell[0]);
    const known = !scouting || (found && found.step <= scene.step);
    disc(pen, x, y, scale.mark + scale.casing, scene.colours.casing);
    disc(pen, x, y, scale.mark, known ? scene.colours.ink : scene.colours.paper);
    ring(pen, x, y, scale.mark, known ? scene.colours.ink : scene.colours.red);
    if (scale.named) word(pen, `v${victim.id}`, x + scale.mark * 0.9, y - scale.mark * 0.9, scene, "left");
    panel.marks.push({ x, y, radius: scale.mark + 3, victim });
  }
  for (const scout of scouts) {
    const f = Math.min(scene.step, scout.path.length), [row, col] = pointAt(scout.path, f).point;
    pen.strokeStyle = scene.colours.ink;
    pen.lineWidth = Math.max(0.6 * scale.line, 1);
    pen.beginPath();
    trace(pen, part(scout.path, Math.max(f - 25, 0), f), scale);
    pen.stroke();
    const x = scale.x(col), y = scale.y(row), { ink, paper } = scene.colours;
    const radius = badge(pen, `S${scout.id}`, x, y, ink, paper, Math.min(scale.mark, 10), scene);
    panel.marks.push({ x, y, radius: radius + 3, scout });
  }
}

/* Strokes */

function disc(pen, x, y, radius, colour) {
  pen.fillStyle = colour;
  pen.beginPath();
  pen.arc(x, y, radius, 0, TURN);
  pen.fill();
}

function ring(pen, x, y, radius, colour) {
  pen.strokeStyle = colour;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.arc(x, y, radius, 0, TURN);
  pen.stroke();
}

function cross(pen, x, y, half, colour, width) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.beginPath();
  pen.moveTo(x - half, y - half);
  pen.lineTo(x + half, y + half);
  pen.moveTo(x + half, y - half);
  pen.lineTo(x - half, y + half);
  pen.stroke();
}

/* A name in a rounded box; returns half the box's width. */
function badge(pen, name, x, y, face, ink, size, scene) {
  const font = Math.max(size * 1.15, 9);
  pen.font = `700 ${font}px system-ui, sans-serif`;
  const half = Math.max(pen.measureText(name).width / 2 + 3, size * 0.9), high = font * 0.72;
  pen.beginPath();
  pen.roundRect(x - half, y - high, 2 * half, 2 * high, 4);
  pen.strokeStyle = scene.colours.casing;
  pen.lineWidth = 2.5;
  pen.stroke();
  pen.fillStyle = face;
  pen.fill();
  pen.fillStyle = ink;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillText(name, x, y + 0.5);
  return half;
}

function word(pen, text, x, y, scene, side) {
  pen.font = "600 11px system-ui, sans-serif";
  pen.textAlign = side;
  pen.textBaseline = "middle";
  pen.lineJoin = "round";
  pen.strokeStyle = scene.colours.paper;
  pen.lineWidth = 3;
  pen.strokeText(text, x, y);
  pen.fillStyle = scene.colours.ink;
  pen.fillText(text, x, y);
}
