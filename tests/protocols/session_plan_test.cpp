#include "protocols/design/session_plan.hpp"
#include "tests/protocols/orders.hpp"

using namespace palpate::protocols;

namespace {

Protocol planned_study() {
    return named_study(5, 2, {}, 2);
}

std::vector<Condition> of_phase(const Plan& plan, Phase phase) {
    std::vector<Condition> conditions;
    for (const PlannedTrial& trial : plan.trials) {
        if (trial.phase == phase) {
            conditions.push_back(trial.condition);
        }
    }
    return conditions;
}

std::map<Condition, std::size_t> counts(const std::vector<Condition>& conditions) {
    std::map<Condition, std::size_t> counted;
    for (const Condition& condition : conditions) {
        ++counted[condition];
    }
    return counted;
}

}  // namespace

TEST_CASE("a Williams design balances items, places and neighbours") {
    EACH(n, range(std::size_t{1}, std::size_t{10}));
    const auto rows = williams_rows(n);
    REQUIRE(rows.size() == (n % 2 == 0 ? n : 2 * n));
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> at_place;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> neighbours;
    for (const auto& row : rows) {
        CHECK(std::set<std::size_t>(row.begin(), row.end()).size() == n);
        REQUIRE(row.size() == n);
        for (std::size_t place = 0; place < n; ++place) {
            REQUIRE(row[place] < n);
            ++at_place[{row[place], place}];
            if (place > 0) {
                ++neighbours[{row[place - 1], row[place]}];
            }
        }
    }
    CHECK(even(at_place, n * n, rows.size() / n));
    CHECK(even(neighbours, n * (n - 1), rows.size() / n));
}

TEST_CASE("a session holds what its design asks for, in order") {
    SEED(std::uint64_t{200});
    const Protocol protocol = planned_study();
    const Plan plan = make_plan(protocol, "hash", {.participant = "p01"}, seed);

    REQUIRE(plan.trials.size() == 10 + 100 + 4);
    std::size_t in_main_phase = 0;
    for (std::size_t i = 0; i < plan.trials.size(); ++i) {
        const PlannedTrial& trial = plan.trials[i];
        CAPTURE(i);
        CHECK(trial.position == i);
        CHECK((trial.phase == Phase::practice) == (i < 10));
        CHECK(protocol.objects[trial.condition.object].pictured ==
              (trial.phase != Phase::catch_trial));
        if (trial.phase == Phase::practice) {
            CHECK_FALSE(trial.break_before);
            continue;
        }
        CHECK(trial.break_before == (in_main_phase % 20 == 0));
        ++in_main_phase;
    }
    CHECK(plan.trials[10].phase == Phase::main);
    CHECK(palpate::tests::within_limits(of_phase(plan, Phase::main), {.object = 2, .friction = 3}));
    CHECK(even(counts(of_phase(plan, Phase::practice)), 10, 1));
    CHECK(even(counts(of_phase(plan, Phase::main)), 10, 10));
    CHECK(even(counts(of_phase(plan, Phase::catch_trial)), 4, 1));
}

TEST_CASE("catch trials are spread over objects and frictions as evenly as their number allows") {
    Protocol protocol = planned_study();
    const std::size_t catches = GENERATE(range(std::size_t{0}, std::size_t{17}));
    protocol.design.repetitions = 1;
    protocol.design.catch_trials = catches;
    std::set<std::size_t> first_objects;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const auto drawn =
            of_phase(make_plan(protocol, "hash", {.participant = "p"}, seed), Phase::catch_trial);
        REQUIRE(drawn.size() == catches);
        std::map<std::size_t, std::size_t> objects{{5, 0}, {6, 0}};
        std::map<std::size_t, std::size_t> frictions{{0, 0}, {1, 0}};
        for (const Condition& condition : drawn) {
            ++objects.at(condition.object);
            ++frictions.at(condition.friction);
        }
        CHECK(std::max(objects[5], objects[6]) - std::min(objects[5], objects[6]) <= 1);
        CHECK(std::max(frictions[0], frictions[1]) - std::min(frictions[0], frictions[1]) <= 1);
        if (!drawn.empty()) {
            first_objects.insert(drawn.front().object);
        }
    }
    CHECK(first_objects.size() == (catches == 0 ? 0 : 2));
}

TEST_CASE("catch trials come at every place but the first") {
    Protocol protocol = planned_study();
    protocol.design = {.repetitions = 1,
                       .max_run_object = 0,
                       .max_run_friction = 0,
                       .practice_repetitions = 0,
                       .catch_trials = 3,
                       .break_every = 0};
    std::map<std::size_t, int> places;
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        for (const PlannedTrial& trial :
             make_plan(protocol, "hash", {.participant = "p"}, seed).trials) {
            places[trial.position] += trial.phase == Phase::catch_trial ? 1 : 0;
        }
    }
    CHECK(places[0] == 0);
    for (std::size_t place = 1; place < 13; ++place) {
        CHECK(std::abs(places[place] - 500) < 5 * 20);  // 2000 * 3 / 12, standard deviation 19.4
    }
}

TEST_CASE("without practice and breaks no trial has a break before it") {
    Protocol protocol = planned_study();
    protocol.design.practice_repetitions = 0;
    protocol.design.break_every = 0;
    for (const PlannedTrial& trial : make_plan(protocol, "hash", {.participant = "p"}, 1).trials) {
        CHECK_FALSE(trial.break_before);
    }
}

TEST_CASE("the same key gives the same plan, and another key another one") {
    const Protocol protocol = planned_study();
    const Plan plan = make_plan(protocol, "hash", {.participant = "p01", .session = 1}, 3);
    CHECK(plan == make_plan(protocol, "hash", {.participant = "p01", .session = 1}, 3));
    for (const Plan& other :
         {make_plan(protocol, "hash", {.participant = "p02", .session = 1}, 3),
          make_plan(protocol, "hash", {.participant = "p01", .session = 2}, 3),
          make_plan(protocol, "hash", {.participant = "p01", .session = 1}, 4),
          make_plan(protocol, "hast", {.participant = "p01", .session = 1}, 3)}) {
        CHECK(other.trials != plan.trials);
        CHECK(other.hash != plan.hash);
    }
}

TEST_CASE("asking for other practice or catch trials leaves the main order alone") {
    Protocol protocol = planned_study();
    const auto main = of_phase(make_plan(protocol, "hash", {.participant = "p"}, 3), Phase::main);
    protocol.design.practice_repetitions = 3;
    protocol.design.catch_trials = 9;
    CHECK(of_phase(make_plan(protocol, "hash", {.participant = "p"}, 3), Phase::main) == main);
}

TEST_CASE("pictures keep their places in all sessions of a participant") {
    Protocol protocol = planned_study();
    protocol.design.repetitions = 1;
    std::set<std::vector<std::size_t>> orders;
    for (int i = 0; i < 200; ++i) {
        const std::string participant = std::to_string(i);
        const Plan first =
            make_plan(protocol, "hash", {.participant = participant, .session = 1}, 3);
        const Plan second =
            make_plan(protocol, "hash", {.participant = participant, .session = 2}, 3);
        CHECK(first.picture_order == second.picture_order);
        CHECK(std::is_permutation(first.picture_order.begin(), first.picture_order.end(),
                                  std::vector<std::size_t>{0, 1, 2, 3, 4}.begin()));
        orders.insert(first.picture_order);
    }
    CHECK(orders.size() == 10);  // every row of the design for five items
}

TEST_CASE("the code for the lab book begins the plan's hash") {
    const Plan plan = make_plan(planned_study(), "hash", {.participant = "p"}, 3);
    CHECK(plan.hash.size() == 64);
    CHECK(session_code(plan) == std::string(plan.hash, 0, 4).append("-").append(plan.hash, 4, 4));
}

// The code of the first plan ever made, kept: an order that changes is another experiment.
TEST_CASE("the plan of a key never changes between versions") {
    CHECK(session_code(make_plan(planned_study(), "hash", {.participant = "p01"}, 42)) ==
          "5c32-1697");
}

TEST_CASE("nothing to run is refused") {
    Protocol protocol = planned_study();
    protocol.design.repetitions = 0;
    CHECK_THROWS_AS(make_plan(protocol, "hash", {}, 1), std::invalid_argument);
    protocol = planned_study();
    protocol.objects.resize(5);
    CHECK_THROWS_AS(make_plan(protocol, "hash", {}, 1), std::invalid_argument);
}
