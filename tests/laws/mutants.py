"""Judges TOML files by a JSON Schema, as Debian's python3-jsonschema does, and wrong ones made of them.

mutants.py SCHEMA FOLDER FILE...

Writes each mutant into FOLDER, and prints a line for each file: what it is, its file, "taken" or "refused". What it
is: "shipped", "wrong" (a mutant whose key, type, range or word is wrong), "other" (any other change).
"""
import copy
import itertools
import json
import pathlib
import re
import sys
import tomllib

import jsonschema


def toml(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list):
        return "[" + ", ".join(toml(item) for item in value) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(item)}" for key, item in value.items()) + " }"
    return repr(value)


def leaves(value, path=()):
    """Paths of all values that are neither tables nor lists of tables; and those of all tables."""
    if isinstance(value, dict):
        yield path, value
        for key, item in value.items():
            yield from leaves(item, (*path, key))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for i, item in enumerate(value):
            yield from leaves(item, (*path, i))
    else:
        yield path, value


def changed(file, path, value):
    """A copy in which another value stands at the path; without it if the value is None."""
    copied = copy.deepcopy(file)
    parent = copied
    for step in path[:-1]:
        parent = parent[step]
    if value is None:
        del parent[path[-1]]
    else:
        parent[path[-1]] = value
    return copied


def rows_of(schema, path):
    """The schema of the value at a path: by properties and items alone, of several forms the one that has the key."""
    for step in path:
        forms = [schema, *schema.get("anyOf", [])]
        schema = schema["items"] if isinstance(step, int) else next(
            form["properties"][step] for form in forms if step in form.get("properties", {}))
    return schema


RANGE = re.compile(r"\((?:above (N)|(N)(?= to | or more))?(?: or more)?(?:(?:, at most | to |up to )(N))?\)$"
                   .replace("N", r"[-+.\de]+"))


def wrong_values(row, value):
    """Values of another type, out of the range, and words that are none."""
    yield 7 if isinstance(value, str) else "text"
    yield {"a": 1, "b": 2}
    if not isinstance(value, bool):
        yield True
    ends = RANGE.search(row.get("description", "")) if row.get("type") in ("number", "integer") else None
    if ends:  # as people read it: a bound that the schema forgot is one all the same
        above, least, most = (None if end is None else float(end) if row["type"] == "number" else int(float(end))
                              for end in ends.groups())
        if above is not None:
            yield above
        if above is not None or least is not None:
            yield (least if above is None else above) - 1
        if most is not None and most < 9e18:
            yield most + abs(most) + 1
    if "enum" in row:
        yield row["enum"][0] + "x"
    if row.get("pattern"):
        yield "Ä b\u0007"
    if row.get("minItems") == 2:
        yield [*value, *value, *value]
        bound = row["items"].get("maximum")
        if bound is not None:
            yield [value[0], bound + 1]


# In turn, three for each value.
OTHERS = itertools.cycle([0, 1, -1, 0.5, 3, 1e6, -1e6, 2.5, "", "x", "two words", False, [], [1], [0.5, 1, 2],
                          [[0, 0], [1, 1]]])


def mutants(file, schema, seen):
    for path, value in leaves(file):
        what = ([step for step in path if isinstance(step, str)],
                list(value) if isinstance(value, dict) else value if isinstance(value, str) else type(value))
        if repr(what) in seen:
            continue  # as another file or table has it, but for a number
        seen.add(repr(what))
        row = rows_of(schema, path)
        if isinstance(value, dict):
            yield "wrong", changed(file, (*path, "no_such_key"), 1)
            for key in row.get("properties", {}):
                if key not in value:
                    yield "other", changed(file, (*path, key), 1)
            continue
        for wrong in wrong_values(row, value):
            yield "wrong", changed(file, path, wrong)
        yield "other", changed(file, path, None)
        for _ in range(3):
            yield "other", changed(file, path, next(OTHERS))


def main():
    schema = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    folder = pathlib.Path(sys.argv[2])
    jsonschema.Draft202012Validator.check_schema(schema)
    judge = jsonschema.Draft202012Validator(schema)

    def defaults(part):
        if isinstance(part, dict):
            if "default" in part and "description" in part:
                jsonschema.Draft202012Validator(part).validate(part["default"])
            for item in part.values():
                defaults(item)

    defaults(schema)
    count = 0
    seen = set()
    for name in sys.argv[3:]:
        file = tomllib.loads(pathlib.Path(name).read_text(encoding="utf-8"))
        print("shipped", name, "taken" if judge.is_valid(file) else "refused", sep="\t")
        for kind, mutant in mutants(file, schema, seen):
            count += 1
            to = folder / f"{count}.toml"
            to.write_text("".join(f"{key} = {toml(value)}\n" for key, value in mutant.items()), encoding="utf-8")
            print(kind, to, "taken" if judge.is_valid(mutant) else "refused", sep="\t")


main()
