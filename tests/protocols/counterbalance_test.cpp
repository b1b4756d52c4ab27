#include "tests/protocols/orders.hpp"

using namespace palpate::protocols;

namespace {

Protocol counterbalanced_study() {
    return named_study(5, 2, {.repetitions = 1});
}

}  // namespace

TEST_CASE("rows are balanced after every participant, whatever is drawn") {
    SEED(std::uint64_t{30});
    const Protocol protocol = counterbalanced_study();
    std::vector<std::vector<std::string>> before;
    for (int i = 0; i < 35; ++i) {
        const Plan plan = make_plan(protocol, "hash", {.participant = std::to_string(i)}, seed,
                                    picture_history(protocol, before, {}));
        before.push_back(names_of(protocol.objects, plan.picture_order));
        const RowHistory now = picture_history(protocol, before, before.back());
        REQUIRE(now.own);
        const auto [least, max] = std::minmax_element(now.uses.begin(), now.uses.end());
        CHECK(*max - *least <= 1);
    }
}

TEST_CASE("a participant keeps the row they have, whatever others do") {
    const Protocol protocol = counterbalanced_study();
    for (std::size_t row = 0; row < 10; ++row) {
        RowHistory history{.uses = std::vector<std::size_t>(10, 0), .own = row};
        history.uses[row] = 99;
        const Plan plan = make_plan(protocol, "hash", {.participant = "p"}, 4, history);
        CHECK(plan.picture_order == picture_rows(protocol)[row]);
    }
}

TEST_CASE("the row used least is taken, and ties fall on each alike") {
    Pcg32 random(1, 2);
    CHECK(choose_row(4, {.uses = {3, 2, 1, 2}, .own = {}}, random) == 2);
    std::map<std::size_t, int> chosen;
    for (int i = 0; i < 4000; ++i) {
        ++chosen[choose_row(5, {.uses = {1, 0, 0, 2, 0}, .own = {}}, random)];
    }
    CHECK(chosen.size() == 3);
    for (const auto& [row, times] : chosen) {
        CHECK(std::abs(times - 1333) < 5 * 30);  // standard deviation 29.8
    }
}

TEST_CASE("orders of another version of the protocol count for nothing") {
    const Protocol protocol = counterbalanced_study();
    const std::vector<std::vector<std::string>> others = {{"a", "b"}, {"v", "w", "x", "y", "z"}};
    const RowHistory history = picture_history(protocol, others, others[1]);
    CHECK(history.uses == std::vector<std::size_t>(10, 0));
    CHECK_FALSE(history.own);
}

TEST_CASE("every purpose of random numbers has a name of its own") {
    std::vector<std::string_view> names(purpose::all.begin(), purpose::all.end());
    std::sort(names.begin(), names.end());
    CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
}
