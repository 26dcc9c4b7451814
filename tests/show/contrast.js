() => {
  const parse = (c) => { const m = c.match(/[\d.]+/g).map(Number); return { r: m[0], g: m[1], b: m[2], a: m[3] ?? 1 }; };
  const over = (f, g) => ({ r: f.r * f.a + g.r * (1 - f.a), g: f.g * f.a + g.g * (1 - f.a), b: f.b * f.a + g.b * (1 - f.a), a: 1 });
  const lum = (c) => [c.r, c.g, c.b].map((x) => { x /= 255; return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4; }).reduce((s, x, k) => s + x * [0.2126, 0.7152, 0.0722][k], 0);
  const ground = (e) => { const layers = []; for (let n = e; n; n = n.parentElement) { const c = parse(getComputedStyle(n).backgroundColor); if (c.a) layers.push(c); if (c.a === 1) break; } let g = { r: 255, g: 255, b: 255, a: 1 }; for (const c of layers.reverse()) g = over(c, g); return g; };
  const bad = new Map();
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let n = walker.nextNode(); n; n = walker.nextNode()) {
    const e = n.parentElement;
    if (!n.textContent.trim() || !e.offsetParent && !(e instanceof SVGElement) || e.closest("script,style,noscript,.plot,option,canvas,button:disabled") || e.getClientRects().length === 0) continue;
    const st = getComputedStyle(e), svg = e instanceof SVGElement;
    if (st.visibility === "hidden") continue;
    let f = parse(svg ? st.fill : st.color); const g = ground(e);
    let opacity = 1; for (let m = e; m; m = m.parentElement) opacity *= parseFloat(getComputedStyle(m).opacity);
    f = over({ ...f, a: f.a * opacity }, g);
    const [x, y] = [lum(f), lum(g)].sort((a, b) => b - a), ratio = (x + 0.05) / (y + 0.05);
    const size = parseFloat(st.fontSize), large = size >= 24 || size >= 18.66 && parseInt(st.fontWeight) >= 700;
    if (ratio < (large ? 3 : 4.5)) { const key = (e.className.baseVal ?? e.className) + "|" + e.tagName; if (!bad.has(key)) bad.set(key, [ratio.toFixed(2), n.textContent.trim().slice(0, 30)]); }
  }
  return [...bad];
}
