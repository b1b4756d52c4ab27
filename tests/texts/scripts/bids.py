import csv, gzip, json, pathlib, re, sqlite3, sys
out = pathlib.Path(sys.argv[2])
described = json.loads((out / "dataset_description.json").read_text())
assert described["Name"] and re.fullmatch(r"\d+\.\d+\.\d+", described["BIDSVersion"])
assert (out / "README").stat().st_size > 150
tsv = lambda path: list(csv.reader(open(path, newline=""), delimiter="\t"))
people = tsv(out / "participants.tsv")
assert people[0][0] == "participant_id"
subjects = [row[0] for row in people[1:]]
assert sorted(subjects) == sorted(p.name for p in out.glob("sub-*"))
json.loads((out / "participants.json").read_text())
entity = r"sub-[0-9a-zA-Z]+_ses-[0-9a-zA-Z]+_task-[0-9a-zA-Z]+"
run = r"_tracksys-[0-9a-zA-Z]+(_acq-[0-9a-zA-Z]+)?_run-\d+"
for path in out.rglob("*_beh.tsv"):
    assert re.fullmatch(entity + "_beh.tsv", path.name)
    head, *rows = tsv(path)
    words = json.loads(path.with_suffix(".json").read_text())
    assert words["TaskName"] and all("Description" in words[name] for name in head)
    assert len(rows) == 10 and all(len(row) == len(head) for row in rows)
    assert all(cell != "" for row in rows for cell in row)
runs = 0
for path in out.rglob("*_motion.tsv"):
    runs += 1
    assert re.fullmatch(entity + run + "_motion.tsv", path.name)
    stem = str(path)[:-len("motion.tsv")]
    head, *channels = tsv(stem + "channels.tsv")
    assert head[:6] == ["name", "component", "type", "tracked_point", "units", "reference_frame"]
    frames = json.loads(open(stem + "channels.json").read())["reference_frame"]["Levels"]
    assert all((c[1] == "n/a") == (c[5] == "n/a") and c[5] in {"n/a", *frames} for c in channels)
    kinds = [c[2] for c in channels]
    assert set(kinds) <= {"POS", "LATENCY", "MISC"} and set(c[1] for c in channels) <= {"x", "y", "z", "n/a"}
    words = json.loads(open(stem + "motion.json").read())
    for name in ("SamplingFrequency", "TaskName", "TrackingSystemName"):
        assert words[name]
    for kind in set(kinds):
        assert words[kind + "ChannelCount"] == kinds.count(kind)
    rows = tsv(path)
    assert all(len(row) == len(channels) == words["MotionChannelCount"] for row in rows)
    force = path.parent.parent / "beh" / path.name.replace("_tracksys-handle", "")
    force = str(force)[:-len("motion.tsv")] + "recording-force_stim"
    stim = json.loads(open(force + ".json").read())
    assert stim["StartTime"] == 0 and stim["SamplingFrequency"] == words["SamplingFrequency"]
    lines = gzip.open(force + ".tsv.gz", "rt").read().splitlines()
    assert len(lines) == len(rows) and all(len(l.split("\t")) == len(stim["Columns"]) for l in lines)
    at = [c[0] for c in channels].index("time_s")
    assert all(re.fullmatch(r"\d+\.\d{9}", row[at]) for row in rows)
    assert float(rows[0][at]) == 0 and abs(float(rows[-1][at]) - (len(rows) - 1) / 1000) < 1e-6
assert runs == 10
