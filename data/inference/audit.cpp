#include "data/inference/audit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include "data/statistics/paired.hpp"
#include "data/store/analysed.hpp"

namespace palpate::data {
namespace {

using Scale = AuditScale;

constexpr AuditedQuantity kAudited[] = {
    {"start, to the right, mm", "start_x_m", "exploration.start_x_m", Scale::place, true},
    {"start, away from the person, mm", "start_y_m", "exploration.start_y_m", Scale::place, true},
    {"late ticks, share", "late_share", "exploration.late_share", Scale::share, true},
    {"saturated ticks, share", "saturated_share", "exploration.saturated_share", Scale::share,
     true},
    {"stale ticks, share", "stale_share", "trial.stale_ticks * 1.0 / NULLIF(trial.ticks, 0)",
     Scale::share, true},
    {"trials with a gap of the noise, share", "noise_gap_share",
     "EXISTS (SELECT 1 FROM event WHERE event.trial_id = exploration.trial_id AND event_kind = "
     "'masking')",
     Scale::share, true},
    {"until the first contact", "first_contact_s", "exploration.first_contact_s", Scale::ratio,
     false},
    {"exploration", "exploration_s", "exploration.done_s", Scale::ratio, false},
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
    std::map<std::string, double> frictions{};  ///< with the least static coefficient
    std::vector<Means> means{std::size(kAudited)};
    LeftOut left_out{};
};

ExplorationMeans read_felt(Database& database, const TrialChoice& choice) {
    std::string columns;
    for (const AuditedQuantity& one : kAudited) {
        columns += fmt::format(", {}", one.value);
    }
    Statement row = database.prepare(
        "SELECT exploration.study_name, exploration.participant_code, exploration.friction, "
        "presentation.mu_s" +
        columns +
        " FROM exploration JOIN trial USING (trial_id) JOIN presentation USING (trial_id, "
        "interval) "
        "WHERE exploration.counts AND exploration.phase = 'main' AND exploration.session_kind = ?1 "
        "AND (?2 = '' OR exploration.study_name = ?2) ORDER BY trial_id, interval");
    row.bind(1, choice.kind).bind(2, choice.study);
    ExplorationMeans felt;
    while (row.step()) {
        if (felt.studies.insert(row.text(0)).second) {
            felt.left_out = left_out_of(database, row.text(0), choice.kind, true);
        }
        if (felt.left_out.leaves_out(row.text(1))) {
            continue;
        }
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

void check_choice(const ExplorationMeans& felt, Database& database, const TrialChoice& choice) {
    if (felt.studies.size() > 1) {
        throw std::invalid_argument(several_studies(database, felt.studies));
    }
    if (felt.frictions.size() < 2) {
        throw std::invalid_argument(fmt::format(
            "{} has {} in answered trials of {} sessions: an audit compares two conditions of "
            "friction or more; --kind chooses other sessions{}",
            database.file(),
            felt.frictions.empty() ? "nothing"
                                   : "the friction " + felt.frictions.begin()->first + " alone",
            choice.kind, none_left_text(database, choice.study, choice.kind)));
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
            differences.push_back(with->second.sum / with->second.count -
                                  without->second.sum / without->second.count);
        }
    }
    return differences;
}

std::string line_of(const Equivalence& found, double bound, Scale scale) {
    const double unit = scale == Scale::place ? 1e3 : 1.0;
    const auto number = [&](double x) {
        return scale == Scale::ratio ? fmt::format("x {:.3f}", std::exp(x))
                                     : fmt::format("{:+.4f}", unit * x);
    };
    const std::string within = scale == Scale::ratio ? fmt::format("x {:g}", std::exp(bound))
                                                     : fmt::format("{:g}", unit * bound);
    return fmt::format("{:>6}  {:>10}  {:>9} to {:<9}  {:>7}  {}", found.people, number(found.mean),
                       number(found.low), number(found.high), within, verdict_text(found));
}

double bound_of(Scale scale, const AuditBounds& bounds) {
    switch (scale) {
        case Scale::place:
            return bounds.place_m;
        case Scale::share:
            return bounds.share;
        case Scale::ratio:
            break;
    }
    return std::log(bounds.ratio);
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
    const boost::math::students_t over_people(t->df);
    const double half = boost::math::quantile(over_people, 0.95) * t->sd / std::sqrt(t->df + 1.0);
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

std::string_view verdict_text(const std::optional<Equivalence>& found) {
    return !found                              ? "too few people"
         : found->verdict == Sameness::same    ? "the same"
         : found->verdict == Sameness::within  ? "differs, within bounds"
         : found->verdict == Sameness::differs ? "DIFFERS"
                                               : "not known: more people";
}

Audit audit_of(Database& database, const TrialChoice& choice, const AuditBounds& bounds) {
    const Snapshot now(database);
    const ExplorationMeans felt = read_felt(database, choice);
    check_choice(felt, database, choice);
    Audit audit{.study = *felt.studies.begin()};
    audit.left_out = left_out_of(database, audit.study, choice.kind, choice.codes);
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

std::string audit_text(Database& database, const TrialChoice& choice, const AuditBounds& bounds) {
    const Audit audit = audit_of(database, choice, bounds);
    std::string text = fmt::format(
        "Study {}, {} data\n"
        "  Does anything but friction differ? A mean for each person and friction, differences "
        "within person.\n"
        "  The same: the 90 % interval lies within the bounds (two one-sided tests of 5 %, "
        "Schuirmann 1987).\n"
        "  Differs: the 95 % interval does not hold 0, or 1 of a ratio; where both hold it "
        "differs, "
        "within bounds.\n",
        audit.study, choice.kind);
    text += left_out_text(audit.left_out);
    const AuditLine* before = nullptr;
    for (const AuditLine& line : audit.lines) {
        const bool other = before == nullptr || before->friction != line.friction;
        if (other) {
            text += fmt::format("\n  {:<40}{:>6}  {:>10}  {:>9}{:<13}  {:>7}\n",
                                fmt::format("{} against {}", line.friction, audit.base), "people",
                                "difference", "90 %", " interval", "bounds");
        }
        if (other || before->quantity->rig != line.quantity->rig) {
            text += line.quantity->rig
                      ? "  The rig: nothing of it may differ\n"
                      : "  The hand: what differs here, friction may have changed\n";
        }
        text += fmt::format("    {:<38}{}\n", line.quantity->title,
                            line.found ? line_of(*line.found, line.bound, line.quantity->scale)
                                       : fmt::format("{:>6}  {}", line.people, verdict_text({})));
        before = &line;
    }
    const std::string versions = versions_text(versions_of(database));
    return versions.empty() ? text : text + '\n' + versions;
}

}  // namespace palpate::data
