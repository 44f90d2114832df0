"use strict";
// Tables are sorted by a click on a heading; what is folded is open on wide windows and on paper.
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0];
  const headings = [...table.tHead.rows[0].cells];
  if (body.rows.length < 2) continue;
  headings.forEach((heading, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => {
      const down = heading.getAttribute("aria-sort") === "ascending";
      for (const other of headings) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", down ? "descending" : "ascending");
      const rows = [...body.rows].map((row) => [key(row.cells[column]), row]);
      rows.sort(([a], [b]) => compare(a, b, down ? -1 : 1));
      body.append(...rows.map(([, row]) => row));
    });
  });
}

function key(cell) {
  if (!("value" in cell.dataset)) return cell.textContent;
  const number = parseFloat(cell.dataset.value);
  return Number.isNaN(number) ? null : number;
}

// What is not known comes last, whichever way.
function compare(a, b, sign) {
  if (a === null || b === null) return (a === null) - (b === null);
  return sign * (typeof a === "number" ? a - b : a.localeCompare(b, "en", { numeric: true }));
}

const folds = [...document.querySelectorAll("details")];
const unfold = () => folds.forEach((fold) => { fold.open = true; });
addEventListener("beforeprint", unfold);
if (matchMedia("(min-width: 60rem)").matches) unfold();
