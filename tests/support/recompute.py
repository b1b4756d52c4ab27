"""Every column of the views of a study, computed again from its ticks and its tables, by other code.

usage: recompute.py FILE SAMPLE.csv DATA.md
(SAMPLE: all of sample by trial_id, interval, tick; DATA.md: the queries of its ten usual questions are run, and
their answers computed from the tables; prints what differs)
"""
import csv, datetime, json, math, re, sqlite3, sys, tomllib
from collections import Counter, defaultdict

HAND = ("strokes_before_vertex strokes_after_vertex reversals stick_events speed_p10_m_per_s speed_p50_m_per_s speed_p90_m_per_s "
        "normal_force_p10_n normal_force_p50_n normal_force_p90_n").split()
FELT = "ticks contact_ticks slip_ticks late_ticks saturated_ticks".split()


def strokes(ticks):
    """Turns of 5 mm or more along the surface; a lift of more than 0.1 s begins a new one.
    -> (where each was counted: 0 or 1, before or after the vertex, or None; those that came back on another)"""
    sides, back, side, direction, place, low, high, last = [], 0, None, 0, 0.0, 0.0, 0.0, 0.0
    for before, t in zip([None] + ticks, ticks):
        if t["mode"] == "free":
            continue
        if t["time_s"] - last > 0.1 + 1e-12:
            direction, place, low, high = 0, 0.0, 0.0, 0.0
        last = t["time_s"]
        side = t["segment"] if t["segment"] >= 0 else side
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
            back += direction != 0
            sides, direction, high = sides + [side], 1, place
        elif direction >= 0 and high - place >= 0.005:
            back += direction != 0
            sides, direction, low = sides + [side], -1, place
    return sides, back


def decile(values, tenths):
    """The nearest rank."""
    return sorted(values)[-(-tenths * len(values) // 10) - 1] if values else 0.0


def covered(touch, outline, curvature):
    """Share of both arcs that the god-object was on, in bins of 1 mm: the way along an arc by its chord."""
    a, v, b = ([1e-3 * x for x in outline[k]] for k in ("a_mm", "vertex_mm", "b_mm"))
    along = lambda d: 2 / curvature * math.asin(curvature * d / 2) if curvature else d
    bins = {(int(t["segment"]), int(1e3 * along(math.dist((t["go_x_m"], t["go_y_m"]), a if t["segment"] == 0 else v))))
            for t in touch if t["segment"] in (0, 1)}
    return len(bins) / (1e3 * (along(math.dist(a, v)) + along(math.dist(v, b))))


def felt(ticks):
    """What an interval's ticks up to done add up to."""
    touch = [t for t in ticks if t["mode"] != "free"]
    speeds, window = [], None
    for before, t in zip([None] + ticks, ticks):
        if t["mode"] == "free" or window is None or before["mode"] == "free":
            window = t if t["mode"] != "free" else None
        elif round(1e9 * (t["time_s"] - window["time_s"])) >= 20_000_000:
            speeds.append(math.hypot(t["hip_x_m"] - window["hip_x_m"], t["hip_y_m"] - window["hip_y_m"]) / (t["time_s"] - window["time_s"]))
            window = t
    sides, back = strokes(ticks)
    forces = [t["rendered_normal_n"] for t in touch]
    steps = [(math.hypot(b["hip_x_m"] - a["hip_x_m"], b["hip_y_m"] - a["hip_y_m"]), b["time_s"] - a["time_s"], b["mode"] != "free")
             for a, b in zip(ticks, ticks[1:])]
    return {
        "ticks": len(ticks), "contact_ticks": len(touch),
        "slip_ticks": sum(t["mode"] in ("slip", "transition") for t in touch),
        "late_ticks": sum(t["flags"] >> 1 & 1 for t in ticks),
        "saturated_ticks": sum(t["flags"] & 1 for t in ticks),
        "path_length_m": math.fsum(s for s, _, _ in steps),
        "sum_fn": math.fsum(t["rendered_normal_n"] for t in touch), "max_fn": max([t["rendered_normal_n"] for t in touch], default=0.0),
        "first_contact_s": touch[0]["time_s"] if touch else None, "strokes": len(sides), "touch": touch,
        "strokes_before_vertex": sides.count(0), "strokes_after_vertex": sides.count(1), "reversals": back,
        "stick_events": sum(b["mode"] == "stuck" and a["mode"] in ("slip", "transition") for a, b in zip(ticks, ticks[1:])),
        "start_x_m": ticks[0]["hip_x_m"] if ticks else 0.0, "start_y_m": ticks[0]["hip_y_m"] if ticks else 0.0,
        "vertex": sum(t["segment"] == -1 for t in touch),
        **{f"speed_p{n}0_m_per_s": decile(speeds, n) for n in (1, 5, 9)},
        **{f"normal_force_p{n}0_n": decile(forces, n) for n in (1, 5, 9)},
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


def mean(values):
    known = [v for v in values if v is not None]
    return sum(known) / len(known) if known else None


def grouped(trials, keys, *columns):
    """Rows as GROUP BY keys ORDER BY keys gives them, NULL first; a column is a function of a group's trials."""
    groups = defaultdict(list)
    for t in trials:
        groups[tuple(k(t) if callable(k) else t[k] for k in keys)].append(t)
    order = sorted(groups, key=lambda key: [(v is not None, v) for v in key])
    return [key + tuple(c(groups[key]) if callable(c) else mean(t[c] for t in groups[key]) for c in columns) for key in order]


def answer_questions(db, document, trials):
    """The ten usual questions of docs/data.md, each against what the tables give."""
    text = open(document, encoding="utf-8").read().split("## Ten usual questions", 1)[1].split("\n## ", 1)[0]
    queries = re.findall(r"```sql\n(.*?)```", text, re.S)
    count = len
    main_ones = [t for t in trials if t["counts"] and t["phase"] == "main" and t["consent"] != 0]
    kinds = {t["session_kind"] for t in trials if t["answer_code"] is not None and t["consent"] != 0}
    main_ones = [t for t in main_ones if t["session_kind"] == [k for k in ("real", "pilot", "simulated") if k in kinds][0]]
    columns = "trial_id study_name participant_code session_kind correct trials_since_break".split()
    expect("main_trial", {"rows": [tuple(r[c] for c in columns) for r in db.execute("SELECT * FROM main_trial ORDER BY trial_id")]},
           {"rows": [tuple(t[c] for c in columns) for t in sorted(main_ones, key=lambda t: t["trial_id"])]})
    for t in trials:
        t["contact_s"] = t["contact_ticks"] / t["rate_hz"] if t["contact_ticks"] is not None else None
        t["slip_share"] = ratio(t["slip_ticks"] or 0, t["contact_ticks"])
    curves = [t for t in main_ones if t["comparison_chosen"] is not None]
    answers = [
        grouped(main_ones, ["study_name", "participant_code", "friction"], count, "correct"),
        grouped(main_ones, ["study_name", "participant_code", "session_number", "block"], count, "correct"),
        grouped(main_ones, ["study_name", lambda t: (t["trial_number"] - 1) // 10 * 10 + 1], count, "correct"),
        grouped(main_ones, ["study_name", "trials_since_break"], count, "correct", "reaction_s"),
        grouped(curves, ["study_name", "run_name", "stimulus"], count, "comparison_chosen"),
        grouped(curves, ["study_name", "object_1", "object_2", "friction_1", "friction_2"], count, "correct"),
        grouped([t for t in main_ones if t["chosen_object"]], ["study_name", "friction", "planned_object", "chosen_object"], count),
        grouped([t for t in main_ones if t["confidence"] is not None], ["study_name", "confidence"], count, "correct", "reaction_s"),
        grouped(main_ones, ["study_name", "planned_object", "friction"], "contact_s", "path_length_m", "strokes", "slip_share",
                "mean_normal_force_n"),
        grouped([{**t, "why": "no consent" if t["consent"] == 0 else t["exclusion"]} for t in trials
                 if not t["counts"] or t["consent"] == 0], ["study_name", "session_kind", "outcome", "why"], count)]
    expect("docs/data.md", {"questions": len(queries)}, {"questions": len(answers)})
    for number, (query, wanted) in enumerate(zip(queries, answers), 1):
        got = [tuple(r) for r in db.execute(query)]
        expect(f"question {number}", {"rows": len(got), "some": bool(got)}, {"rows": len(wanted), "some": True})
        for a, b in zip(got, wanted):
            expect(f"question {number} {b}", dict(enumerate(a)), dict(enumerate(b)))


def main(file, samples, document):
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

    in_session, since_break, taken_in, rows_of_trials = Counter(), Counter(), Counter(), []
    adaptive = {(r["session_id"], r["plan_position"]): dict(r) for r in db.execute("SELECT * FROM adaptive_plan")}
    steps = table("adaptive_step", "trial_id")
    kinds, marked = defaultdict(list), set()
    for r in db.execute("SELECT * FROM event ORDER BY event_id"):
        kinds[r["session_id"]].append(r["event_kind"])
        if r["event_kind"] == "mark":
            (marked.discard if r["key"] == "undone" else marked.add)(r["trial_id"])
    counts = lambda t: int(t["trial_id"] in responses and t["invalid_reason"] is None
                           and sessions[t["session_id"]]["withdrawn_reason"] is None)
    for view in db.execute("SELECT * FROM analysis_trial ORDER BY trial_id").fetchall():
        t = trials[view["trial_id"]]
        session, answer = sessions[t["session_id"]], responses.get(t["trial_id"], defaultdict(lambda: None))
        plan = dict(plans[t["session_id"], t["plan_position"]])
        what = f"analysis_trial {t['trial_id']}"
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
            one["stick_events"] = one["stick_events"] if p["mu_s"] > 0 else None
            hand = db.execute("SELECT * FROM exploration WHERE trial_id = ? AND interval = ?", (t["trial_id"], p["interval"])).fetchone()
            expect(f"exploration {t['trial_id']} {p['interval']}", hand, {
                **{n: one[n] for n in HAND + ["strokes", "path_length_m", "first_contact_s", "start_x_m", "start_y_m"]},
                "late_share": ratio(one["late_ticks"], one["ticks"]), "saturated_share": ratio(one["saturated_ticks"], one["ticks"]),
                "vertex_s": one["vertex"] / session["rate_hz"], "contact_s": one["contact_ticks"] / session["rate_hz"],
                "before_vertex_s": one["before"] / session["rate_hz"], "after_vertex_s": one["after"] / session["rate_hz"],
                "felt_object": p["felt_object"], "friction": p["friction"], "curvature_per_m": p["curvature_per_m"], "done_s": p["done_s"],
                "participant_code": people[session["participant_id"]]["participant_code"], "phase": plan["phase"], "outcome": t["outcome"],
                "counts": counts(t)})
            outline = tomllib.loads(studies[session["study_id"]]["protocol_toml"]).get("outline")
            if p["curvature_per_m"] is not None and outline:
                share = covered(one["touch"], outline, p["curvature_per_m"])
                expect(f"coverage {t['trial_id']}", {"near": abs(hand["covered_share"] - share) < 0.06}, {"near": True})
        total = lambda name: sum(one[name] for one in each)
        ended, rate = bool(each), session["rate_hz"]
        first = [one["first_contact_s"] for one in each if one["first_contact_s"] is not None]
        key = t["session_id"], t["plan_position"]
        breaks = t["session_id"], kinds[t["session_id"]][:t["seal_events"] or 0].count("break")
        in_session[t["session_id"]] += 1
        rule, step = adaptive.get(key, defaultdict(lambda: None)), steps.get(t["trial_id"], defaultdict(lambda: None))
        run = t["session_id"], rule["run_number"]
        taken_in[run] += step["rule_outcome"] is not None
        felt_1, felt_2 = (presentations.get((t["trial_id"], i), defaultdict(lambda: None)) for i in (1, 2))
        compared = felt_2 if rule["comparison_interval"] == 2 else felt_1 if rule["comparison_interval"] else defaultdict(lambda: None)
        one = {
            "block": plan["block"], "trial_number": in_session[t["session_id"]],
            "trials_since_break": since_break[breaks] if t["seal_events"] is not None else None,
            "object_1": felt_1["felt_object"], "object_2": felt_2["felt_object"], "friction_1": felt_1["friction"],
            "friction_2": felt_2["friction"], "curvature_1_per_m": felt_1["curvature_per_m"],
            "curvature_2_per_m": felt_2["curvature_per_m"], "mu_s_1": felt_1["mu_s"], "mu_s_2": felt_2["mu_s"],
            "run_number": rule["run_number"], "run_name": rule["run_name"], "comparison_interval": rule["comparison_interval"],
            "run_trial_number": taken_in[run] if step["rule_outcome"] is not None else None,
            "stimulus": compared["stimulus"], "comparison_curvature_per_m": compared["curvature_per_m"],
            "comparison_mu_s": compared["mu_s"], "answer_code": answer["answer_code"], "confidence": answer["confidence"],
            "comparison_chosen": int(answer["answer_code"] + 1 == rule["comparison_interval"])
                if felt_2["felt_object"] and answer["answer_code"] is not None else None,
            "exclusion": "withdrawn" if session["withdrawn_reason"] else "marked" if t["trial_id"] in marked else t["invalid_reason"],
            "counts": counts(t),
            "rule_outcome": step["rule_outcome"], "state_sha256": step["state_sha256"],
            "estimate": next(iter(json.loads(step["estimates"] or "{}").values()), {"mean": None})["mean"]}
        if step["rule_outcome"] is not None:
            expect(what, one, {"rule_outcome": int(answer["answer_code"] + 1 == rule["comparison_interval"])})
        since_break[breaks] += t["seal_events"] is not None
        expect(what, view, one)
        rows_of_trials.append({**plan, **t, **answer, **one, "outcome": t["outcome"],
                               "participant_code": people[session["participant_id"]]["participant_code"],
                               "consent": people[session["participant_id"]]["consent"],
                               "study_name": studies[session["study_id"]]["study_name"], "session_kind": session["session_kind"],
                               "session_number": session["session_number"], "rate_hz": session["rate_hz"]})
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
                       for t in trials.values() if counts(t) and plans[t["session_id"], t["plan_position"]]["phase"] == "main" and responses[t["trial_id"]]["chosen_object"])
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
            "withdrawn_reason": s["withdrawn_reason"],
            "planned": sum(k[0] == s["session_id"] for k in plans), "answered": sum(t["trial_id"] in responses for t in mine),
            "invalid_answers": sum(t["invalid_reason"] is not None for t in mine), "faulted": outcomes["faulted"],
            "unanswered": outcomes["unanswered"],
            "aborted": outcomes["aborted"], "interrupted": outcomes["interrupted"],
            "late_share": ratio(sum(t["late_ticks"] or 0 for t in mine), ticks),
            "saturated_share": ratio(sum(t["saturated_ticks"] or 0 for t in mine), ticks),
            "lost_ticks": sum(e["count"] for e in events if e["event_kind"] == "ticks lost"),
            "felt_s": ticks / s["rate_hz"], "breaks": sum(e["event_kind"] == "break" for e in events)})
        lasted = (time(end) - time(s["started_utc"])).total_seconds()
        expect(f"session_health {s['session_id']}", {"duration_s": abs(view["duration_s"] - lasted) < 1e-3}, {"duration_s": True})

    answer_questions(db, document, rows_of_trials)


main(*sys.argv[1:4])
print(f"{checked} values, {differences} differences")
sys.exit(differences > 0)
