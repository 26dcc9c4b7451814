"""A small arena in YAML, and made-up flights."""

import random

from testbed.studies.arena.flights import ANSWERED, CONTROL, DIRECTION, LAW, Encounter, Flight, Place

ARENA = """\
name: arena
question: Who keeps?
seed: 5
replicates: 2
route: {start_enu_m: [0, 0, 0], goal_enu_m: [400, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
sensor: {range_m: 10000}
replan: {answer: direct, swell_m: 4, rejoin: {when: clear}}
rates: {plant_hz: 60}
study: arena
recordings: none
columns: all
parts:
  crossing:
    encounters: &class
      own_at_enu_m: [25, 0, 0]
      own_direction_deg: [0, 0]
      trigger: {time_to_cpa_s: 3}
      obstacle_speed_mps: [20, 50]
      radius_m: [25, 30]
      crossing_deg: [60, 120]
    sweep: &sweep
      method:
        none: {method.kind: none}
        scoam: {method.kind: scoam}
        scoam_path: {method.kind: scoam, replan.answer: insertion_point}
        geometric_guidance: {method.kind: geometric_guidance}
      rung:
        rails: {plant.kind: kinematic}
        point_mass: {plant.kind: point_mass}
      flown_by: {gtm_t2: {}}
      lead_s: {"0.6": {replan.horizon_s: 0.6}, "2.5": {replan.horizon_s: 2.5}}
    skip: &skip
      - {method: none, lead_s: "0.6"}
  two:
    encounters: {<<: *class, count: 2, apart_s: 0.5}
    sweep: *sweep
    skip: *skip
"""
PLACES = (Place("rails", "a"), Place("calm", "a"), Place("calm", "b"))
LEADS = (1.0, 2.0, 4.0)


def made_up(replicates: int = 4, methods: int = 5, seed: int = 1) -> list[Flight]:
    """Flights in three places, of which two are flown by aircraft, at three leads, in two kinds of encounters."""
    rng = random.Random(seed)
    found = []
    for k in range(methods + 1):
        shape = CONTROL if not k else DIRECTION if k % 2 else LAW
        for place in PLACES:
            for lead_s in LEADS if k else LEADS[-1:]:
                for number in range(2 * replicates):
                    kept = bool(k) and rng.random() < 0.25 * k * lead_s / 4.0 + 0.1
                    figures = [rng.uniform(-5.0, 5.0), rng.uniform(5.0, 40.0), rng.uniform(600.0, 650.0), 1.5, 30.0, 40.0, 2.0]
                    met = Encounter(("crossing", "two")[number % 2], number // 2)
                    found.append(
                        Flight(
                            f"m{k}", shape, place, 2 * (place.rung == "calm"), lead_s, met, kept, "" if kept else ANSWERED, kept, *figures
                        )
                    )
    return found
