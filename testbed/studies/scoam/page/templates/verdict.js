"use strict";
/* The pictures of the verdict: the same encounter for each aircraft, side by side. */
(() => {
  const { $ } = Plots;
  const PRINTED = { plan: [330, 330], space: [330, 330], clearance: [330, 300], demand: [330, 420] }; // px on A4, two abreast
  const DEMAND = [["bank_deg", "bank, deg"], ["load_factor", "load factor"], ["roll_rate_dps", "roll rate, deg/s"]];
  const FROM_TRIGGER = { title: "time from the decision, s", extra: { range: [-0.5, 4.5] } };
  let data, near = true;
  const hidden = new Set();
  const zero = (flight) => (flight.decisions.length ? flight.decisions[0].time_s : 0);

  /* The flights of an aircraft that a picture takes, with their names and colours. */
  const flights = (key, keys, all = false) => keys.filter((one) => data.aircraft[key].flights[one] && (all || !hidden.has(one)))
    .map((one) => ({ ...data.aircraft[key].flights[one], ...data.styles[one] }));

  function drawAircraft(key) {
    const seen = flights(key, data.in_space), limits = near ? Plots.box(flights(key, data.in_space, true)) : null;
    const rungs = flights(key, data.rungs), demand = flights(key, data.demand), has = data.aircraft[key].limits;
    const lines = DEMAND.flatMap(([name], row) => {
      const yaxis = row ? `y${row + 1}` : "y";
      return name in has ? [Plots.limit(yaxis, has[name]), ...(name === "load_factor" ? [] : [Plots.limit(yaxis, -has[name])])] : [];
    });
    return [
      Plots.plan(`v-plan-${key}`, seen, limits, PRINTED.plan, String(near)),
      Plots.space(`v-space-${key}`, seen, limits, PRINTED.space, String(near)),
      Plots.curves(`v-clearance-${key}`, rungs, [["clearance_m", "clearance, m", { range: Plots.clearanceRange(rungs, 30) }]], zero, FROM_TRIGGER, [Plots.limit("y", 0)], PRINTED.clearance, "", true),
      Plots.curves(`v-demand-${key}`, demand, DEMAND, zero, FROM_TRIGGER, lines, PRINTED.demand, "", true),
    ];
  }

  function draw() {
    const there = data.order.filter((one) => Object.values(data.aircraft).some((panel) => panel.flights[one]));
    Plots.chips("v-chips", there.map((one) => [one, data.styles[one], ""]), hidden, draw);
    return Promise.all(Object.keys(data.aircraft).flatMap(drawAircraft));
  }

  function begin(unpacked) {
    data = unpacked;
    $("v-extent").addEventListener("change", (event) => { near = event.target.value === "near"; draw(); });
  }
  const ids = () => Object.keys(data.aircraft).flatMap((key) => Object.keys(PRINTED).map((name) => `v-${name}-${key}`));
  Plots.add({ data: "verdict-data", begin, draw, ids });
})();
