#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/page/sections.hpp"

namespace palpate::data {
namespace {

/// Means of a person and friction that the audit compares.
std::string audit_sql() {
    std::string columns;
    for (const AuditedQuantity& one : audited_quantities()) {
        columns += one.scale == AuditScale::ratio
                     ? fmt::format(",\n       avg(ln(iif({0} > 0, {0}, NULL))) AS ln_{1}",
                                   one.value, one.name)
                     : fmt::format(",\n       avg({}) AS {}", one.value, one.name);
    }
    return fmt::format(
        "SELECT person, exploration.friction, count(*) AS intervals{}\nFROM exploration JOIN "
        "person "
        "USING (participant_code) JOIN trial USING (trial_id)\nWHERE study_name = {{study}} AND "
        "exploration.session_kind = {{kind}} AND exploration.phase = 'main' AND "
        "exploration.counts AND NOT left_out\nGROUP BY person, exploration.friction ORDER BY "
        "person, exploration.friction",
        columns);
}

const char* scale_title(AuditScale scale) {
    return scale == AuditScale::place ? "places"
         : scale == AuditScale::share ? "shares"
                                      : "the hand";
}

/// Intervals of all quantities of one scale, the bounds as broken lines.
Panel audit_panel(const Audit& audit, const std::string& friction, AuditScale scale) {
    const bool ratio = scale == AuditScale::ratio;
    const double unit = scale == AuditScale::place ? 1e3 : scale == AuditScale::share ? 100.0 : 1.0;
    const auto shown = [&](double x) {
        return ratio ? std::exp(x) : unit * x;
    };
    Panel panel{.title = fmt::format("{} against {}, {}", friction, audit.base, scale_title(scale)),
                .x = {.label = "difference",
                      .unit = scale == AuditScale::place ? "mm"
                            : scale == AuditScale::share ? "% of ticks or trials"
                                                         : "factor"},
                .y = {.label = ""}};
    double y = 0.0;
    double bound = 0.0;
    for (const AuditLine& line : audit.lines) {
        if (line.friction != friction || line.quantity->scale != scale) {
            continue;
        }
        bound = line.bound;
        panel.y.names.emplace_back(-y, std::string(line.quantity->title));
        if (line.found) {
            const Ink ink = line.found->bounded()                    ? Ink::blue
                          : line.found->verdict == Sameness::differs ? Ink::vermillion
                                                                     : Ink::grey;
            panel.series.push_back(
                interval_bar(shown(line.found->low), -y, shown(line.found->high), -y, ink));
            panel.series.push_back(
                {.x = {shown(line.found->mean)}, .y = {-y}, .ink = ink, .mark = Mark::points});
        }
        y += 1.0;
    }
    for (const double at : {-bound, bound}) {
        panel.series.push_back({.x = {shown(at), shown(at)},
                                .y = {0.5, 0.5 - y},
                                .ink = Ink::black,
                                .stroke = Stroke::dashed,
                                .width = 1.0});
    }
    panel.y.low = 0.5 - y;
    panel.y.high = 0.5;
    panel.height = std::max(60.0, 26.0 * y);
    return panel;
}

/// Every quantity that is not the same, by its verdict in the audit.
/// @param several  comparisons: each is named
void add_verdicts(PageWriter& page, const Audit& audit, bool several) {
    std::array<std::size_t, 2> all{};  // of the hand, of the rig
    std::array<std::size_t, 2> same{};
    std::array<std::vector<std::string>, 4> others;
    for (const AuditLine& line : audit.lines) {
        const Sameness verdict = line.found ? line.found->verdict : Sameness::open;
        const std::size_t rig = line.quantity->rig ? 1 : 0;
        ++all.at(rig);
        if (verdict == Sameness::same) {
            ++same.at(rig);
            continue;
        }
        const std::size_t place = verdict == Sameness::differs ? 0
                                : verdict == Sameness::within  ? 1
                                : line.found                   ? 2
                                                               : 3;
        others.at(place).push_back(fmt::format(
            "{} ({}{})", line.quantity->title, rig == 1 ? "rig" : "hand",
            several ? fmt::format(", {} - {}", line.friction, audit.base) : std::string()));
    }
    page.paragraph(fmt::format(
        "{} of {} quantities of the rig and {} of {} of the hand are the same within their bounds.",
        same[1], all[1], same[0], all[0]));
    constexpr std::array kWords{"DIFFERS", "Differs, within bounds", "Not known, more people",
                                "Not known, too few people"};
    for (std::size_t i = 0; i < others.size(); ++i) {
        if (!others.at(i).empty()) {
            page.paragraph(fmt::format("{}: {}.", kWords.at(i), fmt::join(others.at(i), "; ")));
        }
    }
}

}  // namespace

void add_audit(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    page.section("audit", "Does anything but friction differ?");
    if (!numbers.audit) {
        page.paragraph(study.nobody_left()
                           ? "Everybody is left out by the protocol's rules: nothing is compared."
                           : "There are not two conditions of friction to compare.");
        return;
    }
    const Audit& audit = *numbers.audit;
    PageFigure figure{.id = "audit-figure",
                      .title = "Rig and hand between the conditions of friction",
                      .width = 430.0,
                      .data = study.ask(audit_sql())};
    std::vector<std::string> frictions;
    for (const AuditLine& line : audit.lines) {
        if (std::ranges::find(frictions, line.friction) == frictions.end()) {
            frictions.push_back(line.friction);
        }
    }
    for (const std::string& friction : frictions) {
        for (const AuditScale scale : {AuditScale::place, AuditScale::share, AuditScale::ratio}) {
            figure.panels.push_back(audit_panel(audit, friction, scale));
        }
    }
    figure.caption =
        "Differences within person with 90 % intervals; broken lines: bounds chosen beforehand. "
        "The same: the interval lies between them (two one-sided tests of 5 %, Schuirmann 1987; "
        "blue). Differs: the 95 % interval does not hold no difference (vermillion). Else more "
        "people are needed (grey). What the hand does may follow from friction. Answers that "
        "count, exclusions applied.";
    figure.results.push_back({.table = audit_table(*numbers.audit),
                              .command = numbers.audit_words,
                              .caption = "Each quantity, its 90 % interval and its bound"});
    add_verdicts(page, audit, frictions.size() > 1);
    for (const AuditGap& gap : audit.gaps) {
        page.paragraph(fmt::format("There is {}.", gap_text(gap)));
    }
    page.figure(figure);
}

void add_health(PageWriter& page, const Study& study) {
    page.section("health", "Servo and safety");
    PageFigure figure{.id = "servo",
                      .title = "How well the rig kept up",
                      .data = study.ask(page_query("health"))};
    const Rows& rows = figure.data;
    for (const auto& [name, title] :
         {std::pair{"late_share", "late ticks"}, std::pair{"saturated_share", "saturated ticks"}}) {
        Panel panel{.title = title,
                    .x = {.label = "share of ticks", .unit = "%", .low = 0.0},
                    .y = {.label = "person (session)"},
                    .height = std::max(80.0, 15.0 * static_cast<double>(rows.cells.size()))};
        Series dots{.ink = Ink::blue, .mark = Mark::points};
        double max = 0.1;
        for (std::size_t row = 0; row < rows.cells.size(); ++row) {
            const double y = -static_cast<double>(row);
            dots.add(100.0 * rows.number(row, name), y);
            max = std::isfinite(dots.x.back()) ? std::max(max, 1.08 * dots.x.back()) : max;
            panel.y.names.emplace_back(y, fmt::format("{} ({})", rows.text(row, "person"),
                                                      rows.text(row, "session_number")));
        }
        panel.x.high = max;
        panel.y.low = 0.4 - static_cast<double>(rows.cells.size());
        panel.y.high = 0.6;
        panel.series.push_back(std::move(dots));
        figure.panels.push_back(std::move(panel));
    }
    figure.caption = fmt::format(
        "Of all attempts, practice too. Late: woke more than half a period late. Saturated: the "
        "device could not give the force. {:.1f} min were felt in all; {} lost on their way to the "
        "disk; the force went off by itself in {}.",
        rows.sum("felt_s") / 60.0,
        counted(static_cast<std::int64_t>(rows.sum("lost_ticks")), "tick was", "ticks were"),
        counted(static_cast<std::int64_t>(rows.sum("faulted")), "trial"));
    page.figure(figure);
    const Rows devices = study.ask(page_query("devices"));
    if (!devices.cells.empty()) {
        page.table("devices", "CAUTION: sessions felt on more than one device or calibration",
                   "One row a device of a session, in the order in which they came. A device "
                   "without a calibration is a simulated one or a pointer. Their names are in the "
                   "file, trial by trial: analysis_trial.device.",
                   devices);
    }
    const Rows causes = study.ask(page_query("faults"));
    if (!causes.cells.empty()) {
        page.table("faults", "Why the force went off",
                   "What each cause means and what to do is in docs/safety.md.", causes);
    }
}

}  // namespace palpate::data
