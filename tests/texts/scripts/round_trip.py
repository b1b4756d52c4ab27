import csv, gzip, json, sqlite3, struct, sys
file, out = sys.argv[1:3]
bits = lambda x: struct.pack("<d", x)
db = sqlite3.connect(file)
db.row_factory = sqlite3.Row
rows = db.execute("SELECT trial.*, reaction_s, reaction_uncertainty_s, mu_s, curvature_per_m FROM trial"
                  " JOIN plan USING (session_id, plan_position) LEFT JOIN response USING (trial_id)"
                  " ORDER BY trial.trial_id").fetchall()
written = list(csv.DictReader(open(f"{out}/trials.csv", newline="")))
assert len(rows) == len(written) == 10, (len(rows), len(written))
seen = 0
for row, line in zip(rows, written):
    for name in row.keys():
        if name in line and isinstance(row[name], float):
            assert bits(float(line[name])) == bits(row[name]), (name, line[name], row[name])
            seen += 1
        elif name in line and isinstance(row[name], int):
            assert int(line[name]) == row[name]
columns = {(c["table"], c["column"]) for c in csv.DictReader(open(f"{out}/columns.csv"))}
for table in ("trials", "responses", "sessions", "plan", "events", "participants", "pictures"):
    for name in next(csv.reader(open(f"{out}/{table}.csv"))):
        assert (table, name) in columns, (table, name)
ticks = 0
for row, line in zip(rows, written):
    name = f"{out}/ticks/{line['subject']}_shapefrictiondemo_ses-01_trial-{int(line['trial_number']):04}.csv.gz"
    hip = [float(t["hip_x_m"]) for t in csv.DictReader(gzip.open(name, "rt"))]
    assert len(hip) == row["ticks"] or len(hip) > row["ticks"]
    ticks += len(hip)
print(seen, ticks)
