#include "protocols/design/session_plan.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/sha256.hpp"
#include "engine/base/text.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/order/eulerian_order.hpp"
#include "protocols/order/order_sampler.hpp"

namespace palpate::protocols {
namespace {

/// The first `count` of catch objects x frictions, over and over. Going down the diagonals of the
/// table keeps every beginning of the list balanced in both factors; shuffled labels make the
/// beginning fair.
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

/// What Plan::hash is of. Texts carry their length, so that no two plans can be written alike.
std::string canonical_text(const Plan& plan,
                           std::string_view protocol_hash,
                           const SessionKey& key,
                           std::uint64_t seed) {
    std::string text =
        fmt::format("palpate-plan-v2\nprotocol={}:{}\nparticipant={}:{}\nsession={}\nseed={}\n",
                    protocol_hash.size(), protocol_hash, key.participant.size(), key.participant,
                    key.session, seed);
    if (!key.secret.empty()) {
        text += fmt::format("secret={}:{}\n", key.secret.size(), key.secret);
    }
    text += "pictures=";
    for (const std::size_t object : plan.picture_order) {
        text += fmt::format("{} ", object);
    }
    text += '\n';
    for (const PlannedTrial& trial : plan.trials) {
        text += fmt::format("trial={} {} {} {} {} {}\n", trial.position, to_string(trial.phase),
                            trial.block, trial.condition.object, trial.condition.friction,
                            trial.break_before ? "break" : "on");
        if (trial.adaptive) {
            text += fmt::format("adaptive={} {} {}\n", trial.adaptive->run,
                                trial.adaptive->comparison, trial.adaptive->standard_friction);
        }
    }
    return text;
}

void refuse(const Protocol& protocol) {
    const DesignSpec& design = protocol.design;
    const std::size_t conditions = objects_of(protocol, true).size() * protocol.frictions.size();
    refuse_if(conditions == 0 || design.repetitions == 0,
              "a plan needs a pictured object, a friction and at least 1 repetition");
    refuse_if(design.catch_trials > 0 && objects_of(protocol, false).empty(),
              "catch trials need an object that is not pictured");
    refuse_if(design.blocks == 0 || design.repetitions % design.blocks != 0,
              "{} cannot be divided evenly into {}: give a divisor",
              counted(design.repetitions, "repetition"), counted(design.blocks, "block"));
    if (const std::string why = why_not_in_blocks(protocol); !why.empty()) {
        throw std::invalid_argument(why);
    }
    refuse_if(
        design.order == OrderRule::first_order &&
            (design.repetitions != conditions || design.blocks != 1 || design.catch_trials != 0),
        "a first-order balanced sequence of {} needs {}, 1 block and no catch trials",
        counted(conditions, "condition"), counted(conditions, "repetition"));
}

/// The main trials, block by block. A trial that only leads in stands before the first.
struct MainTrials {
    std::optional<Condition> lead_in;
    std::vector<Condition> order;
    std::uint64_t attempts = 0;
    OrderWay way = OrderWay::shuffles;
};

/// The trials so far go on with these within the limits, which each of both keeps in itself.
bool goes_on(std::span<const Condition> so_far,
             std::span<const Condition> with,
             const RunLimits& limits) {
    std::vector<Condition> whole(so_far.begin(), so_far.end());
    whole.insert(whole.end(), with.begin(), with.end());
    Run object(&Condition::object, limits.object);
    Run friction(&Condition::friction, limits.friction);
    return std::ranges::adjacent_find(whole, [&](const Condition& last, const Condition& next) {
               return !object.goes_on(last, next) || !friction.goes_on(last, next);
           }) == whole.end();
}

/// @param frictions  the one of each block, where they are not interleaved
template <class StreamOfBlock>
MainTrials main_trials(const Protocol& protocol,
                       std::span<const std::size_t> frictions,
                       const StreamOfBlock& stream_of) {
    const DesignSpec& design = protocol.design;
    MainTrials main;
    if (design.order == OrderRule::first_order) {
        const std::vector<Condition> conditions = factorial(protocol, 1);
        Pcg32 random = stream_of(0);
        for (const std::size_t symbol : eulerian_order(conditions.size(), random)) {
            main.order.push_back(conditions[symbol]);
        }
        main.lead_in = main.order.front();
        main.order.erase(main.order.begin());
        main.attempts = 1;
        return main;
    }
    const RunLimits limits = block_limits(design);
    if (const auto why = why_infeasible(factorial(protocol, design.repetitions), limits)) {
        throw OrderError("no order keeps the run limits: " + why->reason);
    }
    // One sampler for every friction, or for all of them together: its tables take time.
    std::vector<OrderSampler> samplers;
    for (std::size_t i = 0; i < (frictions.empty() ? 1 : protocol.frictions.size()); ++i) {
        samplers.emplace_back(block_trials(protocol, i), limits);
    }
    for (std::size_t block = 0; block < block_count(protocol); ++block) {
        Pcg32 random = stream_of(block);
        OrderSampler& sampler = samplers[frictions.empty() ? 0 : frictions[block]];
        ConstrainedOrder drawn;
        do {  // levels come equally often: one in four begins with another object and friction
            drawn = sampler.draw(random);
            main.attempts += drawn.attempts;
        } while (!goes_on(main.order, drawn.order, limits));
        main.order.insert(main.order.end(), drawn.order.begin(), drawn.order.end());
        main.way = drawn.way;
    }
    return main;
}

/// Appends trials in order and counts the breaks.
class Writer {
public:
    Writer(Plan& plan, std::size_t break_every) : plan_(plan), break_every_(break_every) {}

    void practice(const Condition& condition, bool break_before = false) {
        add(Phase::practice, condition, break_before, 0);
    }
    void main_phase(Phase phase, const Condition& condition, bool begins, std::size_t block) {
        const bool due = main_ > 0 && break_every_ > 0 && main_ % break_every_ == 0;
        add(phase, condition, begins || due, block);
        ++main_;
    }

private:
    void add(Phase phase, const Condition& condition, bool break_before, std::size_t block) {
        plan_.trials.push_back({plan_.trials.size(), phase, condition, break_before, block});
    }

    Plan& plan_;
    std::size_t break_every_;
    std::size_t main_ = 0;
};

/// Main and catch trials, after a break if there was practice: before the trial that leads in, if
/// any.
void write_main(Writer& writer,
                const std::optional<Condition>& lead_in,
                std::span<const MainTrial> trials,
                bool practised) {
    if (lead_in) {
        writer.practice(*lead_in, practised);
    }
    bool begins = practised && !lead_in;
    for (const MainTrial& trial : trials) {
        writer.main_phase(trial.phase, trial.condition, begins, trial.block);
        begins = false;
    }
}

/// Catch trials anywhere among the main ones but first.
std::vector<MainTrial> with_catch_trials(std::span<const Condition> main,
                                         std::size_t blocks,
                                         std::span<const Condition> catches,
                                         Pcg32& random) {
    std::vector<MainTrial> trials;
    std::size_t next_main = 0;
    std::size_t next_catch = 0;
    const std::size_t of_block = main.size() / blocks;
    for (const bool a_catch : catch_places(main.size(), catches.size(), random)) {
        const std::size_t block = std::min(next_main / of_block, blocks - 1);
        trials.push_back(a_catch ? MainTrial{Phase::catch_trial, catches[next_catch++], block}
                                 : MainTrial{Phase::main, main[next_main++], block});
    }
    return trials;
}

/// One of the streams of a session. Session 0: one for all sessions of the participant.
Pcg32 stream_for(StreamKey key, std::string_view purpose, std::size_t block = 0) {
    key.block = block;
    key.purpose = purpose;
    return stream(key);
}
Pcg32 stream_for_all(StreamKey key, std::string_view purpose) {
    key.session = 0;
    return stream_for(std::move(key), purpose);
}

void choose_pictures(const Protocol& protocol,
                     const StreamKey& of_session,
                     const RowHistory& pictures,
                     Plan& plan) {
    const auto rows = picture_rows(protocol);
    Pcg32 picture_stream = stream_for_all(of_session, purpose::pictures);
    plan.picture_order = rows[choose_row(rows.size(), pictures, picture_stream)];
}

/// The main trials with the catch trials between them.
void add_main_trials(const Protocol& protocol,
                     const StreamKey& of_session,
                     const RowHistory& frictions,
                     bool practised,
                     Plan& plan,
                     Writer& writer) {
    const DesignSpec& design = protocol.design;
    std::vector<std::size_t> friction_of;
    if (in_friction_blocks(design)) {
        const auto rows = friction_rows(protocol);
        Pcg32 random = stream_for_all(of_session, purpose::friction_blocks);
        friction_of = friction_of_blocks(design, rows[choose_row(rows.size(), frictions, random)]);
    }
    const MainTrials main = main_trials(protocol, friction_of, [&](std::size_t block) {
        return stream_for(of_session, purpose::main_order, block);
    });
    plan.attempts = main.attempts;
    plan.way = main.way;
    Pcg32 catch_stream = stream_for(of_session, purpose::catch_trials);
    const std::vector<Condition> catches =
        catch_conditions(protocol, design.catch_trials, catch_stream);
    const std::size_t blocks = block_count(protocol);
    write_main(writer, main.lead_in,
               friction_of.empty() ? with_catch_trials(main.order, blocks, catches, catch_stream)
                                   : with_catch_trials(main.order, main.order.size() / blocks,
                                                       friction_of, catches, catch_stream),
               practised);
}

Plan adaptive_plan(const Protocol& protocol,
                   std::string_view protocol_hash,
                   const SessionKey& key,
                   std::uint64_t seed,
                   const RowHistory& pictures) {
    const StreamKey of_session = session_stream(protocol_hash, key, seed);
    Plan plan;
    plan.trials = adaptive_trials(protocol, of_session, plan);
    choose_pictures(protocol, of_session, pictures, plan);
    plan.hash = sha256_hex(canonical_text(plan, protocol_hash, key, seed) +
                           rule_lines(protocol, of_session));
    return plan;
}

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

StreamKey session_stream(std::string_view protocol_hash,
                         const SessionKey& key,
                         std::uint64_t seed) {
    return {.protocol_hash = std::string(protocol_hash),
            .participant = key.participant,
            .session = key.session,
            .purpose = {},
            .seed = seed,
            .secret = key.secret};
}

Plan make_plan(const Protocol& protocol,
               std::string_view protocol_hash,
               const SessionKey& key,
               std::uint64_t seed,
               const RowHistory& pictures,
               const RowHistory& frictions) {
    if (protocol.procedure) {
        return adaptive_plan(protocol, protocol_hash, key, seed, pictures);
    }
    refuse(protocol);
    const StreamKey of_session = session_stream(protocol_hash, key, seed);
    Plan plan;
    Writer writer(plan, protocol.design.break_every);

    std::vector<Condition> practice = factorial(protocol, protocol.design.practice_repetitions);
    Pcg32 practice_stream = stream_for(of_session, purpose::practice_order);
    shuffle(std::span(practice), practice_stream);
    for (const Condition& condition : practice) {
        writer.practice(condition);
    }
    add_main_trials(protocol, of_session, frictions, !practice.empty(), plan, writer);
    choose_pictures(protocol, of_session, pictures, plan);
    plan.hash = sha256_hex(canonical_text(plan, protocol_hash, key, seed));
    return plan;
}

std::string session_code(const Plan& plan) {
    const std::string_view hash = plan.hash;
    return fmt::format("{}-{}", hash.substr(0, 4),
                       hash.substr(std::min<std::size_t>(4, hash.size()), 4));
}

}  // namespace palpate::protocols
