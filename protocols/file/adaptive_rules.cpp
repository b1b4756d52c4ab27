#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/contact/closest_point.hpp"
#include "engine/deformation/soft_shape.hpp"
#include "stimuli/two_curve.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/procedure_file.hpp"
#include "protocols/file/rules.hpp"
#include "protocols/file/table_schema.hpp"
#include "protocols/procedure/procedure.hpp"

namespace palpate::protocols {
namespace {

constexpr std::array<std::string_view, 7> kTablesOfRules{"constant", "staircase",  "quest", "model",
                                                         "stimuli",  "parameters", "prior"};
/// As [[friction]] has it.
constexpr double kMaxMu = 10.0;

template <class Spec>
const Spec* named(const std::vector<Spec>& specs, std::string_view name) {
    const auto found = std::ranges::find(specs, name, &Spec::name);
    return found == specs.end() ? nullptr : &*found;
}

/// What to say instead of a name that nobody has.
template <class Spec>
std::string one_of(std::string_view unknown, const std::vector<Spec>& specs) {
    std::vector<std::string_view> names;
    std::ranges::transform(specs, std::back_inserter(names), &Spec::name);
    return suggestion(unknown, names, fmt::format(": give {}", fmt::join(names, " or ")));
}

/// What the standard interval has of what the rule varies, in the rule's unit.
double standard_of(Varies varies, const FrictionSpec& friction, const ObjectSpec& object) {
    return varies == Varies::mu         ? friction.mu_s
         : varies == Varies::compliance ? 1e3 * object.compliance
                                        : object.curvature;
}

class AdaptiveRules : RuleCheck {
public:
    AdaptiveRules(const Protocol& protocol, const Places& places, Problems& problems)
        : RuleCheck(protocol, places, problems), spec_(*protocol.procedure) {}

    void check() {
        add_if(named(protocol_.objects, spec_.object) == nullptr, "procedure.object",
               "object is \"{}\", which no [[object]] is called{}", spec_.object,
               one_of(spec_.object, protocol_.objects));
        runs();
        answers();
        design();
        switch (spec_.varies) {
            case Varies::curvature:
                curvatures();
                break;
            case Varies::mu:
                frictions();
                break;
            case Varies::compliance:
                compliances();
        }
        practice();
        standards();
    }

private:
    void runs() {
        add_if(protocol_.runs.empty() || protocol_.runs.size() > kMaxRuns, "run",
               "there are {} runs: give 1 to {} [[run]] tables", protocol_.runs.size(), kMaxRuns);
        std::set<std::string_view> seen;
        for (std::size_t i = 0; i < protocol_.runs.size(); ++i) {
            const RunSpec& run = protocol_.runs[i];
            const std::string path = fmt::format("run.{}.", i + 1);
            add_if(!seen.insert(run.name).second, path + "name",
                   "name is \"{}\", as in an earlier [[run]]: give every run a name of its own",
                   run.name);
            friction(path + "friction", "friction", run.friction);
            if (!run.standard_friction.empty()) {
                friction(path + "standard_friction", "standard_friction", run.standard_friction);
                add_if(intervals_of(protocol_) == 1, path + "standard_friction",
                       "standard_friction is given, but answers of kind \"{}\" follow one "
                       "interval: delete it, or give kind \"two_interval\"",
                       word_of(protocol_.response.kind));
            }
        }
    }

    void friction(const std::string& path, std::string_view key, const std::string& name) {
        add_if(named(protocol_.frictions, name) == nullptr, path,
               "{} is \"{}\", which no [[friction]] is called{}", key, name,
               one_of(name, protocol_.frictions));
    }

    void answers() {
        const std::size_t answers = answers_of(protocol_);
        add_if(spec_.outcomes != answers, "procedure.kind",
               "the rule knows {} outcomes, and answers of kind \"{}\" have {}: give another rule "
               "or another kind",
               spec_.outcomes, word_of(protocol_.response.kind), answers);
    }

    void design() {
        const std::size_t trials = spec_.practice_trials + spec_.trials * protocol_.runs.size();
        add_if(trials > kMaxTrials, "procedure.kind",
               "the session has {} trials: ask for {} or fewer", trials, kMaxTrials);
    }

    /// Why there can be no object of this curvature, 1/m; empty: there can.
    [[nodiscard]] std::string why_not(double curvature) const {
        const stimuli::TwoCurve curves{.a = protocol_.outline.a,
                                       .vertex = protocol_.outline.vertex,
                                       .b = protocol_.outline.b,
                                       .curvature = curvature};
        const double chord =
            std::max(glm::length(curves.vertex - curves.a), glm::length(curves.b - curves.vertex));
        if (!(std::fabs(curvature) * chord / 2.0 < kMaxHalfSine)) {
            return fmt::format("stay below {:.1f} either way", 2.0 * kMaxHalfSine / chord);
        }
        try {
            const auto outline = stimuli::make_outline(curves);
            const bool inside =
                engine::OutlineFeet(*outline).closest(protocol_.apparatus.start).inside;
            return inside ? "start_mm is inside of it" : "";
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
    }

    void curvatures() {
        if (protocol_.surface) {
            return;  // said with the objects
        }
        if (add_if(!differ_in_curvature_alone(protocol_), "procedure.varies",
                   "varies is \"curvature_per_m\", and an object has a form of its own, a size, a "
                   "turn or an offset: give objects a curvature_per_m alone")) {
            return;
        }
        for (const ObjectSpec& object : extreme_objects(protocol_)) {
            const std::string why = why_not(object.curvature);
            if (add_if(!why.empty(),
                       object.curvature == felt_value(spec_, spec_.lowest) ? lowest() : highest(),
                       "the rule may choose a curvature of {} 1/m, and there is no such object: "
                       "{}; narrow the stimuli, or lowest and highest",
                       object.curvature, why)) {
                return;
            }
        }
    }

    void frictions() {
        const double lowest = felt_value(spec_, spec_.lowest);
        const double highest = felt_value(spec_, spec_.highest);
        add_if(!(lowest > 0.0 && highest <= kMaxMu),
               lowest > 0.0 ? this->highest() : this->lowest(),
               "the rule may choose mu_s from {} to {}: keep it above 0 and at most {}, by the "
               "stimuli, or lowest and highest",
               lowest, highest, kMaxMu);
        for (std::size_t i = 0; i < protocol_.runs.size(); ++i) {
            const FrictionSpec* base = named(protocol_.frictions, protocol_.runs[i].friction);
            if (base != nullptr) {
                add_if(!(base->mu_s > 0.0), fmt::format("run.{}.friction", i + 1),
                       "friction is \"{}\", which is {} with mu_s = {}: the rule varies mu_s; name "
                       "one that rubs, for instance with law \"gos\"",
                       base->name, base->law, base->mu_s);
            }
        }
    }

    void compliances() {
        constexpr double kMax = 1e3 * engine::kMaxCompliance;
        const double lowest = felt_value(spec_, spec_.lowest);
        const double highest = felt_value(spec_, spec_.highest);
        add_if(!(lowest >= 0.0 && highest <= kMax),
               lowest >= 0.0 ? this->highest() : this->lowest(),
               "the rule may choose a compliance from {:.6g} to {:.6g} mm/N: keep it within 0 and "
               "{}, by the stimuli, or lowest and highest",
               lowest, highest, kMax);
        const ObjectSpec* base = named(protocol_.objects, spec_.object);
        if (base != nullptr) {
            add_if(!base->segments.empty(), "procedure.object",
                   "object is \"{}\", a free form: a compliance is of two curves, give an object "
                   "with curvature_per_m",
                   base->name);
        }
    }

    void practice() {
        const double x = spec_.practice_stimulus;
        add_if(spec_.practice_trials > 0 && !(x >= spec_.lowest && x <= spec_.highest),
               "procedure.practice_stimulus",
               "practice_stimulus is {}: give what the rule might choose, {} to {}", x,
               spec_.lowest, spec_.highest);
    }

    /// Of two intervals the greater one is asked for: a rule that takes the comparison for it must
    /// not choose the standard, or less.
    void standards() {
        if (intervals_of(protocol_) != 2 || !spec_.one_sided) {
            return;
        }
        const bool of_mu = spec_.varies == Varies::mu;
        const double least = felt_value(spec_, spec_.lowest);
        for (const RunSpec& run : protocol_.runs) {
            const bool same =
                run.standard_friction.empty() || run.standard_friction == run.friction;
            const FrictionSpec* friction =
                named(protocol_.frictions, same ? run.friction : run.standard_friction);
            const ObjectSpec* object = named(protocol_.objects, spec_.object);
            if (friction == nullptr || object == nullptr || !(of_mu || same)) {
                continue;  // said already; or another friction may move what is felt as equal
            }
            const double standard = standard_of(spec_.varies, *friction, *object);
            if (add_if(!(least > standard), lowest(),
                       "the rule may choose a {} of {}, and that of the standard is {}: it would "
                       "take a right answer for a wrong one; keep it above the standard, by lowest",
                       of_mu                                ? "mu_s"
                       : spec_.varies == Varies::compliance ? "compliance"
                                                            : "curvature",
                       least, standard)) {
                return;
            }
        }
    }

    [[nodiscard]] const std::string& lowest() const { return spec_.lowest_key; }
    [[nodiscard]] const std::string& highest() const { return spec_.highest_key; }

    const AdaptiveSpec& spec_;
};

}  // namespace

void read_adaptive(const Entry& entry, Problems& problems, Places& places, Protocol& protocol) {
    const auto* given = std::get_if<Table>(&entry.value.data);
    if (given == nullptr) {
        problems.add(entry.at, fmt::format("procedure is {}: write it as a table, [procedure]",
                                           shown(entry.value)));
        return;
    }
    // It holds keys of the study, keys of the rule and tables of the rule.
    Table own, of_rule, file;
    const auto keys = names_of(procedure_keys("procedure"));
    for (const Entry& one : *given) {
        const bool table = std::ranges::find(kTablesOfRules, one.key) != kTablesOfRules.end();
        const bool key = std::ranges::find(keys, one.key) != keys.end();
        (table ? file : key ? of_rule : own).push_back(one);
    }
    AdaptiveSpec& spec = protocol.procedure.emplace();
    TableReader reader(own, "procedure", entry.at, problems, places);
    reader.fill(spec);
    reader.refuse_unknown();
    file.push_back({.key = "procedure",
                    .at = entry.at,
                    .value = {.at = entry.value.at, .data = std::move(of_rule)}});
    Problems of_rule_alone;
    std::optional<ProcedureSpec> rule = read_procedure(file, of_rule_alone, places);
    problems.take(std::move(of_rule_alone));
    if (!rule) {
        return;
    }
    try {
        static_cast<RuleFacts&>(spec) = facts_of(*rule);
        spec.rule = {procedure_text(file), std::make_shared<const ProcedureSpec>(*std::move(rule))};
    } catch (const std::invalid_argument& error) {
        problems.add(spoken_of(*given, error.what(), entry.at), error.what());
    }
}

void check_adaptive(const Protocol& protocol, const Places& places, Problems& problems) {
    AdaptiveRules(protocol, places, problems).check();
}

}  // namespace palpate::protocols
