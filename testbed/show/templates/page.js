"use strict";
(() => {
  const { $ } = Plots;

  /* Tables: a click on a heading sorts by that column, numbers by value and the rest as text; unknown values last. */
  for (const table of document.querySelectorAll("table.sortable")) {
    const heads = [...table.tHead.rows[table.tHead.rows.length - 1].cells];
    heads.forEach((head, column) => head.querySelector("button")?.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const key = (row) => { const cell = row.cells[column]; return cell.dataset.v ?? cell.textContent.trim().replace("\u2212", "-"); };
      const rows = [...table.tBodies[0].rows];
      const unknown = (text) => text === "" || text === "\u2013";
      rows.sort((a, b) => {
        const [x, y] = [key(a), key(b)];
        if (unknown(x) || unknown(y)) return unknown(x) - unknown(y);
        const numeric = x !== "" && y !== "" && !isNaN(x) && !isNaN(y);
        return (numeric ? x - y : x.localeCompare(y)) * (down ? -1 : 1);
      });
      table.tBodies[0].append(...rows);
    }));
  }
  for (const button of document.querySelectorAll(".copy")) {
    button.addEventListener("click", () => navigator.clipboard?.writeText(button.dataset.text).then(() => button.classList.add("done"), () => {}));
  }

  const { box } = Plots;
  const PRINTED = { plan: [672, 440], space: [672, 440], curves: [672, 480] }; // px on A4
  const CURVES = [["clearance_m", "clearance, m"], ["cross_track_m", "cross-track, m"], ["bank_deg", "bank, deg"], ["load_factor", "load factor"], ["airspeed_mps", "airspeed, m/s"]];
  let data, group, hidden = new Set(), origin = "nearest", near = false;
  const flights = () => group.flights.filter((id) => !hidden.has(id)).map((id) => data.flights[id]);
  const view = () => `${group.title} ${near}`;
  const drawPlan = () => Plots.plan("plan", flights(), near ? box(flights()) : null, PRINTED.plan, view());
  const drawSpace = () => Plots.space("space", flights(), near ? box(flights()) : null, PRINTED.space, view());

  function drawCurves() {
    const zero = (flight) => (origin === "nearest" && flight.nearest_s !== null ? flight.nearest_s : 0);
    const panels = CURVES.map(([name, title]) => [name, title, name === "clearance_m" ? { range: Plots.clearanceRange(flights(), 150) } : {}]);
    const title = origin === "nearest" ? "time from the closest approach, s" : "time, s";
    return Plots.curves("curves", flights(), panels, zero, { title }, [Plots.limit("y", 0)], PRINTED.curves, view());
  }

  function draw() {
    Plots.chips("chips", group.flights.map((id) => [id, data.flights[id], data.flights[id].collided ? " (collided)" : ""]), hidden, draw);
    return Promise.all([drawPlan(), drawSpace(), drawCurves()]);
  }

  function choose(index) {
    group = data.groups[index];
    hidden = new Set();
    $("group-title").textContent = `: ${group.title}`;
    $("left-out").textContent = group.left_out ? `${group.left_out} more flights are not drawn` : "";
  }

  function begin(figures) {
    data = figures;
    data.groups.forEach((one, index) => $("group").append(new Option(one.title, String(index))));
    $("group").addEventListener("change", (event) => { choose(Number(event.target.value)); draw(); });
    $("extent").addEventListener("change", (event) => { near = event.target.value === "near"; drawPlan(); drawSpace(); });
    $("origin").addEventListener("change", (event) => { origin = event.target.value; drawCurves(); });
    $("group").value = String(data.first);
    choose(data.first);
  }
  Plots.add({ data: "figures-data", begin, draw, ids: () => Object.keys(PRINTED) });
})();
