"""Every column of the views of a study, computed again from its ticks and its tables, by other code.

usage: recompute.py FILE SAMPLE.csv     (SAMPLE: all of sample by trial_id, interval, tick; prints what differs)
"""
import csv, datetime, json, math, sqlite3, sys
from collections import Counter, defaultdict

FELT = "ticks contact_ticks slip_ticks late_ticks saturated_ticks".split()


def strokes(ticks):
    """Turns of 5 mm or more along the surface; a lift of more than 0.1 s begins a new one."""
    n, direction, place, low, high, last = 0, 0, 0.0, 0.0, 0.0, 0.0
    for before, t in zip([None] + ticks, ticks):
        if t["mode"] == "free":
            continue
        if t["time_s"] - last > 0.1 + 1e-12:
            direction, place, low, high = 0, 0.0, 0.0, 0.0
        last = t["time_s"]
        # F = fn n + ft t with n = t turned to the left
        tx = t["rendered_tangential_n"] * t["rendered_x_n"] + t["rendered_normal_n"] * t["rendered_y_n"]
        ty = t["rendered_tangential_n"] * t["rendered_y_n"] - t["rendered_normal_n"] * t["rendered_x_n"]
        length = math.hypot(tx, ty)
        if not length:
            continue
        if before:
            place += ((t["hip_x_m"] - before["hip_x_m"]) * tx + (t["hip_y_m"] - before["hip_y_m"]) * ty) / length
        low, high = min(low, place), max(high, place)
        if direction <= 0 and place - low >= 0.005:
            n, direction, high = n + 1, 1, place
        elif direction >= 0 and high - place >= 0.005:
            n, direction, low = n + 1, -1, place
    return n


def felt(ticks):
    """What an interval's ticks up to done add up to."""
    touch = [t for t in ticks if t["mode"] != "free"]
    steps = [(math.hypot(b["hip_x_m"] - a["hip_x_m"], b["hip_y_m"] - a["hip_y_m"]), b["time_s"] - a["time_s"], b["mode"] != "free")
             for a, b in zip(ticks, ticks[1:])]
    return {
        "ticks": len(ticks), "contact_ticks": len(touch),
        "slip_ticks": sum(t["mode"] in ("slip", "transition") for t in touch),
        "late_ticks": sum(t["flags"] >> 1 & 1 for t in ticks),
        "saturated_ticks": sum(t["flags"] & 1 for t in ticks),
        "path_length_m": math.fsum(s for s, _, _ in steps),
        "sum_fn": math.fsum(t["rendered_normal_n"] for t in touch), "max_fn": max([t["rendered_normal_n"] for t in touch], default=0.0),
        "first_contact_s": touch[0]["time_s"] if touch else None, "strokes": strokes(ticks),
        "contact_path": math.fsum(s for s, _, c in steps if c), "contact_time": math.fsum(d for _, d, c in steps if c),
        "before": sum(t["segment"] == 0 for t in touch), "after": sum(t["segment"] == 1 for t in touch)}


def ratio(a, b, otherwise=None):
    return a / b if b else otherwise


differences = 0
checked = 0


def expect(what, row, wanted):
    global differences, checked
    for name, value in wanted.items():
        checked += 1
        stored = row[name]
        real = isinstance(value, float) and stored is not None
        if not (math.isclose(stored, value, rel_tol=1e-9, abs_tol=1e-12) if real else stored == value):
            differences += 1
            print(f"{what}: {name} is {stored}, recomputed {value}")


def main(file, samples):
    db = sqlite3.connect(file)
    db.row_factory = sqlite3.Row
    table = lambda name, key: {r[key]: dict(r) for r in db.execute(f"SELECT * FROM {name}")}
    trials, sessions, responses = table("trial", "trial_id"), table("session", "session_id"), table("response", "trial_id")
    studies, people = table("study", "study_id"), table("participant", "participant_id")
    plans = {(r["session_id"], r["plan_position"]): r for r in db.execute("SELECT * FROM plan")}
    presentations = {(r["trial_id"], r["interval"]): r for r in db.execute("SELECT * FROM presentation")}
    parts = defaultdict(list)
    for r in csv.DictReader(open(samples, newline="")):
        t = {k: v if k == "mode" else None if v == "" else float(v) for k, v in r.items()}
        t["flags"] = int(t["flags"])
        parts[int(r["trial_id"]), int(r["interval"])].append(t)

    for (trial, interval), ticks in parts.items():
        for a, b in zip(ticks, ticks[1:]):
            expect(f"sample {trial} {b['tick']}", b, {f"hip_v{c}_m_per_s": (b[f"hip_{c}_m"] - a[f"hip_{c}_m"]) / (b["time_s"] - a["time_s"])
                                                    for c in "xy"})
        for t in ticks:
            force = math.hypot(t["rendered_x_n"], t["rendered_y_n"])
            free = t["mode"] == "free"
            expect(f"sample {trial} {t['tick']}", {
                "force": math.hypot(t["rendered_normal_n"], t["rendered_tangential_n"]), "pulls in the air": free and force > 0,
                "leaves the cone": not free and abs(t["rendered_tangential_n"]) > t["mu"] * t["rendered_normal_n"] + 1e-9},
                {"force": force, "pulls in the air": False, "leaves the cone": False})

    for view in db.execute("SELECT * FROM trial_summary").fetchall():
        t = trials[view["trial_id"]]
        session, answer = sessions[t["session_id"]], responses.get(t["trial_id"], defaultdict(lambda: None))
        plan = plans[t["session_id"], t["plan_position"]]
        what = f"trial_summary {t['trial_id']}"
        expect(what, view, {
            "study_name": studies[session["study_id"]]["study_name"], "participant_code": people[session["participant_id"]]["participant_code"],
            "session_number": session["session_number"], "session_kind": session["session_kind"], "chosen_object": answer["chosen_object"],
            "correct": answer["correct"], "reaction_s": answer["reaction_s"]})
        expect(what, view, {n: plan[n] for n in ("phase", "planned_object", "friction", "curvature_per_m")})
        expect(what, view, {n: t[n] for n in ("plan_position", "attempt", "outcome", "invalid_reason", "done_s")})
        rows = [(presentations[k], parts[k]) for k in sorted(presentations) if k[0] == t["trial_id"]]
        each = [felt(ticks[:p["ticks"]]) for p, ticks in rows if p["ticks"] is not None]
        for (p, _), one in zip(rows, each):
            expect(f"presentation {t['trial_id']} {p['interval']}", p, {n: one[n] for n in FELT + ["path_length_m", "first_contact_s"]})
        total = lambda name: sum(one[name] for one in each)
        ended, rate = bool(each), session["rate_hz"]
        first = [one["first_contact_s"] for one in each if one["first_contact_s"] is not None]
        expect(what, view, {
            "first_contact_s": first[0] if first else None,
            "path_length_m": total("path_length_m") if ended else None, "strokes": total("strokes") if ended else None,
            "mean_normal_force_n": ratio(total("sum_fn"), total("contact_ticks"), 0.0) if ended else None,
            "max_normal_force_n": max(one["max_fn"] for one in each) if ended else None,
            "mean_speed_m_per_s": ratio(total("contact_path"), total("contact_time"), 0.0) if ended else None,
            "contact_s": total("contact_ticks") / rate if ended else None,
            "slip_share": ratio(total("slip_ticks"), total("contact_ticks")),
            "before_vertex_s": total("before") / rate if ended else None,
            "after_vertex_s": total("after") / rate if ended else None,
            "late_share": ratio(total("late_ticks"), total("ticks")),
            "saturated_share": ratio(total("saturated_ticks"), total("ticks"))})

    confused = Counter((studies[sessions[t["session_id"]]["study_id"]]["study_name"], sessions[t["session_id"]]["session_kind"],
                        plans[t["session_id"], t["plan_position"]]["friction"], plans[t["session_id"], t["plan_position"]]["planned_object"],
                        responses[t["trial_id"]]["chosen_object"])
                       for t in trials.values() if t["trial_id"] in responses and t["invalid_reason"] is None
                       and plans[t["session_id"], t["plan_position"]]["phase"] == "main" and responses[t["trial_id"]]["chosen_object"])
    expect("confusion", {"n": {tuple(r)[:5]: r["n"] for r in db.execute("SELECT * FROM confusion")}}, {"n": dict(confused)})

    time = lambda text: datetime.datetime.fromisoformat(text.replace("Z", "+00:00"))
    for view in db.execute("SELECT * FROM session_health").fetchall():
        s = sessions[view["session_id"]]
        mine = [t for t in trials.values() if t["session_id"] == s["session_id"]]
        events = [r for r in db.execute("SELECT event_kind, count FROM event WHERE session_id = ?", (s["session_id"],))]
        ticks = sum(t["ticks"] or 0 for t in mine)
        end = s["finished_utc"] or max([t["ended_utc"] for t in mine if t["ended_utc"]])
        outcomes = Counter(t["outcome"] for t in mine)
        expect(f"session_health {s['session_id']}", view, {
            "study_name": studies[s["study_id"]]["study_name"], "participant_code": people[s["participant_id"]]["participant_code"],
            "session_number": s["session_number"], "session_kind": s["session_kind"], "finished": s["finished"],
            "planned": sum(k[0] == s["session_id"] for k in plans), "answered": sum(t["trial_id"] in responses for t in mine),
            "invalid_answers": sum(t["invalid_reason"] is not None for t in mine), "faulted": outcomes["faulted"],
            "aborted": outcomes["aborted"], "interrupted": outcomes["interrupted"],
            "late_share": ratio(sum(t["late_ticks"] or 0 for t in mine), ticks),
            "saturated_share": ratio(sum(t["saturated_ticks"] or 0 for t in mine), ticks),
            "lost_ticks": sum(e["count"] for e in events if e["event_kind"] == "ticks lost"),
            "felt_s": ticks / s["rate_hz"], "breaks": sum(e["event_kind"] == "break" for e in events)})
        lasted = (time(end) - time(s["started_utc"])).total_seconds()
        expect(f"session_health {s['session_id']}", {"duration_s": abs(view["duration_s"] - lasted) < 1e-3}, {"duration_s": True})

    numbers = Counter()
    for view in db.execute("SELECT * FROM adaptive_trial ORDER BY trial_id").fetchall():
        t, answer = trials[view["trial_id"]], responses[view["trial_id"]]
        numbers[t["session_id"], view["run_number"]] += 1
        felt_one = presentations[view["trial_id"], view["comparison_interval"]]
        first = next(iter(json.loads(view["estimates"]).values()), {"mean": None})
        expect(f"adaptive_trial {t['trial_id']}", view, {
            "run_trial_number": numbers[t["session_id"], view["run_number"]], "stimulus": felt_one["stimulus"], "mu_s": felt_one["mu_s"],
            "curvature_per_m": felt_one["curvature_per_m"], "answer_code": answer["answer_code"], "correct": answer["correct"],
            "rule_outcome": int(answer["answer_code"] + 1 == view["comparison_interval"]), "estimate": first["mean"],
            "counts": int(t["invalid_reason"] is None), "plan_position": t["plan_position"]})


main(*sys.argv[1:3])
print(f"{checked} values, {differences} differences")
sys.exit(differences > 0)
