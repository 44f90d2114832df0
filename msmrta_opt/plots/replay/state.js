/* What is where at a time: the walks, visits and sights of a plan or a run, unpacked. Nothing here draws.
   Cells are [row, column]; times are the plan's; `f` counts cells along a walk. A run's visits are of one
   kind each, and its walks are given apart, for robots also wait. */

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
    if (plan.run) unpackTrack(plan, robot);
    else unpackRoute(robot);
    for (const visit of robot.visits) {
      visit.robot = robot;
      plan.victims[visit.victim].visits.push(visit);
      plan.events.push({ time: visit.arrival, visit, done: false });
      plan.events.push({ time: visit.departure, visit, done: true });
    }
  }
  if (plan.run) unpackRun(plan);
  plan.events.sort((a, b) => a.time - b.time);
  if (plan.scouting) unpackScouting(plan);
}

/* A robot of a plan: from visit to visit without a pause, and back. */
function unpackRoute(robot) {
  let here = robot.start, clock = 0;
  robot.legs = [];
  for (const visit of robot.visits) {
    visit.path = unpackWalk(here, visit.walk);
    robot.legs.push({ path: visit.path, begin: clock, end: visit.arrival, visit });
    here = visit.path.end;
    clock = visit.departure;
  }
  if (robot.back) robot.legs.push({ path: unpackWalk(here, robot.back), begin: clock, end: robot.home, visit: null, isBack: true });
}

/* A robot of a run: walks with their times, each to the visit that began at its end, or to none. */
function unpackTrack(plan, robot) {
  let here = robot.start;
  for (const visit of robot.visits) visit.path = unpackWalk(plan.victims[visit.victim].cell, "");
  robot.legs = robot.walks.map(([begin, end, code, to]) => {
    const leg = { path: unpackWalk(here, code), begin, end, visit: to === null ? null : robot.visits[to] };
    here = leg.path.end;
    if (leg.visit) leg.visit.path = leg.path;
    return leg;
  });
}

/* What a run has beside its robots: events, and what each robot was to do from which time on. */
function unpackRun(plan) {
  const { run } = plan;
  for (const [time, text] of run.events) plan.events.push({ time, text });
  plan.robots.forEach((robot, i) => {
    robot.queues = [{ time: 0, victims: run.planned[i] }];
    for (const decision of run.decisions) {
      const own = decision.queues.find(([number]) => number === i);
      if (own) robot.queues.push({ time: decision.time, victims: own[2] });
    }
  });
}

/* The victims that a robot of a run is still to visit at time t, as the last decision had it. */
function queueAt(robot, t) {
  const queue = robot.queues.findLast((x) => x.time <= t);
  const begun = new Set(robot.visits.filter((v) => v.arrival >= queue.time && v.arrival <= t).map((v) => v.victim));
  return robot.lost !== null && robot.lost <= t ? [] : queue.victims.filter((victim) => !begun.has(victim));
}

/* Whether a victim is known at time t; in a run some turn up, or never do. */
function isKnown(victim, t) {
  return victim.appears === undefined || (victim.appears !== null && victim.appears <= t);
}

/* The cells of a run that events have changed by time t, and whether robots know. */
function changesAt(plan, t) {
  const now = new Map();
  if (plan.run) for (const [time, row, col, free] of plan.run.changes) if (time <= t) now.set(`${row},${col}`, { row, col, free, time });
  for (const change of now.values()) {
    change.noticed = plan.run.noticed.some(([time, row, col]) => row === change.row && col === change.col && time >= change.time && time <= t);
  }
  return [...now.values()];
}

/* What a robot does at time t, and where. */
function robotAt(robot, t) {
  const visits = robot.visits.filter((v) => v.departure <= t && !v.cut).length;
  const past = robot.legs.findLast((leg) => leg.begin <= t), next = robot.legs.find((leg) => t < leg.end);
  const here = past ? along(past.path, t, past.begin, past.end) : along(unpackWalk(robot.start, ""), 1, 0, 0);
  if (typeof robot.lost === "number" && robot.lost <= t) return { state: "lost", visits, ...here };
  const serving = robot.visits.find((v) => v.arrival <= t && t < v.departure);
  if (serving) return { state: "serving", visit: serving, visits, ...along(serving.path, 1, 0, 0) };
  if (next && next.begin <= t) return { state: next.isBack ? "returning" : "walking", visit: next.visit, visits, ...here };
  if (next || robot.visits.some((v) => t < v.arrival)) return { state: "waiting", visits, ...here };
  return { state: robot.legs.length || robot.visits.length ? "finished" : "unused", visits, ...here };
}

function along(path, t, begin, end) {
  const f = end > begin ? Math.min(((t - begin) / (end - begin)) * path.length, path.length) : path.length;
  const whole = Math.floor(f + ROUNDING);
  return { f, cell: pointAt(path, whole).point, ...pointAt(path, f) };
}

/* Of each need of a victim: "served", "serving" or "open", by which visit, and how much of it is done. */
function needsAt(victim, t) {
  return victim.needs.map((kind) => {
    const tries = victim.visits.filter((v) => v.kinds.includes(kind)).sort((a, b) => a.arrival - b.arrival);
    const visit = tries.findLast((v) => v.arrival <= t) || tries[0];
    const since = victim.since && kind in victim.since ? victim.since[kind] : 0;
    const state = kind in victim.unserved && since <= t ? "unserved" : "open";
    if (!visit || t < visit.arrival || (visit.cut && t >= visit.departure)) return { kind, state, visit, share: 0 };
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
