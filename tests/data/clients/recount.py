"""Counts an exported study again with Python's standard library alone: what was answered to what.

python3 recount.py FOLDER prints, for each of csv, bids and psych-ds in FOLDER, one line for each object and
friction: how many answers count, how many are correct, the longest reaction time; then what rules
chose; then the notes, in hex.
"""
import csv
import json
import pathlib
import re
import sys

folder = pathlib.Path(sys.argv[1])


def table(path, tabs=False):
    with open(path, newline="", encoding="utf-8") as text:
        return list(csv.DictReader(text, dialect="excel-tab" if tabs else "excel", strict=True))


def count(name, rows):
    cells = {}
    for row in rows:
        if row["counts"] == "1":
            cells.setdefault((row["planned_object"], row["friction"]), []).append(row)
    for (thing, friction), answers in sorted(cells.items()):
        correct = sum(row["correct"] == "1" for row in answers)
        longest = max(float(row["reaction_s"]) for row in answers)
        print(name, thing, friction, len(answers), correct, "%.17g" % longest)


def check_bids(out):
    """All columns of every table are described, and words are among their levels."""
    for path in out.rglob("*.tsv"):
        if path.name.endswith(("_motion.tsv", "_channels.tsv")):
            continue
        words = json.loads(path.with_suffix(".json").read_text("utf-8"))
        for row in table(path, tabs=True):
            for column, value in row.items():
                assert words[column]["Description"], (path, column)
                levels = words[column].get("Levels")
                assert value == "n/a" or levels is None or value in levels, (path, column, value)


def check_psych_ds(out):
    """What the schema of psychds-validator asks for: names of files, columns, properties of schema.org."""
    dataset = json.loads((out / "dataset_description.json").read_text("utf-8"))
    assert dataset["@context"] == "http://schema.org/" and dataset["@type"] == "Dataset"
    assert dataset["name"] and dataset["description"]
    known = {"@type", "name", "description", "unitText", "valuePattern"}
    variables = {}
    for variable in dataset["variableMeasured"]:
        assert variable["@type"] == "PropertyValue" and set(variable) <= known, variable
        assert variable["description"] and variable["name"] not in variables, variable
        variables[variable["name"]] = variable
    official = "study site subject session task condition trial stimulus description".split()
    for path in (out / "data").iterdir():
        assert re.fullmatch(r"([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.csv", path.name), path
        assert {word.split("-")[0] for word in path.name.split("_")[:-1]} <= set(official), path
        for row in table(path):
            for column, value in row.items():
                pattern = variables[column].get("valuePattern")
                assert value == "" or pattern is None or re.fullmatch(pattern, value), (column, value)


check_bids(folder / "bids")
check_psych_ds(folder / "psych-ds")
count("csv", table(folder / "csv" / "trials.csv"))
count("bids", [row for path in sorted((folder / "bids").rglob("*_beh.tsv")) for row in table(path, True)])
count("psych-ds", [row for path in sorted((folder / "psych-ds" / "data").iterdir())
                   if path.name.startswith("study-") for row in table(path)])
for trial in table(folder / "csv" / "trials.csv"):
    if trial["run_name"]:
        print(trial["run_name"], trial["comparison_interval"], "%.17g" % float(trial["stimulus"]))
for event in table(folder / "csv" / "events.csv"):
    if event["event_kind"] == "note":
        print("note", event["words"].encode("utf-8").hex())
