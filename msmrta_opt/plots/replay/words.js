/* What is said in words: tables, details, and what a screen reader is told. */

function count(n, noun) {
  return `${n} ${noun}${n === 1 ? "" : "s"}`;
}

function names(plan, kinds) {
  return kinds.map((kind) => plan.kinds[kind]).join(", ");
}

function doing(plan, now) {
  const victim = now.visit && plan.victims[now.visit.victim].id;
  return {
    walking: () => (now.visit ? `walking to v${victim}` : "walking"),
    serving: () => `serving v${victim}: ${names(plan, now.visit.kinds)}`,
    returning: () => "walking back to its start",
    waiting: () => "waiting",
    lost: () => "lost",
    finished: () => "finished",
    unused: () => "not used",
  }[now.state]();
}

function needSaid(plan, need, victim) {
  const kind = plan.kinds[need.kind];
  return {
    served: () => `${kind} ✓ R${need.visit.robot.id}`,
    serving: () => `${kind} … R${need.visit.robot.id}`,
    open: () => `${kind} ○`,
    unserved: () => `${kind} ✗ ${victim.unserved[need.kind]}`,
  }[need.state]();
}

function needsSaid(plan, victim, needs) {
  return needs.map((need) => needSaid(plan, need, victim)).join("; ") || "nothing";
}

function foundSaid(plan, victim, step) {
  const found = plan.scouting && plan.scouting.found.get(victim.id);
  if (!plan.scouting) return "known";
  return found && found.step <= step ? `found by S${found.scout} at step ${found.step}` : "not found";
}

function robotLines(plan, robot, t) {
  const now = robotAt(robot, t), to = (victims) => victims.map((v) => `v${plan.victims[v].id}`).join(" → ") || "none";
  const been = robot.visits.map((v) => v.victim).filter((v, i, all) => v !== all[i - 1]);
  return [
    `Robot ${robot.id}: ${doing(plan, now)}`,
    `at row ${now.cell[0]}, column ${now.cell[1]}; ${short(robot.speed)} cells per time unit`,
    `can: ${names(plan, robot.can) || "nothing"}`,
    ...(robot.queues ? [`to come: ${to(queueAt(robot, t))}`] : []),
    `visits: ${to(been)}; done at ${short(robot.home)}`,
    ...(typeof robot.lost === "number" ? [`lost at ${short(robot.lost)}`] : []),
  ];
}

function victimLines(plan, victim, t) {
  const lines = [
    `Victim ${victim.id} at row ${victim.cell[0]}, column ${victim.cell[1]}`,
    ...needsAt(victim, t).map((need) => {
      const when = need.visit && (need.state !== "open" || !plan.run) ? ` (${plan.stages[need.visit.stage].name}, ${span(need.visit)})` : "";
      return needSaid(plan, need, victim) + when;
    }),
  ];
  if (!victim.needs.length) lines.push("needs nothing");
  if (victim.priority !== 1) lines.push(`priority ${short(victim.priority)}`);
  const found = plan.scouting && plan.scouting.found.get(victim.id);
  if (found) lines.push(`found by scout ${found.scout} at step ${found.step}`);
  if (victim.turnedUp) lines.push(victim.turnedUp);
  return lines;
}

function span(visit) {
  return `time ${short(visit.arrival)} to ${short(visit.departure)}`;
}

function visitLines(plan, visit) {
  return [
    `Robot ${visit.robot.id} at victim ${plan.victims[visit.victim].id}`,
    `${span(visit)}: ${names(plan, visit.kinds)}`,
    `decided by ${plan.stages[visit.stage].title}`,
    `${count(visit.path.length, "cell")} walked to it`,
    ...(visit.cut ? [`cut short, for ${visit.robot.lost === visit.departure ? "the robot was lost" : "the run ended"}`] : []),
  ];
}

function eventSaid(plan, event) {
  if (event.text) return event.text;
  const { visit } = event, who = `R${visit.robot.id}`, victim = `v${plan.victims[visit.victim].id}`;
  if (event.done && visit.cut) return visit.robot.lost === visit.departure
    ? `${who} is lost while it serves ${victim}` : `${who} still serves ${victim} when the run ends`;
  return event.done ? `${who} has served ${names(plan, visit.kinds)} at ${victim}` : `${who} reaches ${victim}`;
}

/* What a decision of a run changed, robot by robot. */
function decisionLines(plan, decision) {
  const to = (victims) => victims.map((v) => `v${plan.victims[v].id}`).join(" ") || "nothing";
  return decision.queues.map(([i, before, after]) => `R${plan.robots[i].id}: ${to(before)} became ${to(after)}`);
}

/* What the plan has come to at time t, in a sentence or two. */
function summary(plan, t) {
  const now = plan.robots.map((robot) => [robot, robotAt(robot, t)]);
  const said = `${served(plan, t)} of ${plan.available} available requirements served`;
  if (now.length <= 8) return `${said}. ${now.map(([robot, at]) => `R${robot.id} ${doing(plan, at)}`).join("; ")}.`;
  const counts = {};
  for (const [, at] of now) counts[at.state] = (counts[at.state] || 0) + 1;
  const titles = { walking: "walking", serving: "serving", returning: "walking back", waiting: "waiting", lost: "lost", finished: "finished", unused: "not used" };
  return `${said}. Robots: ${Object.keys(titles).filter((x) => counts[x]).map((x) => `${counts[x]} ${titles[x]}`).join(", ")}.`;
}

function served(plan, t) {
  return plan.robots.reduce((sum, robot) => sum + robot.visits.reduce((n, v) => n + (t >= v.departure && !v.cut ? v.kinds.length : 0), 0), 0);
}

function scoutingSummary(plan, step) {
  const { scouting } = plan;
  if (!scouting) return "No scouting: all victims were known.";
  const found = scouting.finds.filter((find) => find[2] <= step).map((find) => `v${find[0]}`);
  const share = scouting.coverage[Math.min(Math.floor(step), scouting.steps)] || 0;
  const who = found.length && found.length <= 20 ? `: ${found.join(", ")}` : "";
  return `${Math.round(100 * share)} % covered; ${found.length} of ${plan.victims.length} victims found${who}.`;
}

function short(number) {
  return String(+number.toPrecision(6));
}
