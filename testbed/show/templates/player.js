"use strict";
/* The encounter that moves: which scene, which instant, what is shown of it. The drawing is player_views.js. */
const EncounterPlayer = (() => {
  const { $, unpack, colour, style: css } = Plots;
  const Views = EncounterViews;
  const STEP_S = 1 / 30, JUMP_S = 0.25; // of the arrow keys, without and with shift
  const still = matchMedia("(prefers-reduced-motion: reduce)"), night = matchMedia("(prefers-color-scheme: dark)");
  let data, scene, t = 0, playing = false, last = 0, asked = 0, own = true; // own: it started by itself

  const number = (v, digits = 2) => { const text = v.toFixed(digits); return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212"); };
  const told = (v) => (v === null ? "\u2013" : number(v));

  function theme() {
    const names = { panel: "--panel", line: "--line", ink: "--ink", quiet: "--quiet", bad: "--bad", good: "--good", accent: "--accent" };
    return { ...Object.fromEntries(Object.entries(names).map(([key, name]) => [key, css(name)])), command: night.matches ? "#CC79A7" : "#9c3f73" };
  }

  /* Along the focus's track at instant 0, to its left, up. */
  function trackOf(f) {
    const k = Math.min(Math.max(Math.round(-f.first / 4), 0), f.x.length - 1), a = Math.max(0, k - 1), b = Math.min(f.x.length - 1, k + 1);
    const dx = f.x[b] - f.x[a], dy = f.y[b] - f.y[a], n = Math.hypot(dx, dy) || 1, c = dx / n, s = dy / n, o = [f.x[k], f.y[k]];
    return { point: (p) => [c * (p[0] - o[0]) + s * (p[1] - o[1]), -s * (p[0] - o[0]) + c * (p[1] - o[1]), p[2]], vector: (p) => [c * p[0] + s * p[1], -s * p[0] + c * p[1], p[2]] };
  }

  function build(index, focus, held, hidden) {
    const source = data.scenes[index];
    const ghosts = source.ghosts.map((one) => ({ ...one, flight: data.flights[one.id], shown: hidden ? !hidden.has(one.id) : one.shown }));
    const made = { index, title: source.title, ghosts, focus: ghosts[focus ?? source.focus], held, number };
    made.track = trackOf(made.focus.flight.close_up);
    const f = made.focus.flight.close_up, k = Math.min(Math.max(Math.round((f.nearest_s * f.hz - f.first) / 4), 0), f.x.length - 1), main = f.obstacles[0];
    const anchor = main.x[k] === null ? [0, 0, 0] : made.track.point([main.x[k], main.y[k], main.z[k]]);
    for (const ghost of ghosts) { ghost.colour = colour(ghost); Views.placed(ghost, made.track, held, anchor, main.name); }
    made.begin = Math.min(...ghosts.map((one) => one.begin)); made.end = Math.max(...ghosts.map((one) => one.end));
    made.box = boxOf(made, f.nearest_s);
    made.ranges = Object.fromEntries(Views.STRIPS.map(([name]) => [name, Views.range(made, name)]));
    return made;
  }

  /* Around the flights from shortly before the decision until shortly after the closest approach, and the obstacles of the focus. */
  function boxOf(made, nearest) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], from = -0.8, to = Math.max(nearest, 0) + 0.8;
    const include = (p, r) => p && [0, 1, 2].forEach((k) => { low[k] = Math.min(low[k], p[k] - r); high[k] = Math.max(high[k], p[k] + r); });
    const within = (ghost, points, a, r) => points.forEach((p, k) => { const at = ghost.begin + k * ghost.step; if (at >= a && at <= to) include(p, r); });
    for (const ghost of made.ghosts) within(ghost, ghost.points, from, 6);
    for (const one of made.focus.obstacles.slice(0, 2)) within(made.focus, one.points, made.held ? -Infinity : 0, one.radius + 3);
    return { low, high };
  }

  function canvas(id, draw) {
    const node = $(id), w = node.clientWidth, h = node.clientHeight, dense = Math.min(devicePixelRatio || 1, 2);
    if (!w || !h) return;
    if (node.width !== Math.round(w * dense) || node.height !== Math.round(h * dense)) { node.width = Math.round(w * dense); node.height = Math.round(h * dense); }
    const g = node.getContext("2d");
    g.setTransform(dense, 0, 0, dense, 0, 0); g.clearRect(0, 0, w, h);
    draw(g, w, h);
  }

  function draw() {
    asked = 0;
    const style = scene.style;
    canvas("ep-plan", (g, w, h) => Views.flat(g, w, h, scene, t, 1, style));
    canvas("ep-side", (g, w, h) => Views.flat(g, w, h, scene, t, 2, style));
    canvas("ep-chase", (g, w, h) => Views.chase(g, w, h, scene, t, style));
    canvas("ep-strips", (g, w, h) => Views.strips(g, w, h, scene, t, style));
    for (const ghost of scene.ghosts) write(ghost.cell, Views.clearance(ghost, t));
    write($("ep-now"), Views.clearance(scene.focus, t), " m");
    const range = $("ep-at"), when = `${number(t)} s`;
    range.value = String(Math.round(1000 * t));
    $("ep-time").textContent = when;
    $("ep").dataset.t = String(t);
    range.setAttribute("aria-valuetext", `${when}, clearance ${told(Views.clearance(scene.focus, t))} m`);
  }
  function write(node, clearance, unitName = "") {
    node.textContent = told(clearance) + (clearance === null ? "" : unitName);
    node.classList.toggle("bad", clearance !== null && clearance < 0);
  }
  const ask = () => { asked ||= requestAnimationFrame(draw); };

  /* On the grid of the logged clearances, where every flight has one. */
  function snapped(at) {
    const f = scene.focus.flight.close_up;
    return Math.min(Math.max(Math.round(at * f.hz) / f.hz, scene.begin), scene.end);
  }
  function go(at) { t = snapped(at); ask(); }

  function say() {
    $("ep-said").textContent = `${number(t)} s from the ${scene.focus.flight.close_up.zero_is}: ` +
      scene.ghosts.filter((one) => one.shown).map((one) => { const c = Views.clearance(one, t); return `${one.name} ${c === null ? "not there" : c < 0 ? `${number(-c)} m inside` : `${number(c)} m clear`}`; }).join("; ");
  }

  function frame(now) {
    if (!playing) return;
    t += Math.min((now - last) / 1000, 0.25) * Number($("ep-speed").value);
    last = now;
    if (t >= scene.end) { t = scene.end; pause(); }
    draw();
    if (playing) requestAnimationFrame(frame);
  }
  function play() {
    if (t >= scene.end - 1e-6) t = scene.begin;
    playing = true; last = performance.now();
    label();
    requestAnimationFrame(frame);
  }
  function pause(quietly = false) {
    playing = false;
    label();
    go(t);
    if (!quietly) say();
  }
  function label() {
    $("ep-play").setAttribute("aria-label", playing ? "pause" : "play");
    $("ep-play").classList.toggle("playing", playing);
    $("ep").dataset.playing = String(playing);
  }
  const touched = () => { own = false; };
  const scrub = (at) => { touched(); if (playing) pause(true); go(at); };

  /* The whole player listens: space plays, arrows step, home and end go to either end; fields and buttons keep their own keys. */
  function key(event) {
    const on = event.target, field = on.matches("select, input[type=checkbox]"), button = on.matches("button");
    if (event.altKey || event.ctrlKey || event.metaKey || field) return;
    const step = event.shiftKey ? JUMP_S : STEP_S;
    const moves = { ArrowLeft: () => scrub(t - step), ArrowDown: () => scrub(t - step), ArrowRight: () => scrub(t + step), ArrowUp: () => scrub(t + step),
      Home: () => scrub(scene.begin), End: () => scrub(scene.end), PageUp: () => scrub(t + JUMP_S), PageDown: () => scrub(t - JUMP_S), " ": () => { touched(); playing ? pause() : play(); } };
    if (!(event.key in moves) || (button && event.key === " ") || (["ArrowUp", "ArrowDown"].includes(event.key) && on.id !== "ep-at")) return;
    event.preventDefault();
    moves[event.key]();
    if (event.key !== " ") say();
  }

  function jumps() {
    const f = scene.focus.flight.close_up, found = [];
    if (f.detected_s !== null && f.detected_s >= scene.begin && f.detected_s < -0.02) found.push(["detection", f.detected_s]);
    if (f.zero_is !== "closest approach") found.push([f.zero_is, 0]);
    found.push(["closest approach", f.nearest_s], ["end", scene.end]);
    $("ep-jumps").replaceChildren(...found.map(([name, at]) => {
      const button = document.createElement("button");
      button.type = "button"; button.textContent = name;
      button.addEventListener("click", () => { scrub(at); say(); });
      return button;
    }));
  }

  function rows() {
    $("ep-rows").replaceChildren(...scene.ghosts.map((ghost, k) => {
      const row = document.createElement("tr"), head = document.createElement("th"), shown = document.createElement("input"), swatch = document.createElement("span"), follow = document.createElement("button");
      head.scope = "row";
      shown.type = "checkbox"; shown.checked = ghost.shown; shown.setAttribute("aria-label", `show ${ghost.name}`);
      shown.addEventListener("change", () => { ghost.shown = shown.checked; scene.ranges = Object.fromEntries(Views.STRIPS.map(([name]) => [name, Views.range(scene, name)])); ask(); });
      swatch.innerHTML = `<svg class="ep-swatch" aria-hidden="true"><line x1="0" x2="28" y1="4" y2="4" style="stroke:${ghost.colour}" stroke-dasharray="${ghost.strokes}"></line></svg>`;
      follow.type = "button"; follow.textContent = ghost.name; follow.title = "follow this flight"; follow.setAttribute("aria-pressed", String(ghost === scene.focus));
      follow.addEventListener("click", () => choose(scene.index, k, scene.held, hiddenNow()));
      head.append(shown, swatch, follow);
      ghost.cell = document.createElement("td");
      ghost.cell.className = "n ep-cell"; ghost.cell.dataset.flight = ghost.id;
      const least = document.createElement("td"), ended = document.createElement("td");
      least.className = ghost.bad ? "n bad" : "n"; least.textContent = ghost.least; ended.textContent = ghost.outcome;
      row.append(head, ghost.cell, least, ended);
      return row;
    }));
  }
  const hiddenNow = () => new Set(scene.ghosts.filter((one) => !one.shown).map((one) => one.id));

  function choose(index, focus, held, hidden) {
    scene = build(index, focus, held, hidden);
    scene.style = theme();
    const { low, high } = scene.box, wide = high[0] - low[0] || 1;
    $("ep-plan").style.aspectRatio = `1 / ${Math.min(Math.max((high[1] - low[1]) / wide, 0.42), 0.68)}`;
    $("ep-side").style.aspectRatio = `1 / ${Math.min(Math.max((high[2] - low[2]) / wide, 0.3), 0.6)}`;
    Object.assign($("ep-at"), { min: String(Math.round(1000 * scene.begin)), max: String(Math.round(1000 * scene.end)), step: "1" });
    $("ep-who").textContent = $("ep-chased").textContent = scene.focus.name;
    rows();
    jumps();
    go(t);
  }

  async function start() {
    if (!$("player-data")) return;
    const root = $("encounter");
    data = JSON.parse(await unpack("player-data"));
    root.classList.add("live");
    choose(0, undefined, false);
    $("ep-play").addEventListener("click", () => { touched(); playing ? pause() : play(); });
    $("ep-at").addEventListener("input", (event) => scrub(Number(event.target.value) / 1000));
    $("ep-at").addEventListener("change", say);
    $("ep-scene").addEventListener("change", (event) => { touched(); pause(true); t = 0; choose(Number(event.target.value), undefined, scene.held); });
    $("ep-hold").addEventListener("change", (event) => choose(scene.index, scene.ghosts.indexOf(scene.focus), event.target.checked, hiddenNow()));
    $("ep").addEventListener("keydown", key);
    new ResizeObserver(ask).observe($("ep"));
    night.addEventListener("change", () => choose(scene.index, scene.ghosts.indexOf(scene.focus), scene.held, hiddenNow()));
    label();
    if (still.matches) { go(scene.focus.flight.close_up.nearest_s); return; }
    go(Math.max(scene.begin, -0.5));
    // When it is first seen it plays once by itself; whoever has touched it decides. Out of sight it rests.
    const watch = new IntersectionObserver((seen) => {
      const visible = seen[seen.length - 1].isIntersecting;
      if (playing && !visible) pause(true);
      else if (visible && own && !document.hidden) { own = false; play(); }
    }, { threshold: 0.5 });
    watch.observe($("ep-plan"));
  }
  start().catch((problem) => console.error(problem));
})();
