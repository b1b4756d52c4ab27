import csv, json, pathlib, re, sys
out = pathlib.Path(sys.argv[1])
described = json.loads((out / "dataset_description.json").read_text())
assert described["@context"].rstrip("/").endswith("schema.org") and described["@type"] == "Dataset"
assert described["name"] and described["description"]
named = {v["name"] for v in described["variableMeasured"]}
files = list((out / "data").iterdir())
assert len(files) == 12
for path in files:
    assert re.fullmatch(r"([a-z]+-[A-Za-z0-9]+_)+data\.csv", path.name), path.name
    with open(path, newline="") as text:
        head, *rows = csv.reader(text)
    assert set(head) <= named, set(head) - named
    assert all(len(row) == len(head) for row in rows)
