import pathlib
import pandas as pd

folder = pathlib.Path(__file__).parent

# Types of all columns, and the levels of those that have fixed words ("real = ...; pilot = ...").
columns = pd.read_csv(folder / "columns.csv", dtype=str, keep_default_na=False)


def load_table(name):
    own = columns[(columns.table == name) & (columns.column != "")]
    texts = {c: "string" for c, t in zip(own.column, own.type) if t == "text"}
    d = pd.read_csv(folder / f"{name}.csv", dtype=texts, keep_default_na=False, na_values=[""],
                    float_precision="round_trip")
    for column, kind_of, levels in zip(own.column, own.type, own.levels):
        if levels and kind_of == "text":
            words = [word.split(" = ")[0] for word in levels.split("; ")]
            d[column] = pd.Categorical(d[column], categories=words)
    if "subject" in d:
        d["subject"] = d.subject.astype("category")
    if "friction" in d:
        d["friction"] = pd.Categorical(d.friction, categories=frictions, ordered=True)
    for column in ("planned_object", "chosen_object", "picture_object", "felt_object"):
        if column in d:
            d[column] = pd.Categorical(d[column], categories=objects, ordered=True)
    return d


participants = load_table("participants")
sessions = load_table("sessions")
trials = load_table("trials")

# Real, pilot and simulated data are never mixed; practice and catch trials are no main trials.
main = trials[(trials.session_kind == kind) & (trials.phase == "main") & (trials.counts == 1)].copy()

if main.empty:
    print(f"{kind}: no answer of a main trial counts here")

# The person is the unit: a share each, then differences within person. Studies are kept apart.
for study, own in main.groupby("study_label", observed=True, sort=False):
    own = own[own.correct.notna()]
    if own.empty:
        print(f"{study}, {kind}: no answer is right or wrong here: no share of right answers")
        judged = main[(main.study_label == study) & main.comparison_interval.isna() & main.chosen_object.isna()]
        if not judged.empty:  # yes is 1, no 0; a rating's first level is 0
            print("mean answer_code (of ratings: level - 1)")
            print(judged.pivot_table(values="answer_code", index="subject", columns=["planned_object", "friction"],
                                   aggfunc="mean", observed=True).round(3))
        continue
    print(f"{study}, {kind}:")
    share = own.pivot_table(values="correct", index="subject", columns="friction", aggfunc="mean", observed=True)
    print(share.round(3))
    # scipy.stats.ttest_1samp(share.iloc[:, 1] - share.iloc[:, 0], 0)
