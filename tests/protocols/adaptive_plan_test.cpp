#include <array>
#include <map>
#include <string>

#include "protocols/design/adaptive_plan.hpp"
#include "protocols/library/shipped.hpp"
#include "tests/support/adaptive_text.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::protocols;
using Catch::Matchers::ContainsSubstring;
using palpate::tests::adaptive_protocol;
using palpate::tests::adaptive_text;

namespace {

std::string refusal(const std::string& text) {
    try {
        static_cast<void>(parse_protocol(text, "p.toml"));
    } catch (const ProtocolError& error) {
        return error.what();
    }
    return "accepted";
}

std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

Plan plan_of(const Protocol& protocol, std::uint64_t seed) {
    return make_plan(protocol, protocol_hash(protocol), {.participant = "P01"}, seed);
}

}  // namespace

TEST_CASE(
    "every run has its trials, one half of its comparisons in each interval, within the limits",
    "[adaptive][law]") {
    const auto seed = GENERATE(range(std::uint64_t{0}, std::uint64_t{60}));
    Protocol protocol = adaptive_protocol();
    protocol.procedure->max_run = 2;
    protocol.procedure->max_run_interval = 3;
    const Plan plan = plan_of(protocol, seed);
    REQUIRE(plan.trials.size() == 16);
    std::map<std::size_t, std::array<int, 2>> counts;
    std::size_t same_run = 0;
    std::size_t same_interval = 0;
    for (std::size_t i = 0; i < plan.trials.size(); ++i) {
        const PlannedTrial& trial = plan.trials[i];
        REQUIRE(trial.adaptive);
        CHECK(trial.position == i);
        CHECK(trial.phase == (i < 2 ? Phase::practice : Phase::main));
        CHECK(trial.break_before == (i == 2 || i == 7 || i == 12));
        CHECK(trial.condition.friction == trial.adaptive->run);
        CHECK(trial.adaptive->standard_friction == 0);
        if (i < 2) {
            continue;
        }
        ++counts[trial.adaptive->run].at(trial.adaptive->comparison - 1);
        const AdaptiveTrial& last = *plan.trials[i - 1].adaptive;
        const bool first = i == 2;
        same_run = !first && last.run == trial.adaptive->run ? same_run + 1 : 1;
        same_interval =
            !first && last.comparison == trial.adaptive->comparison ? same_interval + 1 : 1;
        CHECK(same_run <= 2);
        CHECK(same_interval <= 3);
    }
    for (const auto& [run, count] : counts) {
        CHECK(count[0] + count[1] == 7);
        CHECK(std::abs(count[0] - count[1]) == 1);
    }
    CHECK(plan == plan_of(protocol, seed));
}

TEST_CASE("the hash of a plan follows the rule, its stream and every trial", "[adaptive][law]") {
    const Protocol protocol = adaptive_protocol();
    const std::string hash = protocol_hash(protocol);
    const SessionKey key{.participant = "P01"};
    const Plan plan = make_plan(protocol, hash, key, 3);
    CHECK(plan.hash == make_plan(protocol, hash, key, 3).hash);
    Protocol other = protocol;
    other.procedure->rule += "# another\n";  // the same trials
    CHECK(make_plan(other, hash, key, 3).trials == plan.trials);
    CHECK(make_plan(other, hash, key, 3).hash != plan.hash);
    CHECK(make_plan(protocol, hash, key, 4).hash != plan.hash);
    CHECK(make_plan(protocol, hash, {.participant = "P02"}, 3).hash != plan.hash);
    CHECK(make_plan(protocol, hash, {.participant = "P01", .session = 2}, 3).hash != plan.hash);
}

TEST_CASE("a protocol with a rule is written and read again as the same text", "[adaptive][law]") {
    for (const char* rule : {palpate::tests::kQuestPlusRule, palpate::tests::kStaircaseRule}) {
        const Protocol protocol = adaptive_protocol(rule);
        const std::string text = to_toml(protocol);
        CHECK(parse_protocol(text, "again.toml") == protocol);
        CHECK(to_toml(parse_protocol(text, "again.toml")) == text);
    }
    for (const ShippedProtocol& shipped : shipped_protocols()) {
        CAPTURE(shipped.name);
        const Protocol protocol = parse_protocol(shipped.text, shipped.name);
        CHECK(parse_protocol(to_toml(protocol), "again.toml") == protocol);
        CHECK(shipped.text.starts_with("# "));
    }
}

TEST_CASE("what does not fit a rule is refused at its place, with a remedy", "[adaptive]") {
    const std::string good = adaptive_text(palpate::tests::kQuestPlusRule);
    REQUIRE(refusal(good) == "accepted");
    const auto says = [&](const char* from, const char* to) {
        const std::string what = refusal(with(good, from, to));
        CHECK_THAT(what, Catch::Matchers::StartsWith("p.toml:"));
        return what;
    };
    CHECK_THAT(says("object = \"reference\"", "object = \"referenz\""),
               ContainsSubstring("did you mean reference?"));
    CHECK_THAT(says("varies = \"curvature_per_m\"", "varies = \"size\""),
               ContainsSubstring("curvature_per_m"));
    CHECK_THAT(says("friction = \"on\"\nstandard", "friction = \"onn\"\nstandard"),
               ContainsSubstring("no [[friction]] is called"));
    CHECK_THAT(says("from = -3, to = 13", "from = -3, to = 93"),
               ContainsSubstring("there is no such object"));
    CHECK_THAT(says("trials = 7", "trials = 7\nentropy_bits = 1"),
               ContainsSubstring("complete before its first trial"));
    CHECK_THAT(says("trials = 7", "trails = 7"), ContainsSubstring("trails"));
    CHECK_THAT(says("kind = \"two_interval\"", "kind = \"rating\""),
               ContainsSubstring("the rule knows 2 outcomes"));
    CHECK_THAT(says("practice_stimulus = 13", "practice_stimulus = 14"),
               ContainsSubstring("-3 to 13"));
    CHECK_THAT(says("break_every = 5", "break_every = 5\nrepetitions = 3"),
               ContainsSubstring("[procedure] decides"));
    CHECK_THAT(says("varies = \"curvature_per_m\"", "varies = \"mu\""),
               ContainsSubstring("above 0 and at most 10"));
    CHECK_THAT(says("[[run]]\nname = \"equal\"", "[[run]]\nname = \"different\""),
               ContainsSubstring("a name of its own"));
    const std::string plain = with(good, "[procedure]", "[observer]\n[procedures]");
    CHECK_THAT(refusal(plain), ContainsSubstring("did you mean procedure?"));
}
