#include "protocols/design/plan_summary.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/session/progress.hpp"
#include "tests/protocols/orders.hpp"

using namespace palpate::protocols;

namespace {

Protocol study(FrictionBlocks how, std::size_t frictions = 2, DesignSpec design = {}) {
    Protocol protocol = named_study(5, frictions, design, 2);
    if (design == DesignSpec{}) {
        protocol.design.blocks = 2;
    }
    protocol.design.friction_blocks = how;
    return protocol;
}

Plan blocked_plan_of(const Protocol& protocol,
                     std::uint64_t seed,
                     const RowHistory& frictions = {}) {
    return make_plan(protocol, "hash",
                     {.participant = std::string("p").append(std::to_string(seed))}, seed, {},
                     frictions);
}

std::map<std::size_t, std::vector<PlannedTrial>> blocks_of(const Plan& plan) {
    std::map<std::size_t, std::vector<PlannedTrial>> blocks;
    for (const PlannedTrial& trial : plan.trials) {
        if (trial.phase != Phase::practice) {
            blocks[trial.block].push_back(trial);
        }
    }
    return blocks;
}

std::vector<std::size_t> frictions_of(const Plan& plan) {
    std::vector<std::size_t> frictions;
    for (const auto& [block, trials] : blocks_of(plan)) {
        frictions.push_back(trials.front().condition.friction);
    }
    return frictions;
}

}  // namespace

TEST_CASE(
    "a friction block has one friction, every object equally often, and keeps the run limit") {
    const auto how = GENERATE(FrictionBlocks::abba, FrictionBlocks::blocked);
    EACH(frictions, std::size_t{2}, std::size_t{3});
    SEED(std::uint64_t{25});
    const Protocol protocol = study(how, frictions);
    const Plan plan = blocked_plan_of(protocol, seed);
    CHECK(plan.trials.size() == 5 * frictions * 11 + 4);
    const auto blocks = blocks_of(plan);
    REQUIRE(blocks.size() == 2 * frictions);
    REQUIRE(blocks.size() == block_count(protocol));
    std::set<std::vector<std::size_t>> orders;
    std::size_t position = 5 * frictions;
    for (const auto& [block, trials] : blocks) {
        CHECK(trials.front().phase == Phase::main);
        std::map<std::size_t, std::size_t> counts;
        std::vector<Condition> main;
        std::vector<std::size_t> order;
        for (const PlannedTrial& trial : trials) {
            CHECK(trial.position == position++);
            CHECK(trial.condition.friction == trials.front().condition.friction);
            CHECK((trial.condition.object >= 5) == (trial.phase == Phase::catch_trial));
            if (trial.phase == Phase::main) {
                ++counts[trial.condition.object];
                main.push_back(trial.condition);
                order.push_back(trial.condition.object);
            }
        }
        CHECK(even(counts, 5, 5));
        CHECK(palpate::tests::within_limits(main, {.object = 2}));
        orders.insert(order);
    }
    CHECK(orders.size() == blocks.size());
    CHECK(summarise(plan).longest_object_run <= 2);
}

TEST_CASE("abba goes there and back, blocked goes there again") {
    EACH(frictions, std::size_t{2}, std::size_t{3}, std::size_t{4});
    SEED(std::uint64_t{20});
    const auto round = [&](const std::vector<std::size_t>& all, std::size_t i) {
        const auto ordered = std::span(all).subspan(i * frictions, frictions);
        return std::vector<std::size_t>(ordered.begin(), ordered.end());
    };
    const Protocol abba = study(FrictionBlocks::abba, frictions);
    const auto mirrored = frictions_of(blocked_plan_of(abba, seed));
    auto back = round(mirrored, 1);
    std::reverse(back.begin(), back.end());
    CHECK(back == round(mirrored, 0));
    CHECK(first_round(abba, blocked_plan_of(abba, seed)) == round(mirrored, 0));
    // Each friction has the same mean place: what drifts in a straight line weighs alike on all.
    std::map<std::size_t, std::size_t> places;
    for (std::size_t i = 0; i < mirrored.size(); ++i) {
        places[mirrored[i]] += i;
    }
    CHECK(even(places, frictions, mirrored.size() - 1));
    const auto blocked =
        frictions_of(blocked_plan_of(study(FrictionBlocks::blocked, frictions), seed));
    CHECK(round(blocked, 0) == round(blocked, 1));
}

TEST_CASE("catch trials are felt with the friction of their block, spread evenly over its blocks") {
    EACH(catches, range(std::size_t{0}, std::size_t{13}));
    Protocol protocol = study(FrictionBlocks::abba);
    protocol.design.catch_trials = catches;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Plan plan = blocked_plan_of(protocol, seed);
        std::map<std::size_t, std::vector<std::size_t>> of_friction;
        std::size_t all = 0;
        for (const auto& [block, trials] : blocks_of(plan)) {
            const auto n = static_cast<std::size_t>(std::count_if(
                trials.begin(), trials.end(),
                [](const PlannedTrial& trial) { return trial.phase == Phase::catch_trial; }));
            of_friction[trials.front().condition.friction].push_back(n);
            all += n;
        }
        CHECK(all == catches);
        for (const auto& [friction, counts] : of_friction) {
            const auto [least, max] = std::minmax_element(counts.begin(), counts.end());
            CHECK(*max - *least <= 1);
        }
    }
}

// 3 catch trials of one friction and 25 main trials: places 1 to 25 or later of a block. With one
// catch trial in a block its place is uniform over 25; chi-square of 24 degrees passes 66 once in
// 100,000.
TEST_CASE("a catch trial comes at every place of its block but the first, equally often") {
    Protocol protocol = study(FrictionBlocks::abba);
    protocol.design.catch_trials = 4;
    std::map<std::size_t, double> places;
    for (std::uint64_t seed = 0; seed < 1000; ++seed) {
        for (const auto& [block, trials] : blocks_of(blocked_plan_of(protocol, seed))) {
            REQUIRE(trials.size() == 26);
            for (std::size_t i = 0; i < trials.size(); ++i) {
                places[i] += trials[i].phase == Phase::catch_trial ? 1.0 : 0.0;
            }
        }
    }
    CHECK(places.at(0) == 0.0);
    places.erase(0);
    CHECK(places.size() == 25);
    CHECK(chi_square(places, 25) < 66.0);
}

// Objects are alike to the limit. Four degrees of freedom; 35 is passed once in 2e6, at any of 25
// places of 4 blocks once in 20,000.
TEST_CASE("in a friction block every object is equally likely at every place") {
    const Protocol protocol = study(FrictionBlocks::abba);
    std::map<std::pair<std::size_t, std::size_t>, std::map<std::size_t, double>> places;
    for (std::uint64_t seed = 0; seed < 3000; ++seed) {
        std::map<std::size_t, std::size_t> next;
        for (const PlannedTrial& trial : blocked_plan_of(protocol, seed).trials) {
            if (trial.phase == Phase::main) {
                ++places[{trial.block, next[trial.block]++}][trial.condition.object];
            }
        }
    }
    CHECK(places.size() == 100);
    for (const auto& [place, counts] : places) {
        CAPTURE(place.first, place.second);
        CHECK(chi_square(counts, 5) < 35.0);
    }
}

TEST_CASE("with nobody there yet each friction begins as often as the others") {
    std::map<std::size_t, double> begins;
    const Protocol protocol = study(FrictionBlocks::blocked, 2, {.repetitions = 1});
    for (std::uint64_t seed = 0; seed < 4000; ++seed) {
        ++begins[frictions_of(blocked_plan_of(protocol, seed)).front()];
    }
    CHECK(begins.size() == 2);
    CHECK(chi_square(begins, 2) < 24.0);  // one degree of freedom: passed once in 1e6
}

TEST_CASE(
    "after every participant no order of frictions is used more than once more than another") {
    EACH(frictions, std::size_t{2}, std::size_t{3});
    SEED(std::uint64_t{20});
    const Protocol protocol = study(FrictionBlocks::abba, frictions);
    std::vector<std::vector<std::string>> before;
    for (std::uint64_t i = 0; i < 13; ++i) {
        const Plan plan =
            blocked_plan_of(protocol, 100 * seed + i, friction_history(protocol, before, {}));
        before.push_back(names_of(protocol.frictions, first_round(protocol, plan)));
        const RowHistory now = friction_history(protocol, before, before.back());
        REQUIRE(now.uses.size() == friction_rows(protocol).size());
        const auto [least, max] = std::minmax_element(now.uses.begin(), now.uses.end());
        CHECK(*max - *least <= 1);
        // Whoever comes again goes on as before, whatever others did since.
        CHECK(first_round(protocol, blocked_plan_of(protocol, 7 * seed + i, now)) ==
              first_round(protocol, plan));
    }
}

TEST_CASE("a trial that is run again stays in its friction block") {
    const auto seed = GENERATE(palpate::tests::seeds(std::uint64_t{10}));
    const Plan plan = blocked_plan_of(study(FrictionBlocks::abba), seed);
    RequeueRule rule;
    rule.key.seed = seed;
    PendingTrials pending(plan, rule);
    std::vector<std::size_t> ran;
    std::set<std::size_t> failed;
    while (!pending.empty()) {
        const std::size_t position = pending.next();
        ran.push_back(position);
        const bool fails = position % 7 == 3 && failed.insert(position).second;
        pending.note(position, fails ? Outcome::faulted : Outcome::complete);
    }
    CHECK(ran.size() == plan.trials.size() + failed.size());
    std::size_t block = 0;
    for (const std::size_t position : ran) {
        CHECK(plan.trials[position].block >= block);
        block = plan.trials[position].block;
    }
}

TEST_CASE("friction blocks that cannot be are refused with the remedy") {
    CHECK_THROWS_WITH(blocked_plan_of(study(FrictionBlocks::abba, 1), 1),
                      Has("two frictions or more"));
    CHECK_THROWS_WITH(blocked_plan_of(study(FrictionBlocks::abba, 2, {.blocks = 5}), 1),
                      Has("blocks is 5", "even number"));
    CHECK_THROWS_WITH(
        blocked_plan_of(
            study(FrictionBlocks::blocked, 2,
                  {.repetitions = 10, .catch_trials = 0, .order = OrderRule::first_order}),
            1),
        Has("first_order"));
}
