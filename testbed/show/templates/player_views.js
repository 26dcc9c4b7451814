"use strict";
/* The views of the encounter that moves: from above, from the side, from behind, and strips over time.
 *
 * All on plain 2D canvases. A frame is a few hundred lines and polygons, which a canvas draws in about a millisecond; the plot library of the page
 * would lay out its axes anew for each, and a library for 3D would add 700 kB to every page for the one view that needs perspective:
 * that is `look` and `project` below. Coordinates: along the focus's track at instant 0, to its left, up. */
const EncounterViews = (() => {
  const EVERY = 4; // samples of the clearance to one of all else, as testbed/show/close_up.py has it
  const ROUNDING = 1e-3; // of a sample: instants are kept to a millionth of a second
  const LABELLED_S = 1.2; // so long an insertion point bears its name: later there are aeroplanes around it
  const ROOM_PX = 400; // in a narrower view the clearance stands above it only
  const DEG = Math.PI / 180;
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const plus = (a, b, k = 1) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
  const less = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const length = (a) => Math.hypot(a[0], a[1], a[2]);
  const unit = (a) => { const n = length(a) || 1; return [a[0] / n, a[1] / n, a[2] / n]; };

  /* An aeroplane of length 1: forward, right, down. */
  const MODEL = [
    [[-0.36, 0, 0], [-0.5, 0, -0.17], [-0.5, 0, 0]],
    [[0.14, 0, 0], [0, 0.52, 0], [-0.09, 0.52, 0], [-0.07, 0, 0], [-0.09, -0.52, 0], [0, -0.52, 0]],
    [[-0.38, 0, 0], [-0.45, 0.19, 0], [-0.5, 0.19, 0], [-0.49, 0, 0], [-0.5, -0.19, 0], [-0.45, -0.19, 0]],
    [[0.5, 0, 0], [0.2, 0.05, 0], [-0.5, 0.015, 0], [-0.5, -0.015, 0], [0.2, -0.05, 0]],
  ];

  /* Samples of a flight in the coordinates of the views. `held`: the obstacle that comes nearest is taken to stand still. */
  function placed(ghost, track, held, anchor, mainName) {
    const f = ghost.flight.close_up;
    const points = (told) => told.x.map((x, k) => (x === null || told.y[k] === null || told.z[k] === null ? null : track.point([x, told.y[k], told.z[k]])));
    ghost.begin = f.first / f.hz; ghost.step = EVERY / f.hz; ghost.end = (f.first + f.clearance_m.length - 1) / f.hz;
    ghost.obstacles = f.obstacles.map((one) => ({ name: one.name, radius: one.radius_m, points: points(one) }));
    ghost.points = points(f);
    const main = (ghost.obstacles.find((one) => one.name === mainName) || ghost.obstacles[0]).points, shift = (list) => list.map((p, k) => (p && main[k] ? plus(less(p, main[k]), anchor) : null));
    ghost.insertions = f.decisions.filter((d) => d.insertion_enu_m).map((d) => ({ at: d.time_s, point: track.point(d.insertion_enu_m) }));
    ghost.planned = ghost.flight.paths.map((path) => ({ at: path.from_s - f.zero_s, points: points(path) }));
    if (held) {
      ghost.points = shift(ghost.points);
      const shifted = ghost.obstacles.map((one) => shift(one.points));
      ghost.obstacles.forEach((one, k) => { one.points = shifted[k]; });
      ghost.insertions = ghost.planned = []; // places over the ground
    }
  }

  /* The instant between samples; null outside of them. */
  function between(ghost, list, t) {
    const at = (t - ghost.begin) / ghost.step, k = Math.min(Math.floor(at + ROUNDING), list.length - 1);
    if (at < -ROUNDING || t > ghost.end + ROUNDING) return null;
    const a = list[k], b = list[Math.min(k + 1, list.length - 1)], share = Math.min(Math.max(at - k, 0), 1);
    if (a === null || b === null) return a;
    return Array.isArray(a) ? plus(a, less(b, a), share) : a + share * (b - a);
  }

  /* The logged clearance at the last sample that is not later: never one worked out from places in between. */
  function clearance(ghost, t) {
    const f = ghost.flight.close_up, k = Math.floor(t * f.hz - f.first + ROUNDING);
    return k >= 0 && k < f.clearance_m.length ? f.clearance_m[k] : null;
  }

  /* Axes of the body: forward, right, down. */
  function attitude(ghost, track, t) {
    const f = ghost.flight.close_up, at = Math.min(Math.max(Math.round((t - ghost.begin) / ghost.step), 0), f.x.length - 1);
    const angle = (name) => (f[name][at] ?? 0) * DEG, heading = angle("heading_deg"), pitch = angle("pitch_deg"), bank = angle("bank_deg");
    const forward = track.vector([Math.sin(heading) * Math.cos(pitch), Math.cos(heading) * Math.cos(pitch), Math.sin(pitch)]);
    const level = track.vector([Math.cos(heading), -Math.sin(heading), 0]), below = cross(forward, level);
    return [forward, plus(level.map((x) => x * Math.cos(bank)), below, Math.sin(bank)), plus(below.map((x) => x * Math.cos(bank)), level, -Math.sin(bank))];
  }
  const inBody = (axes, p, size) => [0, 1, 2].map((k) => size * (p[0] * axes[0][k] + p[1] * axes[1][k] + p[2] * axes[2][k]));

  function polygon(g, points, closed = true) {
    g.beginPath();
    points.forEach((p, k) => (k ? g.lineTo(p[0], p[1]) : g.moveTo(p[0], p[1])));
    if (closed) g.closePath();
  }
  function line(g, points, colour, width, dash = []) {
    if (points.length < 2) return;
    polygon(g, points, false);
    g.strokeStyle = colour; g.lineWidth = width; g.setLineDash(dash); g.stroke(); g.setLineDash([]);
  }
  function text(g, words, x, y, colour, align = "left", font = "12px system-ui, sans-serif") {
    g.font = font; g.textAlign = align; g.lineJoin = "round";
    g.strokeStyle = g.halo; g.lineWidth = 3; g.strokeText(words, x, y); // readable over whatever is there
    g.fillStyle = colour; g.fillText(words, x, y);
  }
  function aeroplane(g, corners, colour, halo) {
    for (const side of corners) { polygon(g, side); g.fillStyle = colour; g.strokeStyle = halo; g.lineWidth = 1.2; g.stroke(); g.fill(); }
  }
  const DASHES = { solid: [], dot: [2, 3], dash: [7, 4], dashdot: [7, 3, 2, 3], longdash: [11, 4] };

  /* The tangents from a point to a circle: what a cone about a sphere looks like from anywhere. */
  function tangents(apex, centre, radius) {
    const dx = centre[0] - apex[0], dy = centre[1] - apex[1], far = Math.hypot(dx, dy);
    if (far <= radius) return null;
    const along = (far - radius * radius / far) / far, across = radius * Math.sqrt(1 - (radius / far) ** 2) / far;
    return [1, -1].map((side) => [apex[0] + along * dx - side * across * dy, apex[1] + along * dy + side * across * dx]);
  }

  /* Is the obstacle decided about, and is it still ahead? With the relative velocity, and whether it leads inside. */
  function threat(ghost, obstacle, t) {
    const decided = ghost.flight.close_up.decisions.some((d) => d.obstacle === obstacle.name && d.time_s <= t + ROUNDING);
    const own = between(ghost, ghost.points, t), centre = between(ghost, obstacle.points, t);
    if (!own || !centre) return { decided, own, centre };
    const dt = ghost.step, later = [between(ghost, ghost.points, t + dt), between(ghost, obstacle.points, t + dt)];
    if (!later[0] || !later[1]) return { decided, own, centre };
    const sight = less(centre, own), relative = less(less(later[0], own), less(later[1], centre)), far = length(sight);
    const closing = dot(relative, sight) > 0, off = Math.acos(Math.min(1, Math.max(-1, dot(unit(relative), unit(sight)))));
    return { decided, own, centre, closing, relative: unit(relative), far, leads: closing && far > obstacle.radius && off < Math.asin(obstacle.radius / far) };
  }

  /* From above (`up` is 1) or from the side (2). */
  function flat(g, w, h, scene, t, up, style) {
    const { box, focus, ghosts } = scene, scale = Math.min((w - 20) / (box.high[0] - box.low[0]), (h - 20) / (box.high[up] - box.low[up]));
    const middle = [(box.low[0] + box.high[0]) / 2, (box.low[up] + box.high[up]) / 2];
    const px = (p) => [w / 2 + scale * (p[0] - middle[0]), h / 2 - scale * (p[up] - middle[1])];
    g.halo = style.panel;
    grid(g, w, h, px, scale, style);
    for (const ghost of ghosts) if (ghost.shown) {
      const main = ghost === focus;
      for (const path of ghost.planned) if (path.at <= t + ROUNDING) line(g, path.points.filter(Boolean).map(px), main ? style.quiet : ghost.colour, 1, main ? [6, 4] : [2, 4]);
    }
    for (const ghost of ghosts) if (ghost.shown && ghost !== focus) spheres(g, ghost, t, px, scale, style, false, focus);
    spheres(g, focus, t, px, scale, style, true, focus);
    for (const ghost of [...ghosts.filter((one) => one !== focus), focus]) if (ghost.shown || ghost === focus) flown(g, w, ghost, t, px, style, ghost === focus, scene, up);
    if (up === 1) { wind(g, w, focus, t, scene, style); north(g, w, h, scene, style); }
  }

  function grid(g, w, h, px, scale, style) {
    const cell = scale * 25 > 34 ? 25 : scale * 50 > 34 ? 50 : 100, origin = px([0, 0, 0]), gap = scale * cell;
    g.beginPath();
    for (let x = origin[0] % gap; x < w; x += gap) { g.moveTo(x, 0); g.lineTo(x, h); }
    for (let y = origin[1] % gap; y < h; y += gap) { g.moveTo(0, y); g.lineTo(w, y); }
    g.strokeStyle = style.line; g.lineWidth = 0.6; g.stroke();
    line(g, [[12, h - 10], [12 + gap, h - 10]], style.quiet, 2);
    text(g, `${cell} m`, 12, h - 15, style.quiet);
  }

  function spheres(g, ghost, t, px, scale, style, main, focus) {
    ghost.obstacles.forEach((obstacle) => {
      const seen = threat(ghost, obstacle, t);
      if (!seen.centre) return;
      const same = focus.obstacles.find((one) => one.name === obstacle.name), twin = same && between(focus, same.points, t);
      if (!main && twin && length(less(twin, seen.centre)) < 0.5) return; // where the focus has it too
      const c = px(seen.centre), radius = scale * obstacle.radius, colour = seen.decided ? style.bad : style.quiet;
      if (main) {
        const passed = obstacle.points.slice(0, Math.max(0, Math.floor((t - ghost.begin) / ghost.step) + 1)).filter(Boolean).map(px);
        line(g, [...passed, c], colour, 1, [2, 3]);
        if (seen.decided && seen.closing && seen.own) cone(g, px(seen.own), c, radius, px(plus(seen.own, seen.relative, seen.far)), seen.leads, style);
      }
      g.beginPath(); g.arc(c[0], c[1], radius, 0, 7);
      g.fillStyle = colour; g.globalAlpha = main ? (seen.decided ? 0.18 : 0.1) : 0.05; g.fill(); g.globalAlpha = 1;
      g.strokeStyle = main ? colour : ghost.colour; g.lineWidth = main ? 1.8 : 1; g.setLineDash(main ? [] : DASHES[ghost.dash] || []); g.stroke(); g.setLineDash([]);
      if (main) text(g, seen.decided ? `${obstacle.name}, a threat` : obstacle.name, c[0], c[1] + radius + 15, colour, "center");
    });
    if (main) for (const one of ghost.insertions) if (one.at <= t + ROUNDING) {
      const p = px(one.point);
      g.beginPath(); g.arc(p[0], p[1], 5, 0, 7); g.strokeStyle = style.command; g.lineWidth = 2; g.stroke();
      if (t < one.at + LABELLED_S) text(g, "insertion point", p[0], p[1] - 10, style.command, "center");
    }
  }

  function cone(g, apex, centre, radius, tip, leads, style) {
    const ends = tangents(apex, centre, radius), colour = leads ? style.bad : style.good;
    if (ends) {
      polygon(g, [apex, ...ends]);
      g.fillStyle = style.bad; g.globalAlpha = 0.09; g.fill(); g.globalAlpha = 0.7;
      line(g, [ends[0], apex, ends[1]], style.bad, 1); g.globalAlpha = 1;
    }
    line(g, [apex, tip], colour, 1.6, [5, 3]); // the relative velocity: inside of the cone it leads to a collision
    const turn = Math.atan2(tip[1] - apex[1], tip[0] - apex[0]);
    polygon(g, [tip, ...[2.7, -2.7].map((side) => [tip[0] + 9 * Math.cos(turn + side), tip[1] + 9 * Math.sin(turn + side)])]); g.fillStyle = colour; g.fill();
  }

  function flown(g, w, ghost, t, px, style, main, scene, up) {
    const here = between(ghost, ghost.points, t);
    const count = Math.min(Math.max(0, Math.floor((t - ghost.begin) / ghost.step + ROUNDING) + 1), ghost.points.length);
    const trail = ghost.points.slice(0, count), at = (k) => ghost.begin + k * ghost.step;
    line(g, [...trail, here].filter(Boolean).map(px), ghost.colour, main ? 2.6 : 1.6, DASHES[ghost.dash] || []);
    let inside = [];
    const flush = () => { line(g, inside, style.bad, main ? 4.5 : 3); inside = []; };
    trail.forEach((p, k) => (p && (clearance(ghost, at(k)) ?? 0) < 0 ? inside.push(px(p)) : flush()));
    flush();
    if (!here) return;
    const c = px(here), axes = attitude(ghost, scene.track, t), size = main ? 30 : 20;
    aeroplane(g, MODEL.map((side) => side.map((p) => { const b = inBody(axes, p, size); return [c[0] + b[0], c[1] - b[up]]; })), ghost.colour, style.panel);
    const now = clearance(ghost, t);
    if (!main || up !== 1 || now === null || now > 120) return;
    const [far, centre] = nearest(ghost, here, t), edge = px(plus(here, less(centre, here), now / (far || 1)));
    line(g, [c, edge], now < 0 ? style.bad : style.ink, 1.2);
    if (w >= ROOM_PX) text(g, `${scene.number(now)} m`, c[0] + 16, c[1] + 20, now < 0 ? style.bad : style.ink, "left", "600 13px system-ui, sans-serif");
  }

  /* Distance to the centre of the obstacle whose surface is nearest, and that centre. */
  function nearest(ghost, here, t) {
    let found = [0, here], least = Infinity;
    for (const obstacle of ghost.obstacles) {
      const centre = between(ghost, obstacle.points, t), far = centre ? length(less(centre, here)) : Infinity;
      if (far - obstacle.radius < least) { least = far - obstacle.radius; found = [far, centre]; }
    }
    return found;
  }

  function arrow(g, x, y, turn, size, colour) {
    const tip = [x + size * Math.cos(turn), y - size * Math.sin(turn)], tail = [x - size * Math.cos(turn), y + size * Math.sin(turn)];
    line(g, [tail, tip], colour, 2.2);
    polygon(g, [tip, ...[2.6, -2.6].map((side) => [tip[0] + 8 * Math.cos(turn + side), tip[1] - 8 * Math.sin(turn + side)])]); g.fillStyle = colour; g.fill();
  }

  function wind(g, w, focus, t, scene, style) {
    const told = focus.flight.close_up.wind, k = Math.min(Math.max(Math.floor((t - focus.begin) / focus.step + 1e-9), 0), told.x.length - 1);
    const air = [told.x[k] ?? 0, told.y[k] ?? 0, told.z[k] ?? 0], speed = Math.hypot(air[0], air[1]);
    if (length(air) < 0.05) { text(g, "calm air", w - 12, 20, style.quiet, "right"); return; }
    const from = (Math.atan2(-air[0], -air[1]) / DEG + 360) % 360, turned = scene.track.vector(air);
    arrow(g, w - 32, 34, Math.atan2(turned[1], turned[0]), 20, style.accent);
    const upwards = Math.abs(air[2]) >= 0.1 ? `, ${scene.number(Math.abs(air[2]), 1)} ${air[2] > 0 ? "up" : "down"}` : "";
    text(g, `wind ${speed.toFixed(1)} m/s from ${String(Math.round(from) % 360).padStart(3, "0")}\u00b0${upwards}`, w - 62, 20, style.accent, "right");
  }

  function north(g, w, h, scene, style) {
    const to = scene.track.vector([0, 1, 0]), turn = Math.atan2(to[1], to[0]);
    arrow(g, w - 24, h - 30, turn, 11, style.quiet);
    text(g, "N", w - 24 + 20 * Math.cos(turn), h - 26 - 20 * Math.sin(turn), style.quiet, "center");
  }

  /* A camera behind and above the focus, which does not roll with it. */
  function look(scene, t, w, h) {
    const here = between(scene.focus, scene.focus.points, t);
    if (!here) return null;
    const nose = attitude(scene.focus, scene.track, t)[0], level = unit([nose[0], nose[1], 0]);
    const eye = plus(plus(here, level, -20), [0, 0, 4]), forward = unit(less(plus(here, unit([nose[0], nose[1], 0.35 * nose[2]]), 60), eye));
    const right = unit(cross(forward, [0, 0, 1])), above = cross(right, forward), lens = 0.7 * w;
    const seen = (p) => { const q = less(p, eye); return [dot(q, right), dot(q, above), dot(q, forward)]; };
    const project = (q) => [w / 2 + lens * q[0] / q[2], 0.42 * h - lens * q[1] / q[2]];
    return { eye, level, lens, seen, project };
  }

  /* A line through points in space, cut where it comes too near to the eye. */
  function spaceLine(g, camera, points, colour, width, dash = []) {
    const NEAR = 0.4;
    let run = [];
    const flush = () => { line(g, run, colour, width, dash); run = []; };
    let before = null;
    for (const p of points) {
      const q = p && camera.seen(p);
      if (q && before && (q[2] < NEAR) !== (before[2] < NEAR)) run.push(camera.project(plus(before, less(q, before), (NEAR - before[2]) / (q[2] - before[2]))));
      if (q && q[2] >= NEAR) run.push(camera.project(q)); else flush();
      before = q;
    }
    flush();
  }

  function chase(g, w, h, scene, t, style) {
    const camera = look(scene, t, w, h), { focus, ghosts } = scene;
    g.halo = style.panel;
    if (!camera) { text(g, "not there at this instant", w / 2, h / 2, style.quiet, "center"); return; }
    const far = camera.project(camera.seen(plus(camera.eye, camera.level, 1e6)));
    g.fillStyle = style.line; g.globalAlpha = 0.45; g.fillRect(0, far[1], w, h - far[1]); g.globalAlpha = 1;
    line(g, [[0, far[1]], [w, far[1]]], style.quiet, 1);
    if (!scene.held) ground(g, camera, scene, style);
    for (const path of focus.planned) if (path.at <= t + ROUNDING) spaceLine(g, camera, path.points, style.quiet, 1.4, [6, 4]);
    for (const obstacle of focus.obstacles) sphere(g, w, h, camera, threat(focus, obstacle, t), obstacle, style);
    for (const one of focus.insertions) if (one.at <= t + ROUNDING) {
      const q = camera.seen(one.point), p = camera.project(q);
      if (q[2] > 1) { g.beginPath(); g.arc(p[0], p[1], Math.max(4, 0.02 * camera.lens * 60 / q[2]), 0, 7); g.strokeStyle = style.command; g.lineWidth = 2; g.stroke(); if (t < one.at + LABELLED_S) text(g, "insertion point", p[0] + 12, p[1] + 4, style.command); }
    }
    const there = [...ghosts.filter((one) => one.shown && one !== focus), focus].map((ghost) => [ghost, between(ghost, ghost.points, t)]);
    there.sort((a, b) => (b[1] ? camera.seen(b[1])[2] : 0) - (a[1] ? camera.seen(a[1])[2] : 0));
    for (const [ghost, here] of there) {
      const count = Math.max(0, Math.floor((t - ghost.begin) / ghost.step + ROUNDING) + 1);
      spaceLine(g, camera, [...ghost.points.slice(0, count), here], ghost.colour, ghost === focus ? 2.2 : 1.4, DASHES[ghost.dash] || []);
      if (!here) continue;
      const q = camera.seen(here);
      if (q[2] < 3) continue;
      const size = Math.max(5, 14 * q[2] / camera.lens), axes = attitude(ghost, scene.track, t); // far away no smaller than can be seen
      const corners = MODEL.map((side) => side.map((p) => camera.project(camera.seen(plus(here, inBody(axes, p, size))))));
      g.globalAlpha = ghost === focus ? 1 : 0.8; aeroplane(g, corners, ghost.colour, style.panel); g.globalAlpha = 1;
    }
  }

  function ground(g, camera, scene, style) {
    const z = scene.focus.flight.close_up.ground_z_m, cell = 100, reach = 1200, x0 = Math.round(camera.eye[0] / cell) * cell, y0 = Math.round(camera.eye[1] / cell) * cell;
    g.globalAlpha = 0.35;
    for (let d = -reach; d <= reach; d += cell) {
      spaceLine(g, camera, [[x0 + d, y0 - reach, z], [x0 + d, y0 + reach, z]], style.quiet, 0.6);
      spaceLine(g, camera, [[x0 - reach, y0 + d, z], [x0 + reach, y0 + d, z]], style.quiet, 0.6);
    }
    g.globalAlpha = 1;
  }

  function sphere(g, w, h, camera, seen, obstacle, style) {
    if (!seen.centre) return;
    const colour = seen.decided ? style.bad : style.quiet, sight = less(seen.centre, camera.eye), far = length(sight), radius = obstacle.radius;
    if (far > radius) { // its outline: where lines from the eye touch it
      const axis = unit(sight), side = unit(cross(axis, [0, 0, 1])), other = cross(side, axis), apart = radius * Math.sqrt(1 - (radius / far) ** 2);
      const rim = [], middle = plus(camera.eye, axis, far - radius * radius / far);
      for (let k = 0; k < 48; k++) rim.push(camera.seen(plus(plus(middle, side, apart * Math.cos(k * Math.PI / 24)), other, apart * Math.sin(k * Math.PI / 24))));
      if (rim.every((q) => q[2] > 0.5)) { polygon(g, rim.map(camera.project)); g.fillStyle = colour; g.globalAlpha = 0.16; g.fill(); g.globalAlpha = 1; g.strokeStyle = colour; g.lineWidth = 1.6; g.stroke(); }
    } else { g.fillStyle = style.bad; g.globalAlpha = 0.2; g.fillRect(0, 0, w, h); g.globalAlpha = 1; } // the eye is in it
    g.globalAlpha = 0.45;
    const ring = (at) => Array.from({ length: 37 }, (_, k) => plus(seen.centre, at(k * 10 * DEG), radius));
    for (let a = 0; a < 180; a += 30) spaceLine(g, camera, ring((b) => [Math.cos(a * DEG) * Math.cos(b), Math.sin(a * DEG) * Math.cos(b), Math.sin(b)]), colour, 0.8);
    for (let e = -60; e <= 60; e += 30) spaceLine(g, camera, ring((b) => [Math.cos(e * DEG) * Math.cos(b), Math.cos(e * DEG) * Math.sin(b), Math.sin(e * DEG)]), colour, 0.8);
    g.globalAlpha = 1;
    const q = camera.seen(seen.centre);
    if (q[2] > 5 && far > radius) { const p = camera.project(q); text(g, seen.decided ? `${obstacle.name}, a threat` : obstacle.name, p[0], p[1], colour, "center"); }
  }

  const STRIPS = [["clearance_m", "clearance", "m", 1], ["bank_deg", "bank", "\u00b0", 0], ["load_factor", "load factor", "", 2], ["roll_rate_dps", "roll rate", "\u00b0/s", 0]];

  /* What is drawn of a curve: up to somewhat more than the limit, since a point on rails has none. */
  function range(scene, name) {
    const all = scene.ghosts.filter((one) => one.shown || one === scene.focus).flatMap((one) => one.flight.close_up[name].filter((v) => v !== null));
    if (!all.length) return [-1, 1];
    let low = Math.min(...all), high = Math.max(...all);
    const limit = scene.focus.limits[name];
    if (name === "clearance_m") return [Math.min(low, 0) - 3, Math.min(Math.max(high, 10), Math.max(30, -4 * low))];
    if (limit) { low = Math.max(low, -1.6 * limit); high = Math.min(high, 1.6 * limit); }
    if (limit && high > 0.5 * limit) high = Math.max(high, 1.12 * limit);
    if (limit && low < -0.5 * limit) low = Math.min(low, -1.12 * limit);
    const gap = 0.08 * (high - low || 1);
    return [low - gap, high + gap];
  }

  function strips(g, w, h, scene, t, style) {
    const left = 8, tall = h / STRIPS.length, x = (at) => left + (w - 2 * left) * (at - scene.begin) / (scene.end - scene.begin || 1);
    g.halo = style.panel;
    STRIPS.forEach(([name, title, unitName, digits], row) => {
      const [low, high] = scene.ranges[name], top = row * tall + 18, bottom = (row + 1) * tall - 5;
      const y = (v) => bottom - (bottom - top) * (v - low) / (high - low), limit = scene.focus.limits[name];
      g.save(); g.beginPath(); g.rect(0, top - 1, w, bottom - top + 2); g.clip();
      line(g, [[left, y(0)], [w - left, y(0)]], name === "clearance_m" ? style.bad : style.line, name === "clearance_m" ? 1.4 : 1);
      if (name === "clearance_m") { g.fillStyle = style.bad; g.globalAlpha = 0.1; g.fillRect(left, y(0), w - 2 * left, h); g.globalAlpha = 1; }
      for (const level of limit ? (name === "load_factor" ? [limit] : [limit, -limit]) : []) line(g, [[left, y(level)], [w - left, y(level)]], style.bad, 1.2, [5, 3]);
      for (const ghost of [...scene.ghosts.filter((one) => one.shown && one !== scene.focus), scene.focus]) {
        const values = ghost.flight.close_up[name], dt = name === "clearance_m" ? ghost.step / EVERY : ghost.step;
        let run = [];
        const flush = () => { line(g, run, ghost.colour, ghost === scene.focus ? 2.2 : 1.2, DASHES[ghost.dash] || []); run = []; };
        values.forEach((v, k) => (v === null ? flush() : run.push([x(ghost.begin + k * dt), y(v)])));
        flush();
      }
      g.restore();
      line(g, [[x(0), top], [x(0), bottom]], style.line, 1);
      line(g, [[x(t), top - 2], [x(t), bottom]], style.ink, 1.4);
      const now = name === "clearance_m" ? clearance(scene.focus, t) : between(scene.focus, scene.focus.flight.close_up[name], t);
      const over = now !== null && (name === "clearance_m" ? now < 0 : limit && (name === "load_factor" ? now : Math.abs(now)) >= limit);
      if (now !== null && now >= low && now <= high) { g.beginPath(); g.arc(x(t), y(now), 3.4, 0, 7); g.fillStyle = scene.focus.colour; g.fill(); }
      text(g, title, left, top - 5, style.quiet);
      const has = limit ? ` of ${scene.number(limit, digits)}${unitName}` : "";
      text(g, now === null ? "\u2013" : `${scene.number(now, digits)}${unitName && unitName !== "m" ? unitName : unitName && " m"}${has}`, w - left, top - 5, over ? style.bad : style.ink, "right", "600 12px system-ui, sans-serif");
    });
  }

  return { between, chase, clearance, flat, placed, range, strips, STRIPS };
})();
