/* The timeline of the robots, or of what the scouts cover, with the moment that is shown. */

const GUTTER = 40, AXIS = 20;

function timeScale(panel, end) {
  const width = panel.gantt.clientWidth, long = Math.max(width - GUTTER - 14, 10);
  return { width, x: (time) => GUTTER + (end > 0 ? (time / end) * long : 0), time: (x) => Math.min(Math.max((x - GUTTER) / long, 0), 1) * end };
}

function drawGantt(panel, scene) {
  const { plan } = panel, n = plan.robots.length, tall = Math.max(3, Math.min(20, 300 / n));
  const time = timeScale(panel, scene.horizon), height = tall * n + AXIS;
  const pen = cleared(panel.gantt, time.width, height), { ink, faint, line } = scene.colours;
  panel.row = tall;
  panel.bars = [];
  pen.textBaseline = "middle";
  plan.robots.forEach((robot, i) => {
    const top = i * tall, middle = top + tall / 2;
    if (scene.robot === robot.id) {
      pen.fillStyle = line;
      pen.fillRect(0, top, time.width, tall);
    }
    if (tall >= 10 || scene.robot === robot.id) badge(pen, `R${robot.id}`, GUTTER / 2 - 2, middle, robot.colour, robot.ink, 8, scene);
    pen.fillStyle = robot.colour;
    const moves = plan.run ? robot.legs.map((leg) => [leg.begin, leg.end]) : robot.visits.length ? [[0, robot.home]] : [];
    pen.globalAlpha = 0.35;
    for (const [begin, end] of moves) pen.fillRect(time.x(begin), top + 0.36 * tall, time.x(end) - time.x(begin), 0.28 * tall);
    for (const [k, visit] of robot.visits.entries()) {
      const x = time.x(visit.arrival), wide = Math.max(time.x(visit.departure) - x, 1.5);
      pen.globalAlpha = scene.layers.stages.has(visit.stage) ? 1 : 0.2;
      pen.fillStyle = robot.colour;
      pen.fillRect(x, top + 0.1 * tall, wide, 0.8 * tall);
      if (scene.theme === "dark" && tall > 2.5) {
        pen.strokeStyle = scene.colours.casing;
        pen.lineWidth = tall > 6 ? 0.8 : 0.3;
        pen.strokeRect(x, top + 0.1 * tall, wide, 0.8 * tall);
      }
      const name = `v${plan.victims[visit.victim].id}`;
      if (tall >= 12 && wide > 7 * name.length + 2) {
        pen.font = "11px system-ui, sans-serif";
        pen.fillStyle = robot.ink;
        pen.textAlign = "center";
        pen.fillText(name, x + wide / 2, middle + 0.5);
      } else if (tall >= 12 && x + wide + 8 * name.length + 2 < freeUntil(robot, k, time)) {
        pen.font = "11px system-ui, sans-serif";
        pen.fillStyle = ink;
        pen.textAlign = "left";
        pen.fillText(name, x + wide + 2, middle + 0.5);
      }
      panel.bars.push({ x, wide, top, tall, visit });
      if (visit.cut) {
        pen.strokeStyle = scene.colours.red;
        pen.lineWidth = 1.5;
        pen.strokeRect(x, top + 0.1 * tall, wide, 0.8 * tall);
      }
    }
    pen.globalAlpha = 1;
    if (typeof robot.lost === "number") cross(pen, time.x(robot.lost), middle, Math.min(0.35 * tall, 5), scene.colours.red, 2);
  });
  drawAxis(pen, time, scene.horizon, height, scene);
  pen.strokeStyle = scene.colours.sight;
  pen.lineWidth = 1.5;
  for (const decision of plan.run ? plan.run.decisions : []) upright(pen, time.x(decision.time), height - AXIS);
  if (plan.run) drawMoments(pen, panel, time, height - AXIS + 3, scene.colours);
  pen.strokeStyle = faint;
  pen.setLineDash([4, 3]);
  upright(pen, time.x(plan.makespan), height - AXIS);
  pen.setLineDash([]);
  pen.strokeStyle = ink;
  pen.lineWidth = 2;
  upright(pen, time.x(scene.t), height - AXIS + 4);
}

/* Where, behind the k-th bar of a robot, the next bar or the mark of its loss is. */
function freeUntil(robot, k, time) {
  const next = robot.visits[k + 1], lost = typeof robot.lost === "number" ? time.x(robot.lost) - 6 : Infinity;
  return Math.min(next ? time.x(next.arrival) : time.width, lost);
}

/* Under the rows: when cells were blocked (full) or opened (a box), and victims turned up (a disc). */
function drawMoments(pen, panel, time, y, { ink, sight }) {
  for (const [at, , , opened] of panel.plan.run.changes) {
    pen.strokeStyle = pen.fillStyle = ink;
    pen.lineWidth = 1.2;
    pen[opened ? "strokeRect" : "fillRect"](time.x(at) - 3, y - 3, 6, 6);
  }
  for (const victim of panel.plan.victims) if (victim.appears > 0) disc(pen, time.x(victim.appears), y, 3.5, sight);
}

function drawCoverage(panel, scene) {
  const { scouting } = panel.plan, time = timeScale(panel, scene.steps), height = 110 + AXIS;
  const pen = cleared(panel.gantt, time.width, height), { ink, faint, sight, red } = scene.colours;
  const y = (share) => 100 - 88 * share;
  panel.bars = [];
  pen.textBaseline = "middle";
  pen.fillStyle = faint;
  pen.font = "11px system-ui, sans-serif";
  pen.textAlign = "right";
  for (const share of [0, 0.5, 1]) pen.fillText(`${100 * share} %`, GUTTER - 5, y(share));
  drawAxis(pen, time, scene.steps, height, scene);
  if (scouting) {
    pen.strokeStyle = sight;
    pen.lineWidth = 2.5;
    pen.beginPath();
    scouting.coverage.forEach((share, step) => pen[step ? "lineTo" : "moveTo"](time.x(step), y(share)));
    pen.stroke();
    for (const [victim, , step] of scouting.finds) {
      const x = time.x(step), at = y(scouting.coverage[Math.min(step, scouting.steps)] || 0);
      disc(pen, x, at, 4, step <= scene.step ? ink : red);
      panel.bars.push({ x: x - 5, wide: 10, top: 0, tall: 110, find: { victim, step } });
    }
  }
  pen.strokeStyle = ink;
  pen.lineWidth = 2;
  upright(pen, time.x(scene.step), height - AXIS + 4);
}

function drawAxis(pen, time, end, height, scene) {
  const rough = end / Math.max(2, Math.min(8, time.width / 90)), power = 10 ** Math.floor(Math.log10(rough || 1));
  const tick = power * [1, 2, 5, 10].find((x) => x * power >= rough * 0.999);
  pen.fillStyle = scene.colours.faint;
  pen.font = "11px system-ui, sans-serif";
  pen.textAlign = "center";
  if (!(tick > 0)) return;
  for (let i = 0; i * tick <= end * 1.0001; i++) pen.fillText(short(i * tick), time.x(i * tick), height - 8);
}

function upright(pen, x, height) {
  pen.beginPath();
  pen.moveTo(x, 0);
  pen.lineTo(x, height);
  pen.stroke();
}
