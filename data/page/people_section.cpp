#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "data/inference/stats_report.hpp"
#include "data/page/sections.hpp"

namespace palpate::data {
namespace {

std::int64_t sum_of(const Rows& rows, std::string_view name) {
    return static_cast<std::int64_t>(rows.sum(name));
}

std::string step(std::int64_t count,
                 const std::string& what,
                 const std::vector<std::string>& gone = {}) {
    std::string out = fmt::format("<li><b>{}</b> {}", count, html_text(what));
    for (const std::string& one : gone) {
        out += fmt::format("<span class=\"gone\">{}</span>", html_text(one));
    }
    return out + "</li>\n";
}

/// "3 faulted" where there are some.
void add_gone(std::vector<std::string>& gone, std::int64_t count, const std::string& what) {
    if (count > 0) {
        gone.push_back(fmt::format("less {}: {}", count, what));
    }
}

std::string flow_html(const Study& study, const Rows& rows) {
    const LeftOut& account = study.left_out;
    std::vector<std::string> unseen;
    add_gone(unseen, account.no_consent.people, "noted as not consenting");
    add_gone(unseen, account.withdrawn.people, "all of whose sessions were withdrawn");
    std::vector<std::string> left;
    for (const auto& [person, why] : whys_of(account)) {
        left.push_back(fmt::format("less person {}: {}", person, why));
    }
    if (left.empty()) {
        left.emplace_back("nobody is left out by a rule of the protocol");
    }
    add_gone(left, account.no_answer, "without an answer that counts");
    std::vector<std::string> lost;
    add_gone(lost, sum_of(rows, "faulted"), "the force went off by itself");
    add_gone(lost, sum_of(rows, "unanswered"), "nobody answered in time");
    add_gone(lost, sum_of(rows, "aborted"), "ended by the experimenter");
    add_gone(lost, sum_of(rows, "broken_off"), "broken off");
    std::vector<std::string> invalid;
    add_gone(invalid, sum_of(rows, "invalid"), "do not count by the protocol's rules for a trial");
    add_gone(invalid, sum_of(rows, "marked"), "marked by somebody");
    std::vector<std::string> of_left;
    add_gone(of_left, sum_of(rows, "counting") - sum_of(rows, "analysed"),
             "answers of people left out");
    std::string out = "<div class=\"flow\">\n<div>\n<h4>People</h4>\n<ol>\n";
    out += step(account.in_file.people,
                fmt::format("with a {} session of the study", study.options.kind), unseen);
    out += step(account.in_file.people - account.no_consent.people - account.withdrawn.people,
                "whose answers may be looked at", left);
    out += step(account.analysed.people, "analysed, exclusions applied");
    out += "</ol>\n</div>\n<div>\n<h4>Their main trials</h4>\n<ol>\n";
    out += step(sum_of(rows, "planned"), "planned");
    out += step(sum_of(rows, "attempts"), "attempts: what does not count is run again", lost);
    out += step(sum_of(rows, "answered"), "answered", invalid);
    out += step(sum_of(rows, "counting"), "count", of_left);
    out += step(sum_of(rows, "analysed"), "analysed, exclusions applied");
    out += "</ol>\n</div>\n</div>\n";
    const auto answered = sum_of(rows, "answered");
    return answered == sum_of(rows, "analysed")
             ? out + "<p>Nothing was excluded: every answer is analysed.</p>\n"
             : out + fmt::format("<p>Exclusions not applied: {} answers of {}.</p>\n", answered,
                                 counted(std::ranges::count_if(rows.numbers("answered"),
                                                               [](double n) { return n > 0.0; }),
                                         "person", "people"));
}

/// Share correct with exclusions applied and not.
Results both_ways(const PageNumbers& numbers) {
    Results results{.table = {.columns = heads({"exclusions|", "comparison|", "people|", "answers|",
                                                "difference_in_share|", "interval_95|", "t_p|",
                                                "sign_flip_p|", "wilcoxon_p|", "mixed_model_p|"})},
                    .command = numbers.stats_words,
                    .caption =
                        "The effect of friction, exclusions applied and not; the primary "
                        "test, as the protocol says: " +
                        primary_title(*numbers.stats)};
    const StatsReport& stats = *numbers.stats;
    const auto add = [&](const char* word, const StatsPart& part) {
        const Measure* share = find_measure(part, "share");
        for (std::size_t f = 1; share != nullptr && f < stats.table.frictions.size(); ++f) {
            if (const auto& effect = share->effects[f]) {
                const auto mixed = std::ranges::find(part.mixed, f, &MixedStats::friction);
                results.table.rows.push_back(
                    {word, comparison_text(stats, f), cell_of(effect->values.size()),
                     cell_of(part.trials), cell_of(effect->mean.mean),
                     cell_of(effect->mean.interval),
                     effect->t ? Cell(effect->t->p) : Cell(Nothing{}), effect->flip.p,
                     effect->rank.p,
                     mixed == part.mixed.end() ? Cell(Nothing{}) : Cell(no_effect_p(*mixed))});
            }
        }
    };
    add("applied", stats.applied);
    add("not applied", stats.not_applied ? *stats.not_applied : stats.applied);
    return results;
}

/// The cells of palpate stats' own table, rounded: the page computes no test.
std::string primary_facts(const StatsReport& stats) {
    std::string out;
    for (const auto& row : primary_table(stats, stats.applied).rows) {
        const Named name = std::get<Named>(row[0]);
        const auto* none = std::get_if<Nothing>(&row[1]);
        const auto* estimate = std::get_if<double>(&row[1]);
        const auto* ends = std::get_if<Interval>(&row[2]);
        const auto* p = std::get_if<double>(&row[4]);
        const auto* no_p = std::get_if<Nothing>(&row[4]);
        out += html_fact(
            fmt::format("{}, {}", name.shown,
                        name.key == stats.table.primary_friction ? "primary test"
                                                                 : "not the primary comparison"),
            estimate != nullptr ? replaced(fmt::format("{:+.3f}", *estimate), "-", "\u2212")
                                : none->why,
            fmt::format("{}{}{}", ends != nullptr ? "95 % " + interval_text(*ends) + "; " : "",
                        p == nullptr ? no_p->why.empty() ? "" : no_p->why + "; "
                        : *p < 0.001 ? "p < 0.001; "
                                     : fmt::format("p = {:.3f}; ", *p),
                        primary_title(stats)));
    }
    return out;
}

}  // namespace

void add_facts(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    std::string out = "<dl class=\"facts\">\n";
    out += html_fact(
        "People", fmt::format("{}", study.people),
        fmt::format("{} left out by the protocol's rules", study.left_out.by_rule.people));
    if (numbers.stats) {
        const StatsReport& stats = *numbers.stats;
        out += html_fact("Answers analysed", fmt::format("{}", stats.applied.trials),
                         fmt::format("of {}; exclusions applied", stats.table.trials.size()));
        const Measure* share = find_measure(stats.applied, "share");
        for (std::size_t f = 0; share != nullptr && f < share->means.size(); ++f) {
            const std::string& friction = stats.table.frictions[f];
            if (const auto& mean = share->means[f]) {
                out += html_fact(fmt::format("{}, friction {}", share->title, friction),
                                 fmt::format("{:.3f}", mean->mean),
                                 mean->interval ? "95 % " + interval_text(*mean->interval)
                                                : "no interval: one value");
            }
        }
        out += primary_facts(stats);
    }
    if (numbers.fit) {
        for (const OverPeople& one : numbers.fit->people) {
            out += html_fact(
                one.what,
                one.mean.people > 0 ? replaced(fmt::format("{:.4g}", one.mean.mean), "-", "\u2212")
                                    : "none",
                fmt::format("mean of {}{}{}", counted(one.mean.people, "person", "people"),
                            one.mean.interval ? "; 95 % " + interval_text(*one.mean.interval)
                                              : std::string(),
                            one.left_out.empty()
                                ? std::string()
                                : fmt::format("; {} left out", one.left_out.size())));
        }
    }
    page.html(out + "</dl>\n");
}

void add_flow(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    page.section("people", "Participants and exclusions");
    if (!study.versions.empty()) {
        std::string versions;
        for (const StudyVersion& one : study.versions) {
            versions += fmt::format("{}{} by {} ({})", versions.empty() ? "" : ", ",
                                    one.study + (one.study.find('@') == std::string::npos
                                                     ? '@' + one.protocol_sha256.substr(0, 8)
                                                     : ""),
                                    counted(one.people, "person", "people"), one.kind);
        }
        page.paragraph(
            fmt::format("The file holds several versions of a protocol: {}. {}", versions,
                        study.seen == " --versions together"
                            ? "CAUTION: this page takes them as one."
                            : "They are kept apart: this page is of " + study.name + " alone."));
    }
    PageFigure flow{.id = "flow",
                    .title = "From planned trials to analysed answers",
                    .caption =
                        "Each box less what stands beside it gives the next. Rules are those of "
                        "the protocol, written before anybody ran.",
                    .data = study.ask(page_query("flow"))};
    flow.html = flow_html(study, flow.data);
    if (numbers.stats) {
        flow.results.push_back(both_ways(numbers));
    }
    page.figure(flow);
    LeftOut named = study.left_out;
    for (auto* reasons : {&named.broken, &named.withdrawals}) {
        for (LeftOut::Reason& one : *reasons) {
            one.person = fmt::format("person {}:", one.person);
        }
    }
    const std::string account = replaced(html_text(left_out_text(named)), "\n  ", "<br>  ");
    page.html(fmt::format("<p class=\"account\" data-left-out=\"{}\">{}</p>\n",
                          html_text(json_text(left_out_json(study.left_out))), account));
    page.paragraph(study.options.codes
                       ? "People are called by the laboratory's codes, as was asked for: this page "
                         "is not for strangers."
                       : "People are numbered for this page, from 1; the column subject is their "
                         "name in exports and in palpate stats. Numbers are no codes of the "
                         "laboratory, and follow neither their order nor that of the sessions.");
}

std::vector<std::string> frictions_of(const Study& study) {
    std::vector<protocols::FrictionSpec> all = study.protocol.frictions;
    std::ranges::stable_sort(all, {}, &protocols::FrictionSpec::mu_s);
    std::vector<std::string> names;
    for (const auto& one : all) {
        names.push_back(one.name);
    }
    // Of versions that are taken together an older one may have others.
    for (const std::string& name :
         study.ask("SELECT DISTINCT friction FROM main").levels("friction")) {
        if (std::ranges::find(names, name) == names.end()) {
            names.push_back(name);
        }
    }
    return names;
}

const Measure* find_measure(const StatsPart& part, std::string_view key) {
    const auto found = std::ranges::find(part.measures, key, &Measure::key);
    return found == part.measures.end() ? nullptr : &*found;
}

PairedPanel pairs_of(const Measure& measure, const std::vector<std::string>& frictions) {
    PairedPanel all{.title = measure.title,
                    .label = measure.title,
                    .frictions = frictions,
                    .means = measure.means};
    for (const auto& row : measure.values) {
        auto& mine = all.people.emplace_back();
        for (const auto& value : row) {
            mine.push_back(value.value_or(std::nan("")));
        }
    }
    return all;
}

PairedPanel pairs_of(const Rows& rows,
                     std::string_view column,
                     const std::vector<std::string>& frictions,
                     Scale scale,
                     std::string_view felt,
                     double factor) {
    std::map<std::pair<bool, std::string>, std::vector<double>> people;  // left out or not
    for (std::size_t row = 0; row < rows.cells.size(); ++row) {
        const auto found = std::ranges::find(frictions, rows.text(row, "friction"));
        if (found != frictions.end() && (felt.empty() || rows.text(row, "felt") == felt)) {
            auto& mine = people[{rows.number(row, "left_out") != 0.0, rows.text(row, "person")}];
            mine.resize(frictions.size(), std::nan(""));
            mine[static_cast<std::size_t>(found - frictions.begin())] =
                factor * rows.number(row, column);
        }
    }
    PairedPanel all{.frictions = frictions};
    for (const auto& [person, mine] : people) {
        (person.first ? all.left_out : all.people).push_back(mine);
    }
    for (std::size_t f = 0; f < frictions.size(); ++f) {
        std::vector<double> values;
        for (const auto& mine : all.people) {
            if (std::isfinite(mine[f])) {
                values.push_back(scale == Scale::logarithms ? std::log(mine[f]) : mine[f]);
            }
        }
        auto& mean = all.means.emplace_back();
        if (!values.empty()) {
            mean = mean_over_people(values);
        }
        if (mean && scale == Scale::logarithms) {  // on the scale of the page
            mean->mean = std::exp(mean->mean);
            if (auto& ends = mean->interval) {
                ends = Interval{std::exp(ends->low), std::exp(ends->high)};
            }
        }
    }
    return all;
}

Panel paired_panel(const PairedPanel& what) {
    const double width = static_cast<double>(what.frictions.size());
    Panel panel{.title = what.title,
                .x = {.label = "friction", .low = -0.5, .high = width - 0.5},
                .y = {.label = what.label, .unit = what.unit},
                .height = what.height};
    for (std::size_t f = 0; f < what.frictions.size(); ++f) {
        panel.x.names.emplace_back(static_cast<double>(f), what.frictions[f]);
    }
    const auto lines = [&](const std::vector<std::vector<double>>& people, Stroke stroke,
                           const char* name) {
        for (const auto& values : people) {
            Series one{
                .name = name, .ink = Ink::grey, .stroke = stroke, .mark = Mark::both, .width = 1.0};
            for (std::size_t f = 0; f < values.size(); ++f) {
                one.add(static_cast<double>(f), values[f]);
            }
            one.sizes.assign(values.size(), 2.5);
            one.opacity = 0.7;
            panel.series.push_back(std::move(one));
        }
    };
    lines(what.left_out, Stroke::dashed, "");
    lines(what.people, Stroke::solid, "");
    for (std::size_t f = 0; f < what.means.size(); ++f) {
        if (const auto& mean = what.means[f]) {
            const double x =
                static_cast<double>(f) + (2 * f + 1 > what.means.size() ? 0.16 : -0.16);
            panel.series.push_back(
                {.x = {x}, .y = {mean->mean}, .ink = ink_of(f), .mark = Mark::points});
            panel.series.back().sizes = {4.5};
            if (mean->interval) {
                const auto [low, high] = *mean->interval;
                panel.series.push_back(interval_bar(x, low, x, high, ink_of(f)));
            }
        }
    }
    return panel;
}

}  // namespace palpate::data
