#include "protocols/design/session_plan.hpp"

#include <algorithm>
#include <array>
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
    const std::string why = why_not_in_blocks(protocol);
    refuse_if(!why.empty(), "{}", why);
    refuse_if(
        design.order == OrderRule::first_order &&
            (design.repetitions != conditions || design.blocks != 1 || design.catch_trials != 0),
        "a first-order balanced sequence of {} needs {}, 1 block and no catch trials",
        counted(conditions, "condition"), counted(conditions, "repetition"));
}

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

/// The main trials, block by block; a trial that only leads in is planned before them.
/// @param frictions  the one of each block, where they are not interleaved
std::vector<Condition> main_trials(const Protocol& protocol,
                                   std::span<const std::size_t> frictions,
                                   const StreamKey& of_session,
                                   Plan& plan) {
    const DesignSpec& design = protocol.design;
    std::vector<Condition> main;
    if (design.order == OrderRule::first_order) {
        const std::vector<Condition> conditions = factorial(protocol, 1);
        Pcg32 random = stream(of_session, purpose::main_order);
        for (const std::size_t symbol : eulerian_order(conditions.size(), random)) {
            main.push_back(conditions[symbol]);
        }
        plan.trials.push_back({.phase = Phase::practice, .condition = main.front()});
        main.erase(main.begin());
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
    plan.attempts = 0;
    for (std::size_t block = 0; block < block_count(protocol); ++block) {
        Pcg32 random = stream(of_session, purpose::main_order, block);
        OrderSampler& sampler = samplers[frictions.empty() ? 0 : frictions[block]];
        ConstrainedOrder drawn;
        do {  // levels come equally often: one in four begins with another object and friction
            drawn = sampler.draw(random);
            plan.attempts += drawn.attempts;
        } while (!goes_on(main, drawn.order, limits));
        main.insert(main.end(), drawn.order.begin(), drawn.order.end());
        plan.way = drawn.way;
    }
    return main;
}

/// For every place of so many trials, whether a catch trial goes there. Never the first.
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

/// Plans main trials of so many blocks, as large as each other, with catch trials anywhere among
/// them but first. @param first  number of the first block
void add_blocks(std::span<const Condition> main,
                std::size_t first,
                std::size_t blocks,
                std::span<const Condition> catches,
                Pcg32& random,
                Plan& plan) {
    std::size_t next_main = 0;
    std::size_t next_catch = 0;
    for (const bool a_catch : catch_places(main.size(), catches.size(), random)) {
        const std::size_t block = first + std::min(next_main * blocks / main.size(), blocks - 1);
        plan.trials.push_back({.phase = a_catch ? Phase::catch_trial : Phase::main,
                               .condition = a_catch ? catches[next_catch++] : main[next_main++],
                               .block = block});
    }
}

/// The catch trials of each block, all of its own friction: those of a friction are dealt round its
/// blocks in a random order, so that these hold equally many or one more.
/// @param frictions  of each block
/// @param catches    of any of these frictions, in random order
std::vector<std::vector<Condition>> catches_by_block(std::span<const std::size_t> frictions,
                                                     std::span<const Condition> catches,
                                                     Pcg32& random) {
    std::vector<std::size_t> blocks(frictions.size());
    std::iota(blocks.begin(), blocks.end(), std::size_t{0});
    shuffle(std::span(blocks), random);
    std::vector<std::vector<Condition>> of(frictions.size());
    for (const Condition& condition : catches) {
        // The first in that order which has fewest so far.
        std::optional<std::size_t> chosen;
        for (const std::size_t block : blocks) {
            if (frictions[block] == condition.friction &&
                (!chosen || of[block].size() < of[*chosen].size())) {
                chosen = block;
            }
        }
        of.at(chosen.value()).push_back(condition);
    }
    return of;
}

/// A stream for all sessions of the participant.
Pcg32 stream_for_all(StreamKey key, std::string_view purpose) {
    key.session = 0;
    return stream(std::move(key), purpose);
}

/// The main trials with the catch trials between them.
void add_main_trials(const Protocol& protocol,
                     const StreamKey& of_session,
                     const RowHistory& frictions,
                     Plan& plan) {
    const DesignSpec& design = protocol.design;
    std::vector<std::size_t> friction_of;
    if (in_friction_blocks(design)) {
        const auto rows = friction_rows(protocol);
        Pcg32 random = stream_for_all(of_session, purpose::friction_blocks);
        friction_of = friction_of_blocks(design, rows[choose_row(rows.size(), frictions, random)]);
    }
    const std::vector<Condition> main = main_trials(protocol, friction_of, of_session, plan);
    Pcg32 random = stream(of_session, purpose::catch_trials);
    const std::vector<Condition> catches = catch_conditions(protocol, design.catch_trials, random);
    const std::size_t blocks = block_count(protocol);
    if (friction_of.empty()) {
        add_blocks(main, 0, blocks, catches, random, plan);
        return;
    }
    const auto own = catches_by_block(friction_of, catches, random);
    const std::size_t size = main.size() / blocks;
    for (std::size_t block = 0; block < blocks; ++block) {
        add_blocks(std::span(main).subspan(block * size, size), block, 1, own[block], random, plan);
    }
}

void add_factorial_trials(const Protocol& protocol,
                          const StreamKey& of_session,
                          const RowHistory& frictions,
                          Plan& plan) {
    refuse(protocol);
    std::vector<Condition> practice = factorial(protocol, protocol.design.practice_repetitions);
    Pcg32 random = stream(of_session, purpose::practice_order);
    shuffle(std::span(practice), random);
    for (const Condition& condition : practice) {
        plan.trials.push_back({.phase = Phase::practice, .condition = condition});
    }
    add_main_trials(protocol, of_session, frictions, plan);
    place(plan.trials, practice.size(), protocol.design.break_every);
}

}  // namespace

std::string_view to_string(Phase phase) noexcept {
    constexpr std::array<std::string_view, 3> kWords{"practice", "main", "catch"};
    return kWords[static_cast<std::size_t>(phase)];
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
    const StreamKey of_session = session_stream(protocol_hash, key, seed);
    Plan plan;
    if (protocol.procedure) {
        add_adaptive_trials(protocol, of_session, plan);
    } else {
        add_factorial_trials(protocol, of_session, frictions, plan);
    }
    const auto rows = picture_rows(protocol);
    Pcg32 random = stream_for_all(of_session, purpose::pictures);
    plan.picture_order = rows[choose_row(rows.size(), pictures, random)];
    plan.hash = sha256_hex(canonical_text(plan, protocol_hash, key, seed) +
                           (protocol.procedure ? rule_lines(protocol, of_session) : ""));
    return plan;
}

std::string session_code(const Plan& plan) {
    const std::string_view hash = plan.hash;
    return fmt::format("{}-{}", hash.substr(0, 4),
                       hash.substr(std::min<std::size_t>(4, hash.size()), 4));
}

}  // namespace palpate::protocols
