#include "protocols/design/session_plan.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/design/constrained_order.hpp"
#include "protocols/design/sha256.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/design/williams.hpp"

namespace palpate::protocols {
namespace {

/// The first `count` of catch objects x frictions, over and over. Going down the diagonals of the table
/// keeps every beginning of the list balanced in both factors; shuffled labels make the beginning fair.
std::vector<Condition> catch_conditions(const Protocol& protocol,
                                        std::size_t count,
                                        Pcg32& random) {
    std::vector<std::size_t> objects = objects_of(protocol, false);
    std::vector<std::size_t> frictions(protocol.frictions.size());
    std::iota(frictions.begin(), frictions.end(), std::size_t{0});
    shuffle(std::span(objects), random);
    shuffle(std::span(frictions), random);
    std::vector<Condition> conditions;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t column = i % objects.size();
        const std::size_t round = i / objects.size();
        conditions.push_back({objects[column], frictions[(column + round) % frictions.size()]});
    }
    shuffle(std::span(conditions), random);
    return conditions;
}

/// For every place of the main phase, whether a catch trial goes there. Never the first.
std::vector<bool> catch_places(std::size_t main, std::size_t catches, Pcg32& random) {
    std::vector<std::size_t> places(main + catches - 1);
    std::iota(places.begin(), places.end(), std::size_t{1});
    shuffle(std::span(places), random);
    std::vector<bool> is_catch(main + catches, false);
    for (std::size_t i = 0; i < catches; ++i) {
        is_catch[places[i]] = true;
    }
    return is_catch;
}

std::vector<std::size_t> picture_order(const Protocol& protocol, Pcg32 random) {
    const std::vector<std::size_t> pictured = objects_of(protocol, true);
    const auto rows = williams_rows(pictured.size());
    std::vector<std::size_t> order = rows[random.bounded(static_cast<std::uint32_t>(rows.size()))];
    for (std::size_t& place : order) {
        place = pictured[place];
    }
    return order;
}

std::string canonical_text(const Plan& plan,
                           std::string_view protocol_hash,
                           const SessionKey& key,
                           std::uint64_t seed) {
    std::string text = fmt::format(
        "palpate-plan-v1\nprotocol={}:{}\nparticipant={}:{}\nsession={}\nseed={}\npictures=",
        protocol_hash.size(), protocol_hash, key.participant.size(), key.participant, key.session,
        seed);
    for (const std::size_t object : plan.picture_order) {
        text += fmt::format("{} ", object);
    }
    text += '\n';
    for (const PlannedTrial& trial : plan.trials) {
        text += fmt::format("trial={} {} {} {} {}\n", trial.position, to_string(trial.phase),
                            trial.condition.object, trial.condition.friction,
                            trial.break_before ? "break" : "on");
    }
    return text;
}

void refuse_empty(const Protocol& protocol) {
    if (objects_of(protocol, true).empty() || protocol.frictions.empty() ||
        protocol.design.repetitions == 0) {
        throw std::invalid_argument(
            "a plan needs a pictured object, a friction and at least 1 repetition");
    }
    if (protocol.design.catch_trials > 0 && objects_of(protocol, false).empty()) {
        throw std::invalid_argument("catch trials need an object that is not pictured");
    }
}

/// Appends trials in order and counts the breaks.
class Writer {
public:
    Writer(Plan& plan, std::size_t break_every) : plan_(plan), break_every_(break_every) {}

    void practice(const Condition& condition) { add(Phase::practice, condition, false); }
    void main_phase(Phase phase, const Condition& condition) {
        const bool after_practice = main_ == 0 && !plan_.trials.empty();
        const bool due = main_ > 0 && break_every_ > 0 && main_ % break_every_ == 0;
        add(phase, condition, after_practice || due);
        ++main_;
    }

private:
    void add(Phase phase, const Condition& condition, bool break_before) {
        plan_.trials.push_back({plan_.trials.size(), phase, condition, break_before});
    }

    Plan& plan_;
    std::size_t break_every_;
    std::size_t main_ = 0;
};

}  // namespace

std::string_view to_string(Phase phase) noexcept {
    switch (phase) {
        case Phase::practice:
            return "practice";
        case Phase::main:
            return "main";
        case Phase::catch_trial:
            return "catch";
    }
    return "?";
}

std::vector<std::size_t> objects_of(const Protocol& protocol, bool pictured) {
    std::vector<std::size_t> objects;
    for (std::size_t i = 0; i < protocol.objects.size(); ++i) {
        if (protocol.objects[i].pictured == pictured) {
            objects.push_back(i);
        }
    }
    return objects;
}

std::vector<Condition> factorial(const Protocol& protocol, std::size_t repetitions) {
    std::vector<Condition> conditions;
    for (const std::size_t object : objects_of(protocol, true)) {
        for (std::size_t friction = 0; friction < protocol.frictions.size(); ++friction) {
            conditions.insert(conditions.end(), repetitions, Condition{object, friction});
        }
    }
    return conditions;
}

Plan make_plan(const Protocol& protocol,
               std::string_view protocol_hash,
               const SessionKey& key,
               std::uint64_t seed) {
    refuse_empty(protocol);
    const auto stream_for = [&](std::size_t session, const char* purpose) {
        return stream({.protocol_hash = std::string(protocol_hash),
                       .participant = key.participant,
                       .session = session,
                       .purpose = purpose,
                       .seed = seed});
    };
    const DesignSpec& design = protocol.design;
    Plan plan;
    Writer writer(plan, design.break_every);

    std::vector<Condition> practice = factorial(protocol, design.practice_repetitions);
    Pcg32 practice_stream = stream_for(key.session, "order.practice");
    shuffle(std::span(practice), practice_stream);
    for (const Condition& condition : practice) {
        writer.practice(condition);
    }

    Pcg32 main_stream = stream_for(key.session, "order.main");
    const ConstrainedOrder main = constrained_order(
        factorial(protocol, design.repetitions),
        {.object = design.max_run_object, .friction = design.max_run_friction}, main_stream);
    plan.attempts = main.attempts;

    Pcg32 catch_stream = stream_for(key.session, "catch");
    const std::vector<Condition> catches =
        catch_conditions(protocol, design.catch_trials, catch_stream);
    auto next_main = main.order.begin();
    auto next_catch = catches.begin();
    for (const bool is_catch : catch_places(main.order.size(), catches.size(), catch_stream)) {
        if (is_catch) {
            writer.main_phase(Phase::catch_trial, *next_catch++);
        } else {
            writer.main_phase(Phase::main, *next_main++);
        }
    }

    plan.picture_order = picture_order(protocol, stream_for(0, "pictures"));
    plan.hash = sha256_hex(canonical_text(plan, protocol_hash, key, seed));
    return plan;
}

std::string session_code(const Plan& plan) {
    const std::string_view hash = plan.hash;
    return fmt::format("{}-{}", hash.substr(0, 4),
                       hash.substr(std::min<std::size_t>(4, hash.size()), 4));
}

}  // namespace palpate::protocols
