#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "data/analysis/summary.hpp"
#include "data/page/sections.hpp"
#include "data/page/study.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/chain.hpp"
#include "data/store/reader.hpp"

namespace palpate::data {
namespace {

/// A unit that people read, with its factor.
struct DisplayUnit {
    const char* unit;
    double factor;
};
DisplayUnit shown_unit(std::string_view column) {
    const std::string_view unit = unit_of(column);
    return column.ends_with("_share") ? DisplayUnit{"%", 100.0}
         : unit == "m/s"              ? DisplayUnit{"mm/s", 1e3}
         : unit == "m"                ? DisplayUnit{"mm", 1e3}
         : unit == "s"                ? DisplayUnit{"s", 1.0}
         : unit == "N"                ? DisplayUnit{"N", 1.0}
                                      : DisplayUnit{"count", 1.0};
}

/// "speed_p50_m_per_s" is "speed p50".
std::string measure_words(std::string name) {
    for (const std::string_view end : {"_m_per_s", "_share", "_m", "_s", "_n"}) {
        if (name.ends_with(end)) {
            name.resize(name.size() - end.size());
            break;
        }
    }
    std::ranges::replace(name, '_', ' ');
    return name;
}

/// Measures of the view, in its order: what the hand did.
std::vector<std::string> measures() {
    std::vector<std::string> names;
    const TableManual* view = find_table("exploration");
    bool begun = false;
    for (const ColumnManual& column : view->columns) {
        begun = begun || column.name == "done_s";
        if (begun) {
            names.push_back(column.name);
        }
    }
    return names;
}

std::string bar_of(const Rows& rows) {
    const auto seconds = [&](const char* name) {
        return fmt::format("{:.2f} s", rows.number(0, name));
    };
    const std::string bar = html_bar(rows, 0);
    return bar.empty()
             ? bar
             : fmt::format(
                   "<p class=\"where\">{} contact before the vertex {}, on it {}, "
                   "after it {}</p>\n",
                   bar, seconds("before_vertex_s"), seconds("vertex_s"), seconds("after_vertex_s"));
}

void add_measures(PageWriter& page, const Study& study, const TrialTrace& trace) {
    PageFigure figure{.id = "measures" + trace.place,
                      .title = "What the hand did" + trace.title,
                      .has_table = true};
    const std::vector<std::string> names = measures();
    figure.data =
        study.ask(fmt::format("SELECT {}\nFROM exploration WHERE trial_id = {} AND interval = {}",
                              fmt::join(names, ", "), trace.trial, trace.interval));
    if (figure.data.cells.empty()) {
        page.paragraph(fmt::format(
            "It did not come to done: nothing was added up of what the hand did{}.", trace.title));
        return;
    }
    std::vector<std::vector<std::string>> cells;
    for (const std::string& name : names) {
        const DisplayUnit unit = shown_unit(name);
        const double value = unit.factor * figure.data.number(0, name);
        const bool whole = std::string_view(unit.unit) == "count";
        const ColumnManual* column = find_column("exploration." + name);
        cells.push_back({measure_words(name),
                         !std::isfinite(value) ? ""
                         : whole               ? fmt::format("{:.0f}", value)
                                               : fmt::format("{:.3f}", value),
                         unit.unit, column->meaning});
    }
    figure.html = bar_of(figure.data) +
                  html_table({"measure", "value", "unit", "what it is"}, cells,
                             "Added up at the trial's end, as the view exploration has it");
    figure.caption =
        "To done. Computed once, when the trial ended, and again from the ticks by palpate verify.";
    page.figure(figure);
}

/// Whose a trial is.
struct Owner {
    std::int64_t session = 0;
    std::string study;
    std::string kind;
    std::string code;
    std::string seal;  ///< of the trial; empty: it did not end
};

Owner owner_of(Database& database, const TrialPageOptions& options) {
    Statement row = database.prepare(
        "SELECT session_id, study_name, session_kind, participant_code, trial.seal, consent IS 0, "
        "withdrawn_reason FROM trial JOIN main.session USING (session_id) JOIN study USING "
        "(study_id) JOIN participant USING (participant_id) WHERE trial_id = ?1",
        options.trial);
    if (!row.step()) {
        Statement all = database.first("SELECT count(*), min(trial_id), max(trial_id) FROM trial");
        throw std::invalid_argument(
            all.integer(0) == 0
                ? fmt::format("{} has no trial", database.file())
                : fmt::format("{} has no trial {}: its trial_id go from {} to {}", database.file(),
                              options.trial, all.integer(1), all.integer(2)));
    }
    refuse_if(row.integer(5) != 0,
              "trial {} is of somebody who is noted as not consenting: there is no page of it",
              options.trial);
    refuse_if(!row.null(6),
              "trial {} is of a session that was withdrawn ({}): there is no page of it",
              options.trial, plain(row.text(6)));
    return {row.integer(0), row.text(1), row.text(2), row.text(3),
            row.null(4) ? std::string() : row.text(4)};
}

std::string answer_text(const Study& study, const Rows& rows) {
    const double code = rows.number(0, "answer_code");
    if (!std::isfinite(code)) {
        return "none";
    }
    const protocols::ResponseSpec& asked = study.protocol.response;
    switch (asked.kind) {
        case protocols::ResponseKind::two_interval:
            return fmt::format("interval {:.0f}", code + 1.0);
        case protocols::ResponseKind::yes_no:
            return code > 0.0 ? "yes" : "no";
        case protocols::ResponseKind::rating:
            return fmt::format("level {:.0f} of {}", code + 1.0, asked.levels);
        case protocols::ResponseKind::identification:
            break;
    }
    return rows.text(0, "chosen_object");
}

std::string seconds_text(const Rows& rows, const char* column) {
    const double value = rows.number(0, column);
    return std::isfinite(value) ? fmt::format("{:.3f} s", value) : "none";
}

std::string felt_text(const Rows& rows, const char* place) {
    const std::string object = rows.text(0, fmt::format("object_{}", place));
    const double curvature = rows.number(0, fmt::format("curvature_{}_per_m", place));
    return fmt::format(
        "{}friction {}{}",
        std::isfinite(curvature) ? fmt::format("curvature {:g} 1/m, ", curvature) : std::string(),
        rows.text(0, fmt::format("friction_{}", place)),
        fmt::format(" (static {:g})", rows.number(0, fmt::format("mu_s_{}", place))));
}

std::string seal_text(Database& database, const Owner& owner, std::int64_t trial) {
    if (owner.seal.empty()) {
        return "none: it has not ended";
    }
    bool other = false;
    for (const ChainBreak& broken : chain_breaks(database, owner.session)) {
        if (broken.trial == trial) {
            return "does not hold: " + broken.what;
        }
        other = true;
    }
    return other ? "holds; another of the session does not" : "holds";
}

void add_facts(PageWriter& page,
               Database& database,
               const Study& study,
               const Owner& owner,
               const Rows& rows) {
    const bool two = !rows.text(0, "object_2").empty();
    std::string out = "<dl class=\"facts\">\n";
    out += html_fact("Person", study.person(owner.code),
                     fmt::format("session {}, attempt {} of it", rows.text(0, "session_number"),
                                 rows.text(0, "trial_number")));
    out += html_fact(two ? "Felt first" : "Felt", rows.text(0, "object_1"), felt_text(rows, "1"));
    if (two) {
        out += html_fact("Felt second", rows.text(0, "object_2"), felt_text(rows, "2"));
    }
    const std::string right = rows.text(0, "correct");
    const bool answered = !rows.text(0, "answer_code").empty();
    out += html_fact("Answer", answer_text(study, rows),
                     !answered       ? ""
                     : right.empty() ? "neither right nor wrong"
                     : right == "1"  ? "right"
                                     : "wrong");
    out += html_fact("Response time", seconds_text(rows, "reaction_s"), "question to answer");
    if (!rows.text(0, "confidence").empty()) {
        out += html_fact("Confidence", rows.text(0, "confidence"), "1 a guess, 4 sure");
    }
    const std::string why = rows.text(0, "exclusion");
    out += html_fact("Outcome", rows.text(0, "outcome"),
                     rows.text(0, "counts") == "1" ? "the answer counts"
                     : !why.empty()                ? "does not count: " + why
                                                   : "no answer that counts");
    if (const std::string cause = rows.text(0, "fault_cause"); !cause.empty()) {
        out += html_fact("The force went off", cause, "after " + seconds_text(rows, "done_s"));
    }
    out += html_fact("In the plan",
                     fmt::format("{}, block {}", rows.text(0, "phase"), rows.text(0, "block")),
                     fmt::format("position {}, attempt {}", rows.text(0, "plan_position"),
                                 rows.text(0, "attempt")));
    const std::string run = rows.text(0, "run_name");
    if (!run.empty()) {
        out += html_fact("Run", run,
                         fmt::format("stimulus {}, {}", short_number(rows.text(0, "stimulus")),
                                     stimulus_text(study.protocol)));
    }
    out += html_fact(
        "Seal", seal_text(database, owner, std::stoll(rows.text(0, "trial_id"))),
        owner.seal.empty() ? "" : "computed again for this page, with all of its session");
    PageFigure figure{
        .id = "attempt", .title = "The attempt", .html = out + "</dl>\n", .data = rows};
    figure.caption = "The table has the attempt as the view analysis_trial has it.";
    page.figure(figure);
    if (!owner.seal.empty()) {
        page.html(
            fmt::format("<p class=\"from\">Seal of this trial: <code>{}</code></p>\n", owner.seal));
    }
}

/// What was felt in the trial, an entry an interval: its number and how many ticks count.
std::vector<TrialTrace> felt_intervals(Database& database, std::int64_t trial) {
    Statement felt = database.prepare(
        "SELECT interval, ticks FROM presentation WHERE trial_id = ?1 ORDER BY interval", trial);
    return felt.all([trial](const Statement& row) {
        return TrialTrace{
            .trial = trial, .interval = row.integer(0), .felt = row.integer_or_none(1)};
    });
}

PageFrame frame_of(const Study& study,
                   const Owner& owner,
                   const TrialPageOptions& options,
                   bool drawn) {
    PageFrame frame{
        .kind = owner.kind,
        .version = options.version,
        .kicker = fmt::format("Protocol {}, {} data", study.name, owner.kind),
        .title = fmt::format("Trial {}", options.trial),
        .name = fmt::format("Trial {} of {}", options.trial, study.name),
        .footer = fmt::format(
            "Made by palpate {} from {}. No day, no name{} is on this page.", options.version,
            options.codes ? study.file : "the study's database, called FILE here",
            options.codes ? "" : ", no code of a participant and no name of a file")};
    if (drawn) {
        frame.footer +=
            " Ticks are drawn by uPlot (MIT), whose licence stands in the page's source.";
        frame.style = fmt::format("{}\n{}", uplot_style(), trial_style());
        const std::string_view uplot = uplot_script();
        frame.script = fmt::format("\n/* uPlot:\n{}*/\n{}{}", uplot_licence(),
                                   uplot.substr(uplot.find('\n') + 1), trial_script());
    }
    return frame;
}

}  // namespace

std::string trial_page(Database& database, const TrialPageOptions& options) {
    const Snapshot now(database);
    const Owner owner = owner_of(database, options);
    const Study study(database, {.kind = owner.kind,
                                 .study = owner.study,
                                 .codes = options.codes,
                                 .version = options.version});
    PageWriter page(study);
    page.section("who", "Who and what");
    const Rows attempt =
        study.ask(fmt::format("{} WHERE trial_id = {}", page_query("attempt"), options.trial));
    add_facts(page, database, study, owner, attempt);

    SessionTraces traces = session_traces(database, owner.session);
    std::vector<TrialTrace> intervals = felt_intervals(database, options.trial);
    bool drawn = false;
    for (TrialTrace& one : intervals) {
        if (intervals.size() > 1) {
            one.place = fmt::format("-{}", one.interval);
            one.title = fmt::format(", interval {}", one.interval);
        }
        one.fault_cause = &one == &intervals.back() ? attempt.text(0, "fault_cause") : "";
        const TrialContext context = trial_context(database, options.trial, one.interval);
        const StoredChunks chunks = stored_chunks(database, options.trial, one.interval);
        one.scene = traces.scene_of(context.trial);
        one.ticks = traces.replay(options.trial, context.trial, chunks.views);
        page.section("felt" + one.place, "Exploration" + one.title);
        add_measures(page, study, one);
        if (one.ticks.empty()) {
            page.paragraph(fmt::format(
                "No ticks are kept of this trial{}: there is no path and no trace of it.",
                one.title));
            continue;
        }
        add_path(page, study, one);
        add_strips(page, study, one);
        drawn = true;
    }
    return page.page(frame_of(study, owner, options, drawn));
}

}  // namespace palpate::data
