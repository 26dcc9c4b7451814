"use strict";
/* What all pictures of a page share: the plot library and its data, colours by day, by night and on paper, traces of flights. */
const Plots = (() => {
  const $ = (id) => document.getElementById(id);
  const CONFIG = { displaylogo: false, responsive: true, displayModeBar: false };
  const night = matchMedia("(prefers-color-scheme: dark)");
  const painters = [];
  let printing = false;

  const dark = () => night.matches && !printing;
  const plain = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;"); // the plot library reads markup in names
  const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const ink = () => (printing ? "#000000" : style("--ink"));
  const line = () => (printing ? "#d5dae0" : style("--line"));
  const colour = (flight) => { const c = dark() ? flight.dark : flight.light; return c === "ink" ? ink() : c; };

  async function unpack(id) {
    const bytes = Uint8Array.from(atob($(id).textContent), (c) => c.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  }

  /* `printed`: width and height in px on A4; on the screen the page decides. `view` changes when a zoom should be forgotten. */
  function layout(printed, view, extra) {
    const size = printing ? { autosize: false, width: printed[0], height: printed[1] } : { autosize: true };
    return { ...size, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { family: "system-ui, sans-serif", size: printing ? 9 : 12, color: ink() },
      margin: { l: 58, r: 12, t: 8, b: 40 }, showlegend: false, hovermode: "closest", uirevision: view, ...extra };
  }
  const axis = (title, extra = {}) => ({ title: { text: title }, gridcolor: line(), zerolinecolor: line(), linecolor: line(), ...extra });

  /* A box around all closest approaches, or null for the whole route. */
  function box(flights) {
    const all = flights.flatMap((flight) => flight.obstacles);
    if (!all.length) return null;
    return [0, 1, 2].map((k) => [Math.min(...all.map((o) => o.nearest_enu_m[k] - 2.2 * o.radius_m)), Math.max(...all.map((o) => o.nearest_enu_m[k] + 2.2 * o.radius_m))]);
  }

  function circle(x, y, r) {
    const xs = [], ys = [];
    for (let k = 0; k <= 60; k++) { xs.push(x + r * Math.cos(k * Math.PI / 30)); ys.push(y + r * Math.sin(k * Math.PI / 30)); }
    return [xs, ys];
  }

  /* From above and from the side. */
  function plan(id, flights, limits, printed, view) {
    const traces = [];
    for (const [second, yaxis] of [["y", "y"], ["z", "y2"]]) {
      const index = second === "y" ? 1 : 2;
      const add = (trace) => traces.push({ xaxis: "x", yaxis, hoverinfo: "skip", type: "scatter", mode: "lines", ...trace });
      for (const flight of flights) {
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
    const range = (k) => (limits ? { range: limits[k] } : {});
    return Plotly.react(id, traces, layout(printed, view, {
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

  function space(id, flights, limits, printed, view) {
    const traces = [];
    const add = (trace) => traces.push({ type: "scatter3d", mode: "lines", hoverinfo: "skip", ...trace });
    for (const flight of flights) {
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
    const spans = limits && limits.map(([low, high]) => high - low), mean = limits && Math.cbrt(spans[0] * spans[1] * spans[2]);
    const aspect = limits ? { aspectmode: "manual", aspectratio: { x: spans[0] / mean, y: spans[1] / mean, z: spans[2] / mean } } : { aspectmode: "data" };
    const side = (title, k) => axis(title, { backgroundcolor: "rgba(0,0,0,0)", showspikes: false, ...(limits ? { range: limits[k] } : {}) });
    return Plotly.react(id, traces, layout(printed, view, { margin: { l: 0, r: 0, t: 0, b: 0 }, scene: { ...aspect, xaxis: side("east, m", 0), yaxis: side("north, m", 1), zaxis: side("up, m", 2),
      camera: { eye: limits ? { x: 0.3, y: -1.75, z: 0.8 } : { x: 0.4, y: -2.3, z: 1.05 }, up: { x: 0, y: 0, z: 1 }, center: { x: 0, y: 0, z: -0.12 } } } }), CONFIG);
  }

  /* One panel a curve, one below the other. `panels`: [name, title, what to add to its axis]; `zero` of a flight is time 0. */
  function curves(id, flights, panels, zero, xaxis, shapes, printed, view, named = false) {
    const traces = [], axes = {};
    panels.forEach(([name, title, extra = {}], row) => {
      const yaxis = row ? `y${row + 1}` : "y", top = 1 - row / panels.length;
      axes[row ? `yaxis${row + 1}` : "yaxis"] = axis(title, { domain: [top - 1 / panels.length + (panels.length > 1 ? 0.03 : 0), top], ...extra });
      for (const flight of flights) {
        const c = colour(flight), start = zero(flight), y = flight[name];
        if (!y || !y.length) continue;
        traces.push({ type: "scatter", mode: "lines", x: flight.time_s.map((t) => t - start), y, yaxis, name: plain(flight.name), showlegend: row === 0, line: { color: c, width: 1.8, dash: flight.dash },
          hovertemplate: `%{y} at %{x:.2f} s<extra>${plain(flight.name)}</extra>` });
        for (const d of flight.decisions) {
          let nearest = 0;
          flight.time_s.forEach((t, k) => { if (Math.abs(t - d.time_s) < Math.abs(flight.time_s[nearest] - d.time_s)) nearest = k; });
          traces.push({ type: "scatter", mode: "markers", showlegend: false, x: [d.time_s - start], y: [y[nearest]], yaxis, marker: { symbol: "x", size: 8, color: c },
            hovertemplate: `${plain(d.decision)} for ${plain(d.obstacle)} at ${d.time_s} s<extra>${plain(flight.name)}</extra>` });
        }
      }
    });
    return Plotly.react(id, traces, layout(printed, view, { shapes, ...axes, showlegend: named, legend: { orientation: "h", y: 1.02, yanchor: "bottom", font: { size: printing ? 8 : 11 } }, xaxis: axis(xaxis.title, { anchor: panels.length > 1 ? `y${panels.length}` : "y", ...xaxis.extra }) }), CONFIG);
  }
  const limit = (yaxis, y) => ({ type: "line", xref: "paper", x0: 0, x1: 1, yref: yaxis, y0: y, y1: y, line: { color: "#D55E00", width: 1.5 } });

  /* Far away the clearance says nothing: show from the deepest point to where decisions are made. */
  function clearanceRange(flights, most) {
    const all = flights.flatMap((flight) => flight.clearance_m).filter((value) => value !== null);
    if (!all.length) return undefined;
    const low = Math.min(0, ...all), high = Math.min(Math.max(...all), most);
    return [low - 6, Math.max(high, 10)];
  }

  /* Buttons that hide and show what has a name and a style; `hidden` holds the keys that are off. */
  function chips(id, entries, hidden, changed) {
    $(id).replaceChildren(...entries.map(([key, entry, note]) => {
      const chip = document.createElement("button");
      chip.type = "button"; chip.className = "chip"; chip.setAttribute("aria-pressed", String(!hidden.has(key)));
      const dashes = { solid: "", dot: "2 3", dash: "7 4", dashdot: "7 3 2 3", longdash: "11 4" };
      chip.innerHTML = `<svg aria-hidden="true"><line x1="0" x2="26" y1="4" y2="4" stroke="${colour(entry)}" stroke-width="3" stroke-dasharray="${dashes[entry.dash]}"></line></svg>`;
      chip.append(entry.name + note);
      chip.addEventListener("click", () => { hidden.has(key) ? hidden.delete(key) : hidden.add(key); changed(); });
      return chip;
    }));
  }

  /* A painter: `data` the id of its packed data, `begin` is given them, `draw` draws and may be asked again, `ids` of its plots. */
  const add = (painter) => { if ($(painter.data)) painters.push(painter); };
  const folded = (painter) => $(painter.data).closest("details:not([open])");
  /* Who reads and clicks goes first: what is heavy waits for a moment in which nothing else is to be done. */
  const idle = () => new Promise((go) => (window.requestIdleCallback ? requestIdleCallback(go, { timeout: 500 }) : setTimeout(go)));

  /* Unpacked soon, drawn when it comes near or is printed: space takes seconds to draw without a graphics card. */
  const NEAR_PX = 800;
  const waiting = new Map();
  const near = new IntersectionObserver((seen) => { for (const one of seen) if (one.isIntersecting && waiting.has(one.target)) paint(waiting.get(one.target)); }, { rootMargin: `${NEAR_PX}px` });
  const isNear = (id) => { const box = $(id).getBoundingClientRect(); return box.top < innerHeight + NEAR_PX && box.bottom > -NEAR_PX; };

  async function prepare(painter) {
    if (folded(painter)) return; // a plot needs to know its size
    if (!painter.begun) { painter.begun = true; painter.begin(JSON.parse(await unpack(painter.data))); }
    if (painter.ids().some(isNear)) { await paint(painter); return; }
    for (const id of painter.ids()) { waiting.set($(id), painter); near.observe($(id)); }
  }
  async function paint(painter) {
    for (const id of painter.ids()) { waiting.delete($(id)); near.unobserve($(id)); }
    painter.drawn = true;
    await painter.draw();
  }

  async function start() {
    for (const link of document.querySelectorAll("nav a")) {
      link.addEventListener("click", () => { const fold = document.querySelector(link.hash)?.closest("details"); if (fold) fold.open = true; });
    }
    if (painters.length) {
      await idle();
      const script = document.createElement("script");
      script.textContent = await unpack("plotly-code");
      document.head.append(script);
      $("plotly-code").remove();
      const open = (painter) => painter.begun && !folded(painter);
      const print = (on) => {
        if (printing === on) return;
        printing = on;
        const drawn = painters.filter((one) => open(one) && (on || one.drawn));
        drawn.forEach(paint);
        if (!on) for (const painter of drawn) for (const id of painter.ids()) Plotly.Plots.resize($(id));
      };
      night.addEventListener("change", () => painters.filter((one) => open(one) && one.drawn).forEach(paint));
      matchMedia("print").addEventListener("change", (event) => print(event.matches));
      addEventListener("beforeprint", () => print(true));
      addEventListener("afterprint", () => print(false));
      for (const fold of document.querySelectorAll("details")) fold.addEventListener("toggle", () => { for (const one of painters) if (fold.contains($(one.data)) && !one.drawn) prepare(one); });
      for (const painter of painters) { await idle(); await prepare(painter); }
    }
    document.body.dataset.ready = "1";
  }
  const run = () => start().catch((problem) => { document.body.dataset.ready = "failed"; console.error(problem); });

  return { $, add, axis, box, chips, clearanceRange, colour, curves, limit, plan, run, space, style, unpack };
})();
