#include "engine/base/sha256.hpp"
#include "protocols/design/plan_summary.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/order/order_sampler.hpp"
#include "tests/protocols/orders.hpp"

using namespace palpate::protocols;

namespace {

Plan ruled_plan_of(const Protocol& protocol, std::uint64_t seed = 1) {
    return make_plan(protocol, "hash", {.participant = "p"}, seed);
}

/// Largest chi-square, over all places, of the conditions against equal shares.
template <class Draw>
double worst_place(const Order& trials, std::size_t draws, const Draw& draw) {
    const std::set<Condition> conditions(trials.begin(), trials.end());
    std::vector<std::map<Condition, std::size_t>> places(trials.size());
    for (std::size_t i = 0; i < draws; ++i) {
        const Order order = draw();
        for (std::size_t place = 0; place < order.size(); ++place) {
            ++places[place][order[place]];
        }
    }
    double worst = 0.0;
    for (const auto& counts : places) {
        worst = std::max(worst, chi_square(counts, conditions.size()));
    }
    return worst;
}

/// Runs of a friction that are as long as the limit, in `draws` orders.
template <class Draw>
double longest_runs(std::size_t draws, const Draw& draw) {
    double runs = 0.0;
    for (std::size_t i = 0; i < draws; ++i) {
        const Order order = draw();
        for (std::size_t k = 2; k < order.size(); ++k) {
            runs += order[k].friction == order[k - 1].friction &&
                            order[k].friction == order[k - 2].friction
                      ? 1.0
                      : 0.0;
        }
    }
    return runs / static_cast<double>(draws);
}

}  // namespace

// All objects are alike to the limits, and all frictions: every condition is as likely as any other
// at every place. Nine degrees of freedom; 46 is passed once in 1.5e6, at any of 100 places once in
// 15,000.
TEST_CASE("within limits every condition is equally likely at every place") {
    struct Case {
        std::size_t repetitions, draws;
    };
    const auto [repetitions, draws] = GENERATE(values<Case>({{4, 20'000}, {10, 4'000}}));
    const Order trials = factorial_of(5, 2, repetitions);
    OrderSampler sampler(trials, {.object = 2, .friction = 3});
    Pcg32 random(2026, 11);
    CHECK(worst_place(trials, draws, [&] { return sampler.draw(random).order; }) < 46.0);
}

// Conditions by place cannot tell: a repair by swaps knows no condition from another either. What
// it changes is how often runs come, by more than 1 (measured: sd of the mean of 2,000 orders .05).
TEST_CASE("orders of the default study have as many long runs as shuffles within the limits") {
    const Order trials = factorial_of(5, 2, 10);
    const RunLimits limits{.object = 2, .friction = 3};
    OrderSampler sampler(trials, limits);
    Pcg32 random(2026, 12);
    const auto shuffles = [&] {  // no counting: whole shuffles, of the same distribution
        for (;;) {
            if (auto order = sampler.propose(OrderWay::shuffles, random)) {
                return *order;
            }
        }
    };
    const double uniform = longest_runs(2000, [&] { return sampler.draw(random).order; });
    CHECK(std::fabs(longest_runs(100, shuffles) - uniform) < 4.0 * 0.05 * std::sqrt(21.0));
}

TEST_CASE("every block is balanced exactly and keeps the limits, and no two are alike") {
    SEED(std::uint64_t{20});
    EACH(blocks, std::size_t{1}, std::size_t{2}, std::size_t{5});
    const Plan plan = ruled_plan_of(named_study(5, 2, {.blocks = blocks}), seed);
    const PlanSummary summary = summarise(plan);
    std::size_t main = 0;
    for (const auto& [part, counts] : summary.counts) {
        if (part.phase != Phase::main) {
            continue;
        }
        ++main;
        CHECK(even(counts, 10, 10 / blocks));
    }
    CHECK(main == blocks);
    std::map<std::size_t, Order> orders;
    Order session;
    for (const PlannedTrial& trial : plan.trials) {
        CHECK(trial.block < blocks);
        if (trial.phase == Phase::main) {
            orders[trial.block].push_back(trial.condition);
            session.push_back(trial.condition);
        }
    }
    CHECK(palpate::tests::within_limits(
        session, {.object = 2, .friction = 3}));  // over the borders of blocks, too
    CHECK(summary.longest_object_run <= 2);
    CHECK(summary.longest_friction_run <= 3);
    std::set<Order> different;
    for (const auto& [block, order] : orders) {
        different.insert(order);
    }
    CHECK(different.size() == blocks);
    CHECK(std::is_sorted(plan.trials.begin() + 10, plan.trials.end(),
                         [](const auto& a, const auto& b) { return a.block < b.block; }));
}

TEST_CASE("a first-order plan has every condition after every condition once, and a trial before") {
    SEED(std::uint64_t{20});
    EACH(practice, std::size_t{0}, std::size_t{1});
    const Plan plan = ruled_plan_of(named_study(3, 2,
                                                {.repetitions = 6,
                                                 .practice_repetitions = practice,
                                                 .catch_trials = 0,
                                                 .break_every = 9,
                                                 .order = OrderRule::first_order}),
                                    seed);
    const std::size_t lead_in = 6 * practice;
    REQUIRE(plan.trials.size() == lead_in + 37);
    CHECK(plan.trials[lead_in].phase == Phase::practice);
    CHECK(plan.trials[lead_in].break_before == (practice > 0));
    CHECK_FALSE(plan.trials[lead_in + 1].break_before);
    CHECK(plan.trials[lead_in + 10].break_before);
    std::set<std::pair<Condition, Condition>> pairs;
    std::map<Condition, std::size_t> counts;
    for (std::size_t i = lead_in + 1; i < plan.trials.size(); ++i) {
        CHECK(plan.trials[i].phase == Phase::main);
        pairs.emplace(plan.trials[i - 1].condition, plan.trials[i].condition);
        ++counts[plan.trials[i].condition];
    }
    CHECK(pairs.size() == 36);
    CHECK(even(counts, 6, 6));
}

TEST_CASE("what cannot be divided or balanced is refused with the remedy") {
    CHECK_THROWS_WITH(ruled_plan_of(named_study(5, 2, {.blocks = 3})),
                      Has("10 repetitions", "3 blocks"));
    CHECK_THROWS_WITH(ruled_plan_of(named_study(5, 2, {.blocks = 0})), Has("0 blocks"));
    CHECK_THROWS_WITH(
        ruled_plan_of(named_study(3, 2, {.catch_trials = 0, .order = OrderRule::first_order})),
        Has("6 conditions needs 6 repetitions"));
    CHECK_THROWS_WITH(
        ruled_plan_of(named_study(3, 2, {.repetitions = 6, .order = OrderRule::first_order})),
        Has("no catch trials"));
}

TEST_CASE("ten thousand trials in blocks are planned whole") {
    const Plan plan = ruled_plan_of(named_study(
        5, 2, {.repetitions = 1000, .practice_repetitions = 0, .catch_trials = 0, .blocks = 100}));
    CHECK(plan.trials.size() == 10'000);
    CHECK(summarise(plan).longest_friction_run <= 3);
}

// Equal with gcc 12 and clang 14, libstdc++ and libc++, -O0 and -O2. Another compiler, library or
// version of this program must give the same plans, or a session could not be resumed there.
TEST_CASE("plans of many designs are the same in every build") {
    const std::array designs = {
        named_study(5, 2, {}),
        named_study(5, 2, {.repetitions = 5, .max_run_object = 1, .max_run_friction = 2}),
        named_study(2, 2, {.max_run_object = 1, .max_run_friction = 2}),
        named_study(5, 2, {.max_run_object = 0, .max_run_friction = 1}),
        named_study(7, 3,
                    {.repetitions = 4, .max_run_object = 0, .max_run_friction = 0, .blocks = 2}),
        named_study(3, 2, {.repetitions = 6, .catch_trials = 0, .order = OrderRule::first_order})};
    std::string hashes;
    for (const Protocol& protocol : designs) {
        for (std::uint64_t seed = 0; seed < 5; ++seed) {
            hashes += ruled_plan_of(protocol, seed).hash;
        }
    }
    CHECK(sha256_hex(hashes) == "1402ee06bc3e47e36292bd082aa864470a986fef01f22f5cc7a1b1f17b87cea1");
}
