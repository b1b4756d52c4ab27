#include "data/inference/audit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "data/csv/json_text.hpp"
#include "data/statistics/distributions.hpp"
#include "data/statistics/paired.hpp"
#include "data/store/analysed.hpp"

namespace palpate::data {
namespace {

using Scale = AuditScale;

constexpr AuditedQuantity kAudited[] = {
    {"start, to the right", "start_x_m", "exploration.start_x_m", Scale::place, true},
    {"start, away from the person", "start_y_m", "exploration.start_y_m", Scale::place, true},
    {"late ticks", "late_share", "exploration.late_share", Scale::share, true},
    {"saturated ticks", "saturated_share", "exploration.saturated_share", Scale::share, true},
    {"stale ticks", "stale_share", "trial.stale_ticks * 1.0 / NULLIF(trial.ticks, 0)", Scale::share,
     true},
    {"trials with a gap of the noise", "noise_gap_share",
     "EXISTS (SELECT 1 FROM event WHERE event.trial_id = exploration.trial_id AND event_kind = "
     "'masking')",
     Scale::share, true},
    {"until the first contact", "first_contact_s", "exploration.first_contact_s", Scale::ratio,
     false},
    {"until done", "done_s", "exploration.done_s", Scale::ratio, false},
    {"in contact", "contact_s", "exploration.contact_s", Scale::ratio, false},
    {"strokes", "strokes", "exploration.strokes", Scale::ratio, false},
    {"normal force, median", "normal_force_n", "exploration.normal_force_p50_n", Scale::ratio,
     false},
    {"speed, median", "speed_m_per_s", "exploration.speed_p50_m_per_s", Scale::ratio, false},
};

struct Mean {
    double sum = 0.0;
    int count = 0;
};

/// By person, then friction; of a ratio's quantity the logarithm.
using Means = std::map<std::string, std::map<std::string, Mean>>;

struct ExplorationMeans {
    std::set<std::string> studies{};
    std::map<std::string, double> frictions{};              ///< with the least static coefficient
    std::map<std::string, std::set<std::string>> people{};  ///< and their frictions
    std::vector<Means> means{std::size(kAudited)};
    LeftOut left_out{};
};

ExplorationMeans read_felt(Database& database, const AnswerChoice& choice) {
    std::string columns;
    for (const AuditedQuantity& one : kAudited) {
        columns += fmt::format(", {}", one.value);
    }
    Statement row = database.prepare(
        "SELECT exploration.study_name, iif(?3, participant_code, printf('sub-%010d', (SELECT "
        "subject FROM main.participant AS one WHERE one.participant_code = "
        "exploration.participant_code))), exploration.friction, presentation.mu_s" +
            columns +
            " FROM exploration JOIN trial USING (trial_id) JOIN presentation USING (trial_id, "
            "interval) WHERE exploration.counts AND exploration.phase = 'main' AND "
            "exploration.session_kind = ?1 AND (?2 = '' OR exploration.study_name = ?2) ORDER BY "
            "trial_id, interval",
        choice.kind, choice.study, choice.codes);
    ExplorationMeans felt;
    while (row.step()) {
        if (felt.studies.insert(row.text(0)).second) {
            felt.left_out = left_out_of(database, row.text(0), choice.kind, choice.codes);
        }
        if (felt.left_out.leaves_out(row.text(1))) {
            continue;
        }
        felt.people[row.text(1)].insert(row.text(2));
        double& least = felt.frictions.emplace(row.text(2), row.real(3)).first->second;
        least = std::min(least, row.real(3));
        for (std::size_t i = 0; i < std::size(kAudited); ++i) {
            constexpr int kNull = 5;
            const int column = 4 + static_cast<int>(i);
            const bool ratio = kAudited[i].scale == Scale::ratio;
            if (row.type(column) == kNull || (ratio && !(row.real(column) > 0.0))) {
                continue;
            }
            Mean& mean = felt.means[i][row.text(1)][row.text(2)];
            mean.sum += ratio ? std::log(row.real(column)) : row.real(column);
            ++mean.count;
        }
    }
    return felt;
}

void check_choice(const ExplorationMeans& felt, Database& database, const AnswerChoice& choice) {
    if (felt.studies.size() > 1) {
        throw std::invalid_argument(several_studies(database, felt.studies));
    }
    if (felt.frictions.empty() && !felt.left_out.broken.empty()) {
        throw std::invalid_argument(
            fmt::format("{}: everybody is left out by the protocol's rules{}", database.file(),
                        below(felt.left_out)));
    }
    if (felt.frictions.size() < 2) {
        throw std::invalid_argument(fmt::format(
            "{} has {} in answered trials of {} sessions{}: an audit compares two conditions of "
            "friction or more; --kind chooses other sessions{}",
            database.file(),
            felt.frictions.empty() ? "nothing"
                                   : "the friction " + felt.frictions.begin()->first + " alone",
            choice.kind, of_study(choice), none_left_text(database, choice.study, choice.kind)));
    }
}

std::vector<double> differences_of(const Means& means,
                                   const std::string& friction,
                                   const std::string& base) {
    std::vector<double> differences;
    for (const auto& [person, by_friction] : means) {
        const auto with = by_friction.find(friction);
        const auto without = by_friction.find(base);
        if (with != by_friction.end() && without != by_friction.end()) {
            differences.push_back(difference_of(without->second.sum / without->second.count,
                                                with->second.sum / with->second.count));
        }
    }
    return differences;
}

std::vector<AuditGap> gaps_of(const ExplorationMeans& felt) {
    std::vector<AuditGap> gaps;
    for (const auto& [friction, least] : felt.frictions) {
        AuditGap gap{.friction = friction};
        for (const auto& [person, frictions] : felt.people) {
            if (!frictions.contains(friction)) {
                gap.people.push_back(person);
            }
        }
        if (!gap.people.empty()) {
            gaps.push_back(std::move(gap));
        }
    }
    return gaps;
}

double bound_of(Scale scale, const AuditBounds& bounds) {
    return scale == Scale::place ? bounds.place_m
         : scale == Scale::share ? bounds.share
                                 : std::log(bounds.ratio);
}

std::string_view verdict_text(const std::optional<Equivalence>& found) {
    return !found                              ? "too few people"
         : found->verdict == Sameness::same    ? "the same"
         : found->verdict == Sameness::within  ? "differs, within bounds"
         : found->verdict == Sameness::differs ? "DIFFERS"
                                               : "not known: more people";
}

}  // namespace

std::optional<Equivalence> equivalence(std::span<const double> differences, double bound) {
    if (differences.size() < 2) {
        return std::nullopt;
    }
    Equivalence found{.people = differences.size()};
    const auto t = paired_t(differences);
    if (!t) {  // one value of all
        found.mean = found.low = found.high = differences.front();
        found.verdict = found.mean == 0.0             ? Sameness::same
                      : std::fabs(found.mean) < bound ? Sameness::within
                                                      : Sameness::differs;
        return found;
    }
    const double half = t_quantile(0.95, t->df) * t->sd / std::sqrt(t->df + 1.0);
    found.mean = t->mean;
    found.low = t->mean - half;
    found.high = t->mean + half;
    const bool some = t->interval.low > 0.0 || t->interval.high < 0.0;
    if (found.low > -bound && found.high < bound) {
        found.verdict = some ? Sameness::within : Sameness::same;
    } else if (some) {
        found.verdict = Sameness::differs;
    }
    return found;
}

std::span<const AuditedQuantity> audited_quantities() {
    return kAudited;
}

Audit audit_of(Database& database, const AnswerChoice& choice, const AuditBounds& bounds) {
    const Snapshot now(database);
    const ExplorationMeans felt = read_felt(database, choice);
    check_choice(felt, database, choice);
    Audit audit{.study = *felt.studies.begin(), .gaps = gaps_of(felt), .left_out = felt.left_out};
    audit.base = std::ranges::min_element(felt.frictions, {}, [](const auto& one) {
                     return std::pair(one.second, one.first);
                 })->first;
    for (const auto& [friction, least] : felt.frictions) {
        for (std::size_t i = 0; friction != audit.base && i < std::size(kAudited); ++i) {
            const auto differences = differences_of(felt.means[i], friction, audit.base);
            const double bound = bound_of(kAudited[i].scale, bounds);
            audit.lines.push_back({.quantity = &kAudited[i],
                                   .friction = friction,
                                   .people = differences.size(),
                                   .found = equivalence(differences, bound),
                                   .bound = bound});
        }
    }
    return audit;
}

Table audit_table(const Audit& audit) {
    Table table{
        .place = "quantities/-",
        .columns =
            heads({"quantity", "of", "friction|comparison", "people", "difference|difference|4",
                   "interval_90|90 % interval|4", "bound|bound|4", "unit", "verdict| "}),
        .notes = {
            "rig: nothing of it may differ; hand: what differs here, friction may have changed."}};
    for (const AuditLine& line : audit.lines) {
        const Scale scale = line.quantity->scale;
        const auto in_unit = [&](double value) {
            return scale == Scale::ratio ? std::exp(value) : value;
        };
        table.rows.push_back(
            {Named{std::string(line.quantity->name), std::string(line.quantity->title)},
             line.quantity->rig ? "rig" : "hand",
             Named{line.friction, fmt::format("{} - {}", line.friction, audit.base)},
             cell_of(line.people), line.found ? cell_of(in_unit(line.found->mean)) : Nothing{},
             line.found ? Cell(Interval{in_unit(line.found->low), in_unit(line.found->high)})
                        : Nothing{},
             in_unit(line.bound),
             scale == Scale::place   ? "m"
             : scale == Scale::ratio ? "ratio"
                                     : "share",
             std::string(verdict_text(line.found))});
    }
    return table;
}

std::string gap_text(const AuditGap& gap) {
    return fmt::format("no answer with friction {}, so no difference with it: {}", gap.friction,
                       fmt::join(gap.people, ", "));
}

std::string audit_text(Database& database, const AnswerChoice& choice, const AuditBounds& bounds) {
    const Audit audit = audit_of(database, choice, bounds);
    std::string text = fmt::format(
        "Study {}, {} data\n"
        "  Does anything but friction differ? A mean for each person and friction, differences "
        "within person.\n"
        "  The same: the 90 % interval lies within the bounds (two one-sided tests of 5 %, "
        "Schuirmann 1987).\n"
        "  Differs: the 95 % interval does not hold 0, or 1 of a ratio; where both hold it "
        "differs, within bounds.\n",
        audit.study, choice.kind);
    text += left_out_text(audit.left_out);
    for (const AuditGap& gap : audit.gaps) {
        text += "    " + gap_text(gap) + '\n';
    }
    text += table_text(audit_table(audit));
    const std::string versions = versions_text(versions_of(database));
    return versions.empty() ? text : text + '\n' + versions;
}

std::string audit_json(Database& database, const AnswerChoice& choice, const AuditBounds& bounds) {
    const Audit audit = audit_of(database, choice, bounds);
    Json all = {{"study", audit.study},
                {"kind", choice.kind},
                {"friction_less", audit.base},
                {"versions", versions_json(versions_of(database))},
                {"left_out", left_out_json(audit.left_out)},
                {"no_answer_with", Json::array()},
                {"quantities", Json::array()}};
    for (const AuditGap& gap : audit.gaps) {
        all["no_answer_with"].push_back({{"friction", gap.friction}, {"people", gap.people}});
    }
    put_table(all, audit_table(audit));
    return json_text(all) + '\n';
}

}  // namespace palpate::data
