"use strict";
(() => {
  const $ = (id) => document.getElementById(id);

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
  if (!$("figures-data")) { document.body.dataset.ready = "1"; return; }

  async function unpack(id) {
    const bytes = Uint8Array.from(atob($(id).textContent), (c) => c.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  }

  let data, group, hidden = new Set(), origin = "nearest", near = false, printing = false;
  const night = matchMedia("(prefers-color-scheme: dark)");
  const dark = () => night.matches && !printing;
  const plain = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;"); // the plot library reads markup in names
  const ink = () => (printing ? "#000000" : getComputedStyle(document.documentElement).getPropertyValue("--ink").trim());
  const line = () => (printing ? "#d5dae0" : getComputedStyle(document.documentElement).getPropertyValue("--line").trim());
  const colour = (flight) => { const c = dark() ? flight.dark : flight.light; return c === "ink" ? ink() : c; };
  const flights = () => group.flights.filter((id) => !hidden.has(id)).map((id) => data.flights[id]);
  const CONFIG = { displaylogo: false, responsive: true, displayModeBar: false };

  const PRINTED = { plan: [672, 440], space: [672, 440], curves: [672, 480] }; // px on A4; on the screen the page decides

  function layout(id, extra) {
    const size = printing ? { autosize: false, width: PRINTED[id][0], height: PRINTED[id][1] } : { autosize: true };
    return { ...size, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { family: "system-ui, sans-serif", size: printing ? 9 : 12, color: ink() },
      margin: { l: 58, r: 12, t: 8, b: 40 }, showlegend: false, hovermode: "closest", uirevision: `${group.title} ${near}`, ...extra };
  }
  const axis = (title, extra = {}) => ({ title: { text: title }, gridcolor: line(), zerolinecolor: line(), linecolor: line(), ...extra });

  /* A box around all closest approaches, or null for the whole route. */
  function box() {
    const all = flights().flatMap((flight) => flight.obstacles);
    if (!near || !all.length) return null;
    return [0, 1, 2].map((k) => {
      const low = Math.min(...all.map((o) => o.nearest_enu_m[k] - 2.2 * o.radius_m)), high = Math.max(...all.map((o) => o.nearest_enu_m[k] + 2.2 * o.radius_m));
      return [low, high];
    });
  }

  function circle(x, y, r) {
    const xs = [], ys = [];
    for (let k = 0; k <= 60; k++) { xs.push(x + r * Math.cos(k * Math.PI / 30)); ys.push(y + r * Math.sin(k * Math.PI / 30)); }
    return [xs, ys];
  }

  function drawPlan() {
    const traces = [];
    for (const [second, yaxis] of [["y", "y"], ["z", "y2"]]) {
      const index = second === "y" ? 1 : 2;
      const add = (trace) => traces.push({ xaxis: "x", yaxis, hoverinfo: "skip", type: "scatter", mode: "lines", ...trace });
      for (const flight of flights()) {
        const c = colour(flight);
        for (const path of flight.paths) add({ x: path.x, y: path[second], line: { color: c, width: 0.8 }, opacity: 0.55 });
        for (const o of flight.obstacles) {
          add({ x: o.x, y: o[second], line: { color: c, width: 0.8, dash: "dot" }, opacity: 0.35 });
          const [cx, cy] = circle(o.nearest_enu_m[0], o.nearest_enu_m[index], o.radius_m);
          add({ x: cx, y: cy, line: { color: c, width: 1.3, dash: flight.dash }, fill: "toself", fillcolor: flight.collided ? "rgba(213,94,0,.16)" : "rgba(128,140,150,.10)",
            hoverinfo: "text", text: plain(`${o.name} nearest to ${flight.name} at ${o.nearest_time_s} s`), hoveron: "fills" });
        }
        add({ x: flight.x, y: flight[second], line: { color: c, width: 2.4, dash: flight.dash }, hoverinfo: "text",
          text: flight.time_s.map((t, k) => `${plain(flight.name)}<br>${t} s, (${flight.x[k]}, ${flight.y[k]}, ${flight.z[k]}) m`) });
        for (const d of flight.decisions) if (d.insertion_enu_m) add({ x: [d.insertion_enu_m[0]], y: [d.insertion_enu_m[index]], mode: "markers",
          marker: { symbol: "circle-open", size: 10, color: c, line: { width: 2 } }, hoverinfo: "text", text: plain(`insertion point, ${flight.name}`) });
      }
    }
    const limits = box(), range = (k) => (limits ? { range: limits[k] } : {});
    return Plotly.react("plan", traces, layout("plan", {
      xaxis: axis("east, m", { anchor: "y2", ...range(0) }), yaxis: axis("north, m", { domain: [0.42, 1], scaleanchor: "x", ...range(1) }),
      yaxis2: axis("up, m", { domain: [0, 0.33], scaleanchor: "x", ...range(2) }) }), CONFIG);
  }

  function ball(centre, r) {
    const x = [], y = [], z = [], i = [], j = [], k = [], around = 24, rings = 12;
    for (let a = 0; a <= rings; a++) for (let b = 0; b < around; b++) {
      const polar = a * Math.PI / rings, turn = b * 2 * Math.PI / around;
      x.push(centre[0] + r * Math.sin(polar) * Math.cos(turn)); y.push(centre[1] + r * Math.sin(polar) * Math.sin(turn)); z.push(centre[2] + r * Math.cos(polar));
      if (a < rings) {
        const p = a * around + b, q = a * around + (b + 1) % around;
        i.push(p, q); j.push(q, q + around); k.push(p + around, p + around);
      }
    }
    return { x, y, z, i, j, k };
  }

  function drawSpace() {
    const traces = [];
    const add = (trace) => traces.push({ type: "scatter3d", mode: "lines", hoverinfo: "skip", ...trace });
    for (const flight of flights()) {
      const c = colour(flight);
      for (const path of flight.paths) add({ x: path.x, y: path.y, z: path.z, line: { color: c, width: 1.5 }, opacity: 0.5 });
      for (const o of flight.obstacles) {
        add({ x: o.x, y: o.y, z: o.z, line: { color: c, width: 1.5, dash: "dot" }, opacity: 0.4 });
        traces.push({ type: "mesh3d", ...ball(o.nearest_enu_m, o.radius_m), color: c, opacity: 0.10, hoverinfo: "text", text: plain(`${o.name} nearest to ${flight.name}`) });
      }
      const dash = ["solid", "dot", "dash", "dashdot", "longdash"].includes(flight.dash) ? flight.dash : "solid";
      add({ x: flight.x, y: flight.y, z: flight.z, line: { color: c, width: 5, dash }, hoverinfo: "text", text: plain(flight.name) });
      for (const d of flight.decisions) if (d.insertion_enu_m) add({ x: [d.insertion_enu_m[0]], y: [d.insertion_enu_m[1]], z: [d.insertion_enu_m[2]],
        mode: "markers", marker: { symbol: "circle-open", size: 5, color: c }, hoverinfo: "text", text: plain(`insertion point, ${flight.name}`) });
    }
    const limits = box();
    const side = (title, k) => axis(title, { backgroundcolor: "rgba(0,0,0,0)", showspikes: false, ...(limits ? { range: limits[k] } : {}) });
    return Plotly.react("space", traces, layout("space", { margin: { l: 0, r: 0, t: 0, b: 0 }, scene: { aspectmode: "data", xaxis: side("east, m", 0), yaxis: side("north, m", 1), zaxis: side("up, m", 2),
      camera: { eye: { x: 0.4, y: -2.3, z: 1.05 }, up: { x: 0, y: 0, z: 1 }, center: { x: 0, y: 0, z: -0.12 } } } }), CONFIG);
  }

  const CURVES = [["clearance_m", "clearance, m"], ["cross_track_m", "cross-track, m"], ["bank_deg", "bank, deg"], ["load_factor", "load factor"], ["airspeed_mps", "airspeed, m/s"]];

  function drawCurves() {
    const traces = [], shapes = [], axes = {};
    const known = (flight) => (origin === "nearest" && flight.nearest_s !== null ? flight.nearest_s : 0);
    CURVES.forEach(([name, title], row) => {
      const yaxis = row ? `y${row + 1}` : "y", top = 1 - row / CURVES.length;
      axes[row ? `yaxis${row + 1}` : "yaxis"] = axis(title, { domain: [top - 1 / CURVES.length + 0.03, top], ...(name === "clearance_m" ? { range: clearanceRange() } : {}) });
      for (const flight of flights()) {
        const c = colour(flight), zero = known(flight), y = flight[name];
        if (!y.length) continue;
        traces.push({ type: "scatter", mode: "lines", x: flight.time_s.map((t) => t - zero), y, yaxis, name: plain(flight.name), line: { color: c, width: 1.8, dash: flight.dash },
          hovertemplate: `%{y} at %{x:.2f} s<extra>${plain(flight.name)}</extra>` });
        for (const d of flight.decisions) {
          let nearest = 0;
          flight.time_s.forEach((t, k) => { if (Math.abs(t - d.time_s) < Math.abs(flight.time_s[nearest] - d.time_s)) nearest = k; });
          traces.push({ type: "scatter", mode: "markers", x: [d.time_s - zero], y: [y[nearest]], yaxis, marker: { symbol: "x", size: 8, color: c },
            hovertemplate: `${plain(d.decision)} for ${plain(d.obstacle)} at ${d.time_s} s<extra>${plain(flight.name)}</extra>` });
        }
      }
    });
    shapes.push({ type: "line", xref: "paper", x0: 0, x1: 1, yref: "y", y0: 0, y1: 0, line: { color: "#D55E00", width: 1.5 } });
    return Plotly.react("curves", traces, layout("curves", { shapes, ...axes, xaxis: axis(origin === "nearest" ? "time from the closest approach, s" : "time, s", { anchor: `y${CURVES.length}` }) }), CONFIG);
  }

  /* Far away the clearance says nothing: show from the deepest point to where decisions are made. */
  function clearanceRange() {
    const all = flights().flatMap((flight) => flight.clearance_m).filter((value) => value !== null);
    if (!all.length) return undefined;
    const low = Math.min(0, ...all), high = Math.min(Math.max(...all), 150);
    return [low - 6, Math.max(high, 10)];
  }

  function draw() { return Promise.all([drawPlan(), drawSpace(), drawCurves()]); }

  function showChips() {
    $("chips").replaceChildren(...group.flights.map((id) => {
      const flight = data.flights[id], chip = document.createElement("button");
      chip.type = "button"; chip.className = "chip"; chip.setAttribute("aria-pressed", String(!hidden.has(id)));
      const dashes = { solid: "", dot: "2 3", dash: "7 4", dashdot: "7 3 2 3", longdash: "11 4" };
      chip.innerHTML = `<svg aria-hidden="true"><line x1="0" x2="26" y1="4" y2="4" stroke="${colour(flight)}" stroke-width="3" stroke-dasharray="${dashes[flight.dash]}"></line></svg>`;
      chip.append(flight.name + (flight.collided ? " (collided)" : ""));
      chip.addEventListener("click", () => { hidden.has(id) ? hidden.delete(id) : hidden.add(id); showChips(); draw(); });
      return chip;
    }));
  }

  function choose(index) {
    group = data.groups[index];
    hidden = new Set();
    $("group-title").textContent = `: ${group.title}`;
    $("left-out").textContent = group.left_out ? `${group.left_out} more flights are not drawn` : "";
    showChips();
    return draw();
  }

  function repaint() { if (data) { showChips(); return draw(); } }

  async function start() {
    const [code, figures] = await Promise.all([unpack("plotly-code"), unpack("figures-data")]);
    const script = document.createElement("script");
    script.textContent = code;
    document.head.append(script);
    $("plotly-code").remove();
    data = JSON.parse(figures);
    data.groups.forEach((one, index) => $("group").append(new Option(one.title, String(index))));
    $("group").addEventListener("change", (event) => choose(Number(event.target.value)));
    $("extent").addEventListener("change", (event) => { near = event.target.value === "near"; drawPlan(); drawSpace(); });
    $("origin").addEventListener("change", (event) => { origin = event.target.value; drawCurves(); });
    night.addEventListener("change", repaint);
    const paper = matchMedia("print");
    const print = (on) => { if (printing !== on) { printing = on; repaint(); if (!on) for (const id in PRINTED) Plotly.Plots.resize($(id)); } };
    paper.addEventListener("change", (event) => print(event.matches));
    addEventListener("beforeprint", () => print(true));
    addEventListener("afterprint", () => print(false));
    $("group").value = String(data.first);
    await choose(data.first);
    document.body.dataset.ready = "1";
  }
  start().catch((problem) => { document.body.dataset.ready = "failed"; console.error(problem); });
})();
