#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/session/trial_meter.hpp"
#include "tests/protocols/orders.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::protocols;

namespace {

/// Practice, two blocks of main trials and catch trials.
Protocol blocked() {
    Protocol protocol = tests::small_protocol(4);
    protocol.objects.push_back({"catch", 15.0, false});
    protocol.design.practice_repetitions = 1;
    protocol.design.catch_trials = 2;
    protocol.design.blocks = 2;
    return protocol;
}

Plan first_plan_of(const Protocol& protocol) {
    return make_plan(protocol, protocol_hash(protocol), {"P01", 1}, protocol.seed);
}

RequeueRule rule_of(std::uint64_t seed, std::size_t max) {
    return {.key = {.protocol_hash = "h", .participant = "P01", .purpose = {}, .seed = seed},
            .max = max};
}

struct Attempt {
    std::size_t position = 0;
    Outcome outcome = Outcome::complete;
    bool counts = true;

    friend bool operator==(const Attempt&, const Attempt&) = default;
};

/// What becomes of the n-th attempt at a position, the same whoever asks.
Attempt becomes(std::size_t position, std::size_t n, std::uint64_t seed, double bad) {
    Random random(seed * 7919 + position * 131 + n);
    Attempt attempt{.position = position};
    if (random.in(0.0, 1.0) < bad) {
        attempt.outcome = random.coin() ? Outcome::faulted : Outcome::timed_out;
        attempt.counts = false;
    }
    return attempt;
}

std::vector<Attempt> run_all(const Plan& plan,
                             const RequeueRule& rule,
                             std::uint64_t seed,
                             double bad) {
    PendingTrials pending(plan, rule);
    std::vector<std::size_t> times(plan.trials.size());
    std::vector<Attempt> all;
    while (!pending.empty()) {
        const std::size_t position = pending.next();
        all.push_back(becomes(position, times[position]++, seed, bad));
        pending.note(position, all.back().outcome, all.back().counts);
    }
    CHECK(pending.next() == plan.trials.size());
    CHECK(pending.answered() == plan.trials.size());
    return all;
}

std::size_t part_of(const Plan& plan, std::size_t position) {
    const PlannedTrial& planned = plan.trials[position];
    return planned.phase == Phase::practice ? 0 : 1 + planned.block;
}

}  // namespace

TEST_CASE("each position ends with one answer that counts, or has used up its repetitions") {
    SEED(std::uint64_t{100});
    const Plan plan = first_plan_of(blocked());
    const std::size_t max = seed % 4;
    const auto all = run_all(plan, rule_of(seed, max), seed, 0.1 * static_cast<double>(seed % 11));
    std::vector<std::size_t> good(plan.trials.size());
    std::vector<std::size_t> bad(plan.trials.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const std::size_t at = all[i].position;
        CHECK(good[at] == 0);  // nothing after the one that counts
        ++(all[i].counts ? good : bad)[at];
        if (i == 0) {
            continue;
        }
        CHECK(part_of(plan, all[i - 1].position) <= part_of(plan, at));  // within its block
        if (all[i - 1].position == at) {  // at once again only with nothing else left in its block
            CHECK(
                std::all_of(plan.trials.begin(), plan.trials.end(), [&](const PlannedTrial& other) {
                    return other.position == at ||
                           part_of(plan, other.position) != part_of(plan, at) ||
                           good[other.position] == 1 || bad[other.position] == max + 1;
                }));
        }
    }
    for (std::size_t at = 0; at < plan.trials.size(); ++at) {
        CHECK((good[at] == 1 ? bad[at] <= max : bad[at] == max + 1));
    }
}

TEST_CASE("every later place of the block is equally likely, and none of another block") {
    const Plan plan = first_plan_of(blocked());
    PendingTrials whole(plan);
    const std::size_t first = 6;  // of the first block, behind practice
    for (std::size_t i = 0; i < first; ++i) {
        REQUIRE(part_of(plan, i) == 0);
        whole.note(i, Outcome::complete);
    }
    const auto length = static_cast<std::size_t>(std::count_if(
        plan.trials.begin(), plan.trials.end(),
        [&](const PlannedTrial& planned) { return part_of(plan, planned.position) == 1; }));
    std::map<std::size_t, std::size_t> counts;  // of its places in the block
    constexpr std::size_t kDraws = 20000;
    for (std::size_t seed = 0; seed < kDraws; ++seed) {
        PendingTrials pending(plan, rule_of(seed, 10));
        for (std::size_t i = 0; i < first; ++i) {
            pending.note(i, Outcome::complete);
        }
        pending.note(first, Outcome::complete, false);
        const auto& order = pending.order();
        const auto place = std::find(order.begin(), order.end(), first) - order.begin();
        REQUIRE(static_cast<std::size_t>(place) < length);
        ++counts[static_cast<std::size_t>(place)];
    }
    CHECK_FALSE(counts.contains(0));  // not at once
    // Mean f, standard deviation sqrt(2 f): five of them are beyond 1e-5 for the few degrees here.
    const auto f = static_cast<double>(length - 2);
    CHECK(chi_square(counts, length - 1) < f + 5.0 * std::sqrt(2.0 * f));
}

TEST_CASE("an answered trial that breaks a rule says which and by how much") {
    Protocol protocol = tests::small_protocol();
    TrialSummary good;
    good.ticks = 4000;
    good.contact_ticks = 1000;
    good.late_ticks = 4;
    good.path_length_m = 0.16;
    CHECK(why_invalid(protocol, good, true).empty());  // every limit itself is allowed
    const auto with = [&](auto member, auto value) {
        TrialSummary summary = good;
        summary.*member = value;
        return why_invalid(protocol, summary, true);
    };
    CHECK(with(&TrialSummary::late_ticks, std::int64_t{5}) ==
          "late 0.12 % of its ticks, above 0.1 %");
    CHECK(with(&TrialSummary::contact_ticks, std::int64_t{999}) == "contact below 1 s");
    CHECK(with(&TrialSummary::path_length_m, 0.1) == "path below 160 mm");
    CHECK(with(&TrialSummary::stale_ticks, std::int64_t{4000}).empty());  // unless it is asked for
    protocol.invalid.stale_share = 0.01;
    CHECK(with(&TrialSummary::stale_ticks, std::int64_t{40}).empty());
    CHECK(with(&TrialSummary::stale_ticks, std::int64_t{41}) ==
          "stale 1.02 % of its readings, above 1 %");
    TrialSummary nothing;
    nothing.ticks = 1000;
    nothing.late_ticks = 1000;
    CHECK(why_invalid(protocol, nothing, true) ==
          "late 100.00 % of its ticks, above 0.1 %; contact below 1 s; path below 160 mm");
    CHECK(why_invalid(protocol, nothing, false) == "contact below 1 s; path below 160 mm");
    CHECK_FALSE(why_invalid(protocol, TrialSummary{}, true).empty());  // nothing was felt
    protocol.invalid = {.late_share = 1.0, .contact_min = 0.0, .path_min = 0.0};
    CHECK(why_invalid(protocol, nothing, true).empty());
    CHECK(why_invalid(protocol, TrialSummary{}, true).empty());
}
