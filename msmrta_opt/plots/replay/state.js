/* What is where at a time: the plan's walks, visits and sights, unpacked. Nothing here draws.
   Cells are [row, column]; times are the plan's; `f` counts cells along a walk. */

const STEPS = { R: [0, 1], D: [1, 0], L: [0, -1], U: [-1, 0], S: [0, 0] };
const ROUNDING = 1e-9;

/* A walk from its code, "R3D": its corners, and how many cells lie before each. */
function unpackWalk(start, code) {
  let [row, col] = start;
  const corners = [[row, col]], before = [0];
  for (const [, letter, count] of code.matchAll(/([RDLUS])(\d*)/g)) {
    const n = count ? +count : 1, [down, right] = STEPS[letter];
    row += n * down;
    col += n * right;
    corners.push([row, col]);
    before.push(before[before.length - 1] + n);
  }
  return { corners, before, length: before[before.length - 1], end: [row, col] };
}

/* The point after `f` cells of a walk, and the corner that it has passed last. */
function pointAt(walk, f) {
  let i = walk.before.length - 1;
  while (i > 0 && walk.before[i] > f) i--;
  const [row, col] = walk.corners[i];
  if (i === walk.corners.length - 1) return { point: [row, col], corner: i };
  const [nextRow, nextCol] = walk.corners[i + 1];
  const share = (f - walk.before[i]) / (walk.before[i + 1] - walk.before[i]);
  return { point: [row + (nextRow - row) * share, col + (nextCol - col) * share], corner: i };
}

function unpackPlan(plan, number) {
  const [rows, cols] = plan.shape;
  plan.number = number;
  plan.free = new Uint8Array(rows * cols);
  let next = 0;
  plan.walls.forEach((run, i) => {
    if (i % 2 === 0) plan.free.fill(1, next, next + run);
    next += run;
  });
  plan.victims.forEach((victim) => { victim.visits = []; });
  plan.events = [];
  for (const robot of plan.robots) {
    let here = robot.start, clock = 0;
    for (const visit of robot.visits) {
      visit.path = unpackWalk(here, visit.walk);
      visit.begin = clock;
      visit.robot = robot;
      here = visit.path.end;
      clock = visit.departure;
      plan.victims[visit.victim].visits.push(visit);
      plan.events.push({ time: visit.arrival, visit, done: false });
      plan.events.push({ time: visit.departure, visit, done: true });
    }
    robot.backPath = unpackWalk(here, robot.back);
    robot.done = clock;
  }
  plan.events.sort((a, b) => a.time - b.time);
  if (plan.scouting) unpackScouting(plan);
}

/* What a robot does at time t, and where. */
function robotAt(robot, t) {
  for (const [i, visit] of robot.visits.entries()) {
    if (t < visit.arrival) return { state: "walking", visit, visits: i, ...along(visit.path, t, visit.begin, visit.arrival) };
    if (t < visit.departure) return { state: "serving", visit, visits: i, ...along(visit.path, 1, 0, 0) };
  }
  const visits = robot.visits.length;
  if (!visits) return { state: "unused", visits, ...along(robot.backPath, 1, 0, 0) };
  if (t < robot.home) return { state: "returning", visits, ...along(robot.backPath, t, robot.done, robot.home) };
  return { state: "finished", visits, ...along(robot.backPath, 1, 0, 0) };
}

function along(path, t, begin, end) {
  const f = end > begin ? Math.min(((t - begin) / (end - begin)) * path.length, path.length) : path.length;
  const whole = Math.floor(f + ROUNDING);
  return { f, cell: pointAt(path, whole).point, ...pointAt(path, f) };
}

/* Of each need of a victim: "served", "serving" or "open", by which visit, and how much of it is done. */
function needsAt(victim, t) {
  return victim.needs.map((kind) => {
    const visit = victim.visits.find((v) => v.kinds.includes(kind));
    if (!visit || t < visit.arrival) return { kind, state: kind in victim.unserved ? "unserved" : "open", visit, share: 0 };
    if (t >= visit.departure) return { kind, state: "served", visit, share: 1 };
    return { kind, state: "serving", visit, share: (t - visit.arrival) / (visit.departure - visit.arrival) };
  });
}

/* Scouting: the first step at which each cell was seen, who found whom, and where scouts are. */

function unpackScouting(plan) {
  const scouting = plan.scouting, looked = new Set();
  scouting.steps = Math.max(scouting.coverage.length - 1, 0);
  scouting.seen = new Int32Array(plan.free.length).fill(-1);
  scouting.found = new Map(scouting.finds.map(([victim, scout, step]) => [victim, { scout, step }]));
  for (const scout of scouting.scouts) scout.path = unpackWalk(scout.start, scout.walk);
  for (let step = 0; step <= scouting.steps; step++) {
    for (const scout of scouting.scouts) {
      const cell = scoutAt(scout, step), name = `${scout.depth}:${cell}`;
      if (looked.has(name)) continue;
      looked.add(name);
      for (const seen of inSight(plan, cell, scout.depth)) if (scouting.seen[seen] < 0) scouting.seen[seen] = step;
    }
  }
}

function scoutAt(scout, step) {
  return pointAt(scout.path, Math.min(step, scout.path.length)).point;
}

/* The numbers of the cells in sight of a cell: the rule of msmrta_opt.mission.visibility. */
function inSight(plan, [row, col], depth) {
  const [rows, cols] = plan.shape, found = [];
  for (let r = Math.max(row - depth, 0); r <= Math.min(row + depth, rows - 1); r++) {
    for (let c = Math.max(col - depth, 0); c <= Math.min(col + depth, cols - 1); c++) {
      if (plan.free[r * cols + c] && sees(plan, row, col, r, c)) found.push(r * cols + c);
    }
  }
  return found;
}

/* Whether the straight line between two centres enters no wall and squeezes between no two. */
function sees(plan, row, col, toRow, toCol) {
  const cols = plan.shape[1], down = Math.abs(toRow - row), right = Math.abs(toCol - col);
  const isFree = (r, c) => plan.free[(row + Math.sign(toRow - row) * r) * cols + col + Math.sign(toCol - col) * c];
  for (let k = 0; k < right; k++) {
    if (!isFree(Math.floor(((2 * k + 1) * down + right) / (2 * right)), k + 1)) return false;
  }
  for (let k = 0; k < down; k++) {
    const sum = (2 * k + 1) * right + down, entered = Math.floor(sum / (2 * down));
    const corner = sum % (2 * down) === 0 ? 1 : 0;
    if (!isFree(k + 1, entered - corner) && !isFree(k + 1 - corner, entered)) return false;
  }
  return true;
}
