#include "data/export/starters.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "data/csv/number_table.hpp"
#include "data/export/json_text.hpp"

namespace palpate::data {
namespace {

/// What the scripts set, in the order in which a table should show it.
struct Levels {
    std::vector<std::string> kinds;  ///< of sessions, real before pilot before simulated
    std::vector<std::string> frictions;
    std::vector<std::string> objects;
};

/// Names by the least number that stands beside them; those without one last, by name.
class Ranked {
public:
    void add(std::string_view name, std::string_view number) {
        double value = std::numeric_limits<double>::infinity();
        std::from_chars(number.data(), number.data() + number.size(), value);
        if (!name.empty()) {
            const auto [place, is_new] = least_.try_emplace(std::string(name), value);
            place->second = std::min(place->second, value);
        }
    }
    [[nodiscard]] std::vector<std::string> names() const {
        std::vector<std::string> all;
        for (const auto& [name, value] : least_) {
            all.push_back(name);
        }
        std::ranges::stable_sort(all, {},
                                 [this](const std::string& name) { return least_.at(name); });
        return all;
    }

private:
    std::map<std::string, double> least_;
};

Levels levels_of(const std::filesystem::path& folder) {
    constexpr std::array<std::string_view, 6> kTexts{
        "session_kind", "friction", "mu_s", "planned_object", "curvature_per_m", "chosen_object"};
    const NumberTable trials = read_numbers(folder / "trials.csv", {}, {}, kTexts);
    const auto text = [&](std::size_t row, std::string_view column) {
        return trials.text(row, column).value_or("");
    };
    Ranked kinds;
    Ranked frictions;
    Ranked objects;
    for (std::size_t row = 0; row < trials.rows(); ++row) {
        const std::string_view kind = text(row, "session_kind");
        kinds.add(kind, kind == "real" ? "0" : kind == "pilot" ? "1" : "2");
        frictions.add(text(row, "friction"), text(row, "mu_s"));
        objects.add(text(row, "planned_object"), text(row, "curvature_per_m"));
        objects.add(text(row, "chosen_object"), "");
    }
    Levels levels{kinds.names(), frictions.names(), objects.names()};
    if (levels.kinds.empty() || levels.frictions.empty()) {
        throw std::invalid_argument(fmt::format(
            "{}: there is no trial in it, or the columns session_kind and friction are gone",
            (folder / "trials.csv").string()));
    }
    return levels;
}

/// The words as a list of the language: "a", "b".
std::string words_text(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) {
        text += (&word == words.data() ? "" : ", ") + json_string(word);
    }
    return text;
}

constexpr std::string_view kR = R"R(
self <- sub('^--file=', '', grep('^--file=', commandArgs(FALSE), value = TRUE))
folder <- if (length(self)) dirname(self[1]) else '.'

# Types of all columns, and the levels of those that have fixed words ('real = ...; pilot = ...').
columns <- read.csv(file.path(folder, 'columns.csv'), colClasses = 'character', encoding = 'UTF-8')
load_table <- function(name) {
    own <- columns[columns$table == name & columns$column != '', ]
    types <- setNames(ifelse(own$type == 'text', 'character', 'numeric'), own$column)
    d <- read.csv(file.path(folder, paste0(name, '.csv')), colClasses = types, na.strings = '', encoding = 'UTF-8')
    for (i in which(own$levels != '')) {
        words <- sub(' = .*', '', strsplit(own$levels[i], '; ', fixed = TRUE)[[1]])
        if (own$type[i] == 'text') d[[own$column[i]]] <- factor(d[[own$column[i]]], levels = words)
    }
    if ('subject' %in% names(d)) d$subject <- factor(d$subject)
    if ('friction' %in% names(d)) d$friction <- factor(d$friction, levels = frictions)
    for (object in intersect(c('planned_object', 'chosen_object', 'picture_object', 'felt_object'), names(d)))
        d[[object]] <- factor(d[[object]], levels = objects)
    d
}
participants <- load_table('participants')
sessions <- load_table('sessions')
trials <- load_table('trials')

# Real, pilot and simulated data are never mixed; practice and catch trials are no main trials.
main <- droplevels(subset(trials, session_kind == kind & phase == 'main' & counts == 1))
main$friction <- factor(main$friction, levels = frictions)

# The person is the unit: a share each, then differences within person. Studies are kept apart.
for (study in unique(main$study_label)) {
    own <- droplevels(main[main$study_label == study & !is.na(main$correct), ])
    if (nrow(own) == 0) {
        cat(study, ', ', kind, ': no answer is right or wrong here: no share of right answers\n', sep = '')
        judged <- subset(main, study_label == study & is.na(comparison_interval) & is.na(chosen_object))
        if (nrow(judged) > 0) {  # yes is 1, no 0; a rating's first level is 0
            cat('mean answer_code\n')
            print(round(with(droplevels(judged), tapply(answer_code, list(subject, paste(planned_object, friction)), mean)), 3))
        }
        next
    }
    cat(study, ', ', kind, ':\n', sep = '')
    share <- with(own, tapply(correct, list(subject, friction), mean))
    print(round(share, 3))
    # t.test(share[, 2] - share[, 1])
    # lme4::glmer(correct ~ friction + (friction | subject), own, binomial)
}
)R";

constexpr std::string_view kPython = R"PY(
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
        d["friction"] = pd.Categorical(d.friction, categories=frictions)
    for column in ("planned_object", "chosen_object", "picture_object", "felt_object"):
        if column in d:
            d[column] = pd.Categorical(d[column], categories=objects, ordered=True)
    return d


participants = load_table("participants")
sessions = load_table("sessions")
trials = load_table("trials")

# Real, pilot and simulated data are never mixed; practice and catch trials are no main trials.
main = trials[(trials.session_kind == kind) & (trials.phase == "main") & (trials.counts == 1)].copy()

# The person is the unit: a share each, then differences within person. Studies are kept apart.
for study, own in main.groupby("study_label", observed=True, sort=False):
    own = own[own.correct.notna()]
    if own.empty:
        print(f"{study}, {kind}: no answer is right or wrong here: no share of right answers")
        judged = main[(main.study_label == study) & main.comparison_interval.isna() & main.chosen_object.isna()]
        if not judged.empty:  # yes is 1, no 0; a rating's first level is 0
            print("mean answer_code")
            print(judged.pivot_table(values="answer_code", index="subject", columns=["planned_object", "friction"],
                                   aggfunc="mean", observed=True).round(3))
        continue
    print(f"{study}, {kind}:")
    share = own.pivot_table(values="correct", index="subject", columns="friction", aggfunc="mean", observed=True)
    print(share.round(3))
    # scipy.stats.ttest_1samp(share.iloc[:, 1] - share.iloc[:, 0], 0)
)PY";

}  // namespace

std::vector<std::filesystem::path> write_starters(const std::filesystem::path& folder) {
    for (const char* name : {"columns.csv", "trials.csv"}) {
        if (!std::filesystem::exists(folder / name)) {
            throw std::invalid_argument(
                fmt::format("{} is no export: it has no {}; make one with palpate export FILE "
                            "--format csv -o FOLDER",
                            folder.string(), name));
        }
    }
    const Levels levels = levels_of(folder);
    const std::string about =
        "# Loads the export beside it, with types and levels set. Written by palpate analysis "
        "init, "
        "to be changed.\n";
    std::vector<std::filesystem::path> written{folder / "analysis.R", folder / "analysis.py"};
    for (const auto& file : written) {
        if (std::filesystem::exists(file)) {
            throw std::invalid_argument(fmt::format(
                "{} is there already, and stays as it is: move it away first", file.string()));
        }
    }
    write_new(
        written[0],
        fmt::format("{}kind <- {}  # of sessions; here are {}\nfrictions <- c({})  # by static "
                    "friction\nobjects <- c({})  # by curvature\n",
                    about, json_string(levels.kinds[0]), fmt::join(levels.kinds, ", "),
                    words_text(levels.frictions), words_text(levels.objects)) +
            std::string(kR));
    write_new(written[1],
              fmt::format("{}kind = {}  # of sessions; here are {}\nfrictions = [{}]  # by static "
                          "friction\nobjects = [{}]  # by curvature\n",
                          about, json_string(levels.kinds[0]), fmt::join(levels.kinds, ", "),
                          words_text(levels.frictions), words_text(levels.objects)) +
                  std::string(kPython));
    return written;
}

}  // namespace palpate::data
