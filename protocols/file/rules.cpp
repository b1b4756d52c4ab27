#include "protocols/file/rules.hpp"

#include <map>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/friction/laws/law.hpp"
#include "protocols/design/counterbalance.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/file/keys.hpp"

namespace palpate::protocols {
namespace {

class Rules : RuleCheck {
public:
    using RuleCheck::RuleCheck;

    void check() {
        unique_names("object", protocol_.objects);
        unique_names("friction", protocol_.frictions);
        numbers();
        check_objects(protocol_, places_, problems_);
        for (std::size_t i = 0; i < protocol_.frictions.size(); ++i) {
            friction(i);
        }
        timing();
        if (!protocol_.procedure) {
            design();
        }
        exclusion();
        response();
    }

private:
    static std::string path(std::string_view table, std::size_t index, std::string_view key) {
        return fmt::format("{}.{}.{}", table, index + 1, key);
    }

    template <class Spec>
    void unique_names(std::string_view table, const std::vector<Spec>& specs) {
        std::map<std::string_view, std::size_t> first;
        for (std::size_t i = 0; i < specs.size(); ++i) {
            const auto [known, is_new] = first.emplace(specs[i].name, i);
            add_if(!is_new, path(table, i, "name"),
                   "name is \"{}\", as in [[{}]] {}: give every {} a name of its own",
                   specs[i].name, table, known->second + 1, table);
        }
    }

    void numbers() {
        const std::size_t pictured = objects_of(protocol_, true).size();
        const bool asked = protocol_.response.kind == ResponseKind::identification;
        add_if(asked && (pictured < kMinPictures || pictured > kMaxPictures), "object.1",
               "{} cannot be chosen from: give {} to {} [[object]] tables without "
               "pictured = false",
               counted(pictured, "pictured object"), kMinPictures, kMaxPictures);
        add_if(protocol_.objects.size() > kMaxObjects, "object.1",
               "there are {} objects: give at most {}", protocol_.objects.size(), kMaxObjects);
        add_if(protocol_.frictions.empty() || protocol_.frictions.size() > kMaxFrictions,
               "friction.1", "there are {} frictions: give 1 to {} [[friction]] tables",
               protocol_.frictions.size(), kMaxFrictions);
    }

    void friction(std::size_t index) {
        const FrictionSpec& spec = protocol_.frictions[index];
        add_if(spec.mu_d > spec.mu_s, path("friction", index, "mu_d"),
               "mu_d is {}, above mu_s = {}: give at most mu_s", spec.mu_d, spec.mu_s);
        const ApparatusSpec& apparatus = protocol_.apparatus;
        add_if(spec.own.stiffness > apparatus.stiffness,
               path("friction", index, "tangential_stiffness_n_per_m"),
               "tangential_stiffness_n_per_m is {}, above stiffness_n_per_m = {}, by which the "
               "device's damping is reckoned: give at most that, or 0",
               spec.own.stiffness, apparatus.stiffness);
        add_if(spec.law == "bristle" && 3.0 * spec.mu_d < spec.mu_s,
               path("friction", index, "mu_d"),
               "mu_d is {}, and bonds that form at random cannot pull less than mu_s / 3 = {:.3g} "
               "in the mean: give at least that",
               spec.mu_d, spec.mu_s / 3.0);
        const double stiffness =
            spec.own.stiffness > 0.0 ? spec.own.stiffness : apparatus.stiffness;
        const double speed = protocol_.safety.speed_limit;
        add_if(spec.law == "lugre_euler", path("friction", index, "law"),
               "law is \"lugre_euler\", which diverges where sigma_0 |v| T / (mu_d F_N) > 2: at "
               "{:g} m/s below a load of {:.3g} N, and every contact begins with none; give "
               "\"lugre\", the same law by an exact step",
               speed,
               speed / engine::euler_limit(stiffness, 1.0, spec.mu_d, 1.0 / apparatus.rate_hz));
    }

    void timing() {
        const TimingSpec& timing = protocol_.timing;
        add_if(timing.explore_min >= timing.explore_timeout,
               places_.has("timing.explore_min_s") ? "timing.explore_min_s"
                                                   : "timing.explore_timeout_s",
               "explore_min_s is {} and explore_timeout_s is {}: nobody could answer; give a "
               "time-out above the minimum",
               timing.explore_min, timing.explore_timeout);
        add_if(
            timing.answer_timeout > 0.0 && timing.guard >= timing.answer_timeout,
            "timing.answer_timeout_s",
            "guard_s is {} and answer_timeout_s is {}: nobody could answer; give a time-out above "
            "guard_s, or 0 for none",
            timing.guard, timing.answer_timeout);
        add_if(timing.explore_prompt > timing.explore_timeout,
               places_.has("timing.explore_prompt_s") ? "timing.explore_prompt_s"
                                                      : "timing.explore_timeout_s",
               "explore_prompt_s is {}, after explore_timeout_s = {}: give at most the time-out",
               timing.explore_prompt, timing.explore_timeout);
    }

    void design() {
        const DesignSpec& design = protocol_.design;
        const std::size_t conditions =
            objects_of(protocol_, true).size() * protocol_.frictions.size();
        const std::size_t trials =
            conditions * (design.repetitions + design.practice_repetitions) + design.catch_trials +
            (design.order == OrderRule::first_order ? 1 : 0);  // the one that leads in
        if (add_if(trials > kMaxTrials, "design.repetitions",
                   "the session has {} trials: ask for {} or fewer", trials, kMaxTrials)) {
            return;
        }
        catch_trials();
        const std::string why = why_not_in_blocks(protocol_);
        if (add_if(!why.empty(), "design.friction_blocks", "friction_blocks is \"{}\": {}",
                   word_of(design.friction_blocks), why)) {
            return;
        }
        if (design.order == OrderRule::first_order) {
            first_order(conditions);
        } else if (!add_if(design.repetitions % design.blocks != 0, "design.blocks",
                           "blocks is {}, but {} cannot be divided evenly into them: give a "
                           "divisor",
                           design.blocks, counted(design.repetitions, "repetition"))) {
            run_limits();
        }
    }

    [[nodiscard]] bool in_design(const std::string& key) const {
        return places_.has("design." + key);
    }
    /// Whoever did not write the value looks for it in vain.
    [[nodiscard]] std::string stands(const std::string& key, std::size_t value) const {
        return fmt::format("{} is {}{}", key, value, in_design(key) ? "" : ", its default");
    }
    [[nodiscard]] std::string remedy(const std::string& key, std::size_t wanted) const {
        return in_design(key) ? fmt::format("give {}", wanted)
                              : fmt::format("add {} = {} to [design]", key, wanted);
    }

    void catch_trials() {
        const std::string key = "catch_trials";
        const std::size_t asked = protocol_.design.catch_trials;
        add_if(asked > 0 && objects_of(protocol_, false).empty(), "design." + key,
               "{}, but every object is pictured: add an [[object]] with pictured = false, or {}",
               stands(key, asked), remedy(key, 0));
    }

    void run_limits() {
        const DesignSpec& design = protocol_.design;
        if (const auto why = why_infeasible(protocols::factorial(protocol_, design.repetitions),
                                            block_limits(design))) {
            const bool of_object = why->factor == Infeasible::Factor::object;
            const std::string key = of_object ? "max_run_object" : "max_run_friction";
            const std::size_t limit = of_object ? design.max_run_object : design.max_run_friction;
            add("design." + key, fmt::format("{}: {}{}", stands(key, limit), why->reason,
                                             in_design(key) ? "" : ": " + remedy(key, 0)));
        }
    }

    /// A rule that nobody could keep or break is a slip.
    void exclusion() {
        const ResponseKind kind = protocol_.response.kind;
        const bool pictures = kind == ResponseKind::identification;
        const double least_right = protocol_.exclusion.share_correct_min;
        const bool right = kind == ResponseKind::two_interval || (pictures && !protocol_.procedure);
        add_if(
            least_right > 0.0 && !right, "exclusion.share_correct_min",
            "share_correct_min is {}, but an answer of kind \"{}\"{} is neither right nor wrong: "
            "give 0",
            least_right, word_of(kind), protocol_.procedure ? " to [procedure]" : "");
        const double least = protocol_.exclusion.catch_correct_min;
        if (least == 0.0 ||
            add_if(!pictures, "exclusion.catch_correct_min",
                   "catch_correct_min is {}, but kind is \"{}\", which has no pictures to choose "
                   "from: give 0, or kind \"identification\"",
                   least, word_of(kind))) {
            return;
        }
        add_if(protocol_.design.catch_trials == 0, "exclusion.catch_correct_min",
               "catch_correct_min is {}, but catch_trials is 0: give 0, or catch trials", least);
        for (const ObjectSpec& object : protocol_.objects) {
            if (add_if(!curvature_of(object), "exclusion.catch_correct_min",
                       "catch_correct_min is {}, but {} is a free form, of which no side is the "
                       "outer one: give 0, or objects with curvature_per_m",
                       least, object.name)) {
                return;
            }
        }
    }

    /// Such an order follows from the number of conditions; the run limits do not apply.
    void first_order(std::size_t conditions) {
        const DesignSpec& design = protocol_.design;
        const auto needs = [&](const std::string& key, std::size_t given, std::size_t wanted,
                               std::string_view why) {
            add_if(given != wanted, "design." + key,
                   "{}: order = \"first_order\" {}: {}, or give order = \"random\"",
                   stands(key, given), why, remedy(key, wanted));
        };
        needs("repetitions", design.repetitions, conditions,
              fmt::format("lets each of {} follow each once", counted(conditions, "condition")));
        needs("blocks", design.blocks, 1, "is one block");
        needs("catch_trials", design.catch_trials, 0, "has no room for catch trials");
    }

    /// What [response] needs of itself: which keys its kind has, and when an answer can be right.
    void response() {
        const ResponseSpec& response = protocol_.response;
        const ResponseKind kind = response.kind;
        const bool rating = kind == ResponseKind::rating;
        const bool labelled = rating || kind == ResponseKind::yes_no;
        const auto only_for = [&](const std::string& key, bool has_it, std::string_view kinds) {
            add_if(!has_it && places_.has("response." + key), "response." + key,
                   "{} is given, but kind is \"{}\": delete it, or give kind {}", key,
                   word_of(kind), kinds);
        };
        // As it begins it is in the canonical text of every kind.
        only_for("levels", rating || response.levels == ResponseSpec{}.levels, "\"rating\"");
        only_for("low", labelled, "\"yes_no\" or \"rating\"");
        only_for("high", labelled, "\"yes_no\" or \"rating\"");
        add_if(kind == ResponseKind::two_interval && !protocol_.procedure, "response.kind",
               "kind is \"two_interval\", but nothing says what the two intervals hold: add the "
               "table [procedure], or give another kind");
        add_if(kind != ResponseKind::identification && objects_of(protocol_, true).empty(),
               "object.1",
               "every object has pictured = false: nothing is left for the main trials; leave it "
               "out of one");
        add_if(labelled && response.question.empty(), "response.kind",
               "kind is \"{}\", but there is no question: add the key question", word_of(kind));
        add_if(labelled && response.feedback != Feedback::none, "response.feedback",
               "feedback is \"{}\", but an answer of kind \"{}\" is neither right nor wrong: give "
               "\"none\"",
               word_of(response.feedback), word_of(kind));
    }
};

}  // namespace

void check_rules(const Protocol& protocol, const Places& places, Problems& problems) {
    Rules(protocol, places, problems).check();
    if (protocol.procedure) {
        check_adaptive(protocol, places, problems);
    }
}

}  // namespace palpate::protocols
